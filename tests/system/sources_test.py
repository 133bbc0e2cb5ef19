"""Every kind of source through the whole graph: the same images, as other data sets lay them out."""

import json
import unittest

import layouts
import system

MAX_ATE_M = 0.02
MIN_COVERAGE = 0.9


class Sources(system.SystemTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.frames = layouts.Frames(system.sequence())

    def play(self, layout, *arguments):
        name = layout.__name__
        out = self.folder / f"{name}-out"
        status, output = self.run_to_end(*layout(self.frames, self.folder / name), "--out", out,
                                         *arguments)
        self.assert_nothing_left()
        return status, output, out

    def check(self, layout, truth=True):
        """`truth`: whether the source has true poses."""
        status, output, out = self.play(layout)
        self.assertEqual(status, 0, output)
        summary = json.loads((out / "summary.json").read_text())
        self.assertEqual(summary["frames"]["in"], layouts.FRAMES)
        self.assertGreaterEqual(summary["frames"]["tracked"] / layouts.FRAMES, MIN_COVERAGE)
        self.assertEqual((out / "truth.txt").exists(), truth)
        if truth:
            self.assertRegex(output, r"ATE +\d+\.\d+ m")
            result = self.evaluate(out, out, truth="truth.txt")
            self.assertLess(result["ate_m"]["rmse"], MAX_ATE_M)
            self.assertLess(result["rotation_deg"]["median"], 0.5)
        return out

    def test_euroc(self):
        self.check(layouts.euroc)

    def test_kitti(self):
        self.check(layouts.kitti)

    def test_icl(self):
        self.check(layouts.icl)

    def test_images(self):
        self.check(layouts.images, truth=False)

    def test_video(self):
        self.check(layouts.video, truth=False)

    def test_sim(self):
        out = self.folder / "sim-out"
        status, output = self.run_to_end("sim:room", "--frames", 30, "--out", out)
        self.assertEqual(status, 0, output)
        self.assertEqual(len((out / "truth.txt").read_text().splitlines()), 1 + 30)
        self.assertRegex(output, r"ATE +\d+\.\d+ m")

    def test_camera_that_vanishes(self):
        status, output, out = self.play(layouts.camera)
        self.assertEqual(status, 1, output)
        self.assertIn("player failed", output)
        self.assertRegex(output, r"clip\.y4m: the camera delivers no more frames; is it still plugged")
        # How much was seen until then depends on the machine's load; that it was recorded does not.
        self.assertTrue((out / "summary.json").exists())

    def test_camera_that_is_asked_for_a_part(self):
        # Two images per second: patience of half a minute on a busy machine.
        status, output, out = self.play(layouts.camera, "--frames", 5, "--fps", 2)
        self.assertEqual(status, 0, output)
        summary = json.loads((out / "summary.json").read_text())
        self.assertEqual(summary["frames"]["in"], 5)

    def test_no_camera(self):
        status, output = self.run_to_end("camera:97", "--camera", self.frames.camera, "--out",
                                         self.folder / "none-out")
        self.assertEqual(status, 1, output)
        self.assertIn("/dev/video97: there is no such camera", output)


if __name__ == "__main__":
    unittest.main()
