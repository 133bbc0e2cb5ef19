"""Sequences in which the camera is kidnapped."""

import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "scripts"))

from vpslam_tools import kidnap  # noqa: E402
from vpslam_tools.errors import UserError  # noqa: E402


class Kidnap(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        (self.folder / "rgb").mkdir()
        for i in range(20):
            (self.folder / f"rgb/{i}.pgm").write_bytes(b"P5\n2 2\n255\n" + bytes([i] * 4))
        (self.folder / "rgb.txt").write_text(
            "# a comment\n" + "".join(f"{100 + 0.1 * i:.6f} rgb/{i}.pgm\n" for i in range(20)))
        (self.folder / "groundtruth.txt").write_text(
            "".join(f"{100 + 0.1 * i:.6f} {i} 0 0 0 0 0 1\n" for i in range(20)))
        self.entries = kidnap.read_tum(self.folder)

    def places(self, made):
        """The truth's x, by frame; None where there is none."""
        return [int(entry.truth.split()[0]) if entry.truth else None for entry in made.entries]

    def test_what_is_shown_when(self):
        whole = list(range(20))
        for how, frames, expected, seen_from in (
                ("black", 3, whole[:8] + [None] * 3 + whole[11:], 11),
                ("cut", 3, whole[:8] + whole[11:], 8),
                ("back", 5, whole[:8] + whole[3:], 8),
                ("elsewhere", 4, whole[:8] + [None] * 4 + whole[8:], 12)):
            with self.subTest(how):
                made = kidnap.kidnap(how, self.entries, 8, frames, alien=self.entries)
                self.assertEqual(self.places(made), expected)
                self.assertEqual(made.seen_from, seen_from)
                stamps = [entry.stamp_s for entry in made.entries]
                for i, stamp in enumerate(stamps):
                    self.assertAlmostEqual(stamp, 100 + 0.1 * i, places=6)

    def test_is_written_as_it_was_made(self):
        made = kidnap.kidnap("black", self.entries, 8, 3)
        out = self.folder / "made"
        kidnap.write_tum(out, made, "width: 2\n", (2, 2))
        again = kidnap.read_tum(out)
        self.assertEqual(len(again), 20)
        self.assertEqual([entry.truth for entry in again], [entry.truth for entry in made.entries])
        self.assertEqual(again[0].image.read_bytes()[-1], 0)
        self.assertEqual(again[7].image.read_bytes()[-1], 7)
        self.assertEqual(again[9].image.read_bytes()[-4:], bytes(4), "black")
        self.assertEqual(again[12].image.read_bytes()[-1], 12)

    def test_time_to_recover(self):
        made = kidnap.kidnap("black", self.entries, 8, 3)
        stamps = [entry.stamp_s for entry in made.entries]
        self.assertEqual(kidnap.frames_to_recover(made, stamps[:8] + stamps[13:], 11), 2)
        self.assertIsNone(kidnap.frames_to_recover(made, stamps[:8], 11))
        self.assertIsNone(kidnap.frames_to_recover(made, stamps[19:], 11, window_s=0.5))

    def test_what_cannot_be_done_is_told(self):
        for how, at in (("black", 30), ("black", 0), ("sideways", 5)):
            with self.subTest(how=how, at=at), self.assertRaises(UserError):
                kidnap.kidnap(how, self.entries, at, 3)
        with self.assertRaisesRegex(UserError, "rgb.txt"):
            kidnap.read_tum(self.folder / "nowhere")


if __name__ == "__main__":
    unittest.main()
