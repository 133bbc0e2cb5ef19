"""A live camera, on the stand-in for V4L2 that tests/unit/player/fake_v4l2.cpp is: what it gives is
told, and one that delivers nothing keeps no run from ending."""

import json
import os
import pathlib
import signal
import time
import unittest
import uuid

import system

FAKE = os.environ["VPSLAM_FAKE_V4L2"]


class LiveCamera(system.SystemTest):
    def setUp(self):
        super().setUp()
        self.device = pathlib.Path(f"/dev/shm/vpslam-camera-{uuid.uuid4().hex}")
        self.device.write_text("x")  # it has to exist
        self.addCleanup(self.device.unlink)
        (self.folder / "lens.yaml").write_text(
            "width: 640\nheight: 480\nfps: 30\nfx: 500\nfy: 500\ncx: 320\ncy: 240\n")

    def start_camera(self, out, **environment):
        process = self.start(
            f"camera:{self.device}", "--camera", self.folder / "lens.yaml", "--pixel-format",
            "YUYV", "--pace", "realtime", "--detectors", "0", "--out", self.folder / out,
            LD_PRELOAD=FAKE, VPSLAM_FAKE_CAMERA=str(self.device), **environment)
        line = process.stdout.readline()
        while line and "gives 640 x 480" not in line:
            line = process.stdout.readline()
        self.assertIn(f"{self.device} gives 640 x 480 px at 30 Hz as YUYV", line)
        return process

    def stop(self, process):
        process.send_signal(signal.SIGINT)
        begin = time.monotonic()
        status, output = self.finish(process)
        self.assert_nothing_left()
        return status, output, time.monotonic() - begin

    def test_plays_until_ctrl_c(self):
        process = self.start_camera("plays")
        time.sleep(2)
        status, output, _ = self.stop(process)
        self.assertEqual(status, 0, output)
        summary = json.loads((self.folder / "plays" / "summary.json").read_text())
        self.assertGreater(summary["frames"]["in"], 5)

    def test_one_that_stalls_keeps_nobody_from_ending(self):
        process = self.start_camera("stalls", VPSLAM_FAKE_STALL="1")
        status, output, took_s = self.stop(process)
        self.assertEqual(status, 130, output)
        self.assertIn("no frame came through", output)
        self.assertLess(took_s, 8)  # 3 on a quiet machine

    def test_one_that_stalls_is_told(self):
        process = self.start_camera("told", VPSLAM_FAKE_STALL="1")
        status, output = self.finish(process)
        self.assertEqual(status, 1)
        self.assertIn(f"{self.device}: ", output)
        self.assertRegex(output, "no frame came for 10 s|delivers no more frames")
        self.assert_nothing_left()


if __name__ == "__main__":
    unittest.main()
