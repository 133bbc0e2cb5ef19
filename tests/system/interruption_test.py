"""Runs that end early: by Ctrl-C, by the death of a process, by the death of the launcher."""

import json
import os
import pathlib
import signal
import time
import unittest

import system


class Interruption(system.SystemTest):
    def start_endless(self, name):
        """Starts a run that would last, and returns it once poses come."""
        return self.start_and_wait_for_frames(self.endless, "--out", self.folder / name)

    @classmethod
    def setUpClass(cls):
        """The sequence over and over again, so that no run ends before it is interrupted."""
        super().setUpClass()
        cls.endless = cls.folder / "endless"
        cls.endless.mkdir()
        os.symlink(system.sequence() / "rgb", cls.endless / "rgb")
        os.symlink(system.sequence() / "camera.yaml", cls.endless / "camera.yaml")
        names = [line.split()[1]
                 for line in (system.sequence() / "rgb.txt").read_text().splitlines()]
        there_and_back = (names + names[::-1]) * 50
        (cls.endless / "rgb.txt").write_text("".join(
            f"{frame / 30:.6f} {name}\n" for frame, name in enumerate(there_and_back)))

    def test_ctrl_c_writes_results(self):
        process, _ = self.start_endless("ctrl_c")
        process.send_signal(signal.SIGINT)
        status, output = self.finish(process)
        self.assertEqual(status, 0, output)
        summary = json.loads((self.folder / "ctrl_c" / "summary.json").read_text())
        self.assertTrue(summary["interrupted"])
        self.assertTrue((self.folder / "ctrl_c" / "trajectory.txt").exists(), output)
        self.assert_nothing_left()

    def test_ctrl_c_at_any_time_of_the_start(self):
        for delay_s in (0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.4, 0.5, 0.7, 1.0, 1.4, 2.0):
            with self.subTest(delay_s):
                out = self.folder / f"after_{delay_s}"
                process = self.start(self.endless, "--out", out)
                time.sleep(delay_s)
                process.send_signal(signal.SIGINT)
                sent = time.monotonic()
                status, output = self.finish(process)
                self.assertLess(time.monotonic() - sent, 20, output)
                self.assertNotIn("Traceback", output)
                self.assertNotIn("SIGINT", output)
                summary = out / "summary.json"
                frames = (json.loads(summary.read_text())["frames"]["in"]
                          if summary.exists() else 0)
                self.assertEqual(status, 0 if frames > 0 else 130, output)
                self.assert_nothing_left()

    def test_two_ctrl_c_end_at_once(self):
        process, _ = self.start_endless("twice")
        process.send_signal(signal.SIGINT)
        process.send_signal(signal.SIGINT)
        self.assertIn(self.finish(process, timeout_s=30)[0], (0, 130))
        self.assert_nothing_left()

    def test_killed_process(self):
        for name in ("player", "backend", "recorder"):  # a frontend is started again
            with self.subTest(name):
                process, run = self.start_endless("killed_" + name)
                os.kill(run["processes"][name]["pid"], signal.SIGKILL)
                status, output = self.finish(process)
                self.assertEqual(status, 1)
                self.assertIn(f"{name} was killed by SIGKILL", output)
                written = (self.folder / ("killed_" + name) / "summary.json").exists()
                self.assertEqual(written, name != "recorder")
                self.assert_nothing_left()

    def test_killed_launcher(self):
        process, run = self.start_endless("killed_launcher")
        segment = pathlib.Path(f"/dev/shm/vpslam-{run['session']}")
        self.assertTrue(segment.exists())
        os.kill(run["launcher"]["pid"], signal.SIGKILL)
        self.finish(process)
        self.wait_until(lambda: not self.processes_left(), "the end of the guardian")
        self.assert_nothing_left()


if __name__ == "__main__":
    unittest.main()
