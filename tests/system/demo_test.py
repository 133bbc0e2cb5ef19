"""`vpslam demo`, on the first frames of its scene."""

import os
import subprocess
import unittest

import system


class Demo(system.SystemTest):
    def demo(self, *arguments):
        done = subprocess.run(
            self.network + [system.VPSLAM, "demo", *map(str, arguments)], cwd=self.folder,
            text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL,
            env=dict(os.environ, TAG=self.tag, XDG_RUNTIME_DIR=str(self.folder / "runtime")),
            timeout=600)
        self.assert_nothing_left()
        return done.returncode, done.stdout

    def test_runs_and_draws(self):
        out = self.folder / "demo"
        status, output = self.demo("--frames", 60, "--out", out)
        self.assertEqual(status, 0, output)
        self.assertRegex(output, r"ATE +\d+\.\d mm \(rmse\)")
        self.assertRegex(output, r"coverage +(0\.[89]\d*|1\.000) of 60 frames")
        for text in (str(out), "trajectory.png", "camera:0", "lcm-spy", "docs/operating.md"):
            self.assertIn(text, output)
        self.assertEqual((out / "trajectory.png").read_bytes()[:4], b"\x89PNG")
        figure = (out / "trajectory.svg").read_text()
        for text in ("truth", "VP-SLAM", "x (m)", "time (s)"):
            self.assertIn(text, figure)

    def test_is_for_simulated_places(self):
        status, output = self.demo("--scene", system.sequence())
        self.assertEqual(status, 1, output)
        self.assertIn("is not simulated", output)


if __name__ == "__main__":
    unittest.main()
