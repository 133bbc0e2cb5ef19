"""What a run says in the end of images that were not played or not tracked."""

import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "scripts"))

from vpslam_tools import outcome  # noqa: E402


class Outcome(unittest.TestCase):
    SUMMARY = {"frames": {"in": 57, "dropped": 4},
               "sequence": {"expected": 60, "played": 57, "skipped": {"is missing": 3},
                            "notes": [f"note {i}" for i in range(10)]},
               "no_pose": {"dropped": 4, "before the map was started": 8, "lost": 0}}

    def test_what_was_not_played_or_tracked_is_said(self):
        lines = outcome.lines(self.SUMMARY)
        self.assertEqual(lines[0], "played 57 of 60 images: 3 skipped (is missing)")
        self.assertEqual(lines[1], "no pose for 12 of 57 images: 4 dropped, 8 before the map was "
                         "started")
        self.assertEqual(lines[-1], "note     2 more in logs/player.log")
        self.assertAlmostEqual(outcome.coverage(self.SUMMARY, 45), 0.75)

    def test_a_good_run_has_one_line(self):
        self.assertEqual(outcome.lines({"frames": {"in": 5}}), ["played 5 of 5 images"])

    def test_what_is_not_known_is_said(self):
        summary = {"frames": {"in": 5}, "sequence": {
            "expected": 5, "skipped": {}, "end_missing": "a.lcm is cut off", "notes": []}}
        self.assertEqual(outcome.lines(summary), ["played 5 of at least 5 images: the rest skipped "
                                                  "(a.lcm is cut off)"])
        summary["sequence"] = {"expected": None, "skipped": {}, "notes": []}
        self.assertEqual(outcome.lines(summary), ["played 5 of unknown images"])
        self.assertEqual(outcome.coverage(summary, 5), 1)


if __name__ == "__main__":
    unittest.main()
