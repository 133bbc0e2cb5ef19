"""The files of tests/unit/odd_files.json, which the player's readers are tried on as well."""

import json
import pathlib
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(SOURCE / "scripts"))

from vpslam_tools import evaluation, trajectory  # noqa: E402
from vpslam_tools.errors import UserError  # noqa: E402

TABLE = json.loads((SOURCE / "tests" / "unit" / "odd_files.json").read_text(encoding="utf-8"))


class OddFiles(unittest.TestCase):
    def check(self, entries, read):
        """`read` gives the time stamps of a file, s, in order."""
        self.assertGreater(len(entries), 10)
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "file.txt"
            for entry in entries:
                with self.subTest(entry["name"]):
                    path.write_bytes(entry["text"].encode("utf-16" if entry.get("utf16") else "utf-8"))
                    if "fault" in entry:
                        with self.assertRaises(UserError) as raised:
                            read(path)
                        self.assertIn(entry["fault"], str(raised.exception))
                        self.assertIn(str(path), str(raised.exception))
                    elif not entry["stamps_s"]:
                        self.assertRaises(UserError, read, path)
                    else:
                        stamps_s = list(read(path))
                        self.assertEqual(len(stamps_s), len(entry["stamps_s"]))
                        for found, expected in zip(stamps_s, entry["stamps_s"]):
                            self.assertAlmostEqual(found, expected, delta=1e-6)

    def test_lists(self):
        self.check(TABLE["lists"], trajectory.read_frame_stamps)

    def test_trajectories(self):
        self.check(TABLE["trajectories"], lambda path: trajectory.read_trajectory(path).stamps_s)


class Units(unittest.TestCase):
    def poses(self, stamps_s):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "poses.txt"
            path.write_text("".join(f"{stamp:.6f} {stamp} {stamp * stamp} 0 0 0 0 1\n"
                                    for stamp in stamps_s))
            return trajectory.read_trajectory(path)

    def test_truth_in_milliseconds_is_named(self):
        estimate = self.poses([0.1 * i for i in range(1, 30)])
        truth = self.poses([100.0 * i for i in range(1, 30)])
        with self.assertRaisesRegex(UserError, "the truth may be in milliseconds"):
            evaluation.evaluate(estimate, truth)

    def test_frames_in_milliseconds_are_named(self):
        estimate = self.poses([0.1 * i for i in range(1, 30)])
        with self.assertRaisesRegex(UserError, "none of the 29 frames.*may be in milliseconds"):
            evaluation.evaluate(estimate, estimate, [100.0 * i for i in range(1, 30)])


if __name__ == "__main__":
    unittest.main()
