"""Processes that are killed or stopped in mid-run: the run goes on, and hardly suffers."""

import os
import signal
import time
import unittest

import system

STOPPED_S = 2.0
# The sequence is too short for more: each case is one run.
MIN_COVERAGE = 0.9   # of the undisturbed run's
# A kill falls at another frame each time: millimetres differ by chance, a bent map by centimetres.
MAX_ATE = 1.5        # times the undisturbed run's, or
MAX_EXTRA_ATE_M = 0.002


class Supervision(system.SystemTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.undisturbed = cls.folder / "undisturbed"

    def setUp(self):
        super().setUp()
        if not self.undisturbed.exists():
            status, output = self.run_to_end(system.sequence(), "--out", self.undisturbed,
                                             "--detectors", 1)
            self.assertEqual(status, 0, output)

    def disturb(self, name, disturbance):
        """A run in which `disturbance` is done to the run once a third of its frames came through;
        returns what the launcher said."""
        out = self.folder / name
        names = system.NAMES
        process, run = self.start_and_wait_for_frames(
            system.sequence(), "--out", out, "--detectors", 1, names=names)
        disturbance(run)
        status, output = self.finish(process)
        self.assertEqual(status, 0, output)
        self.assert_nothing_left()
        self.assert_hardly_suffered(out)
        return output

    def assert_hardly_suffered(self, out):
        rgb = system.sequence() / "rgb.txt"
        without = self.evaluate(self.undisturbed, system.sequence(), "--frames", rgb)
        result = self.evaluate(out, system.sequence(), "--frames", rgb)
        self.assertGreaterEqual(result["coverage"], MIN_COVERAGE * without["coverage"])
        ate_m = without["ate_m"]["rmse"]
        self.assertLessEqual(result["ate_m"]["rmse"],
                             max(MAX_ATE * ate_m, ate_m + MAX_EXTRA_ATE_M))

    @staticmethod
    def kill(name):
        return lambda run: os.kill(run["processes"][name]["pid"], signal.SIGKILL)

    def test_killed_detector(self):
        output = self.disturb("detector", self.kill("vpdetector1"))
        self.assertIn("vpdetector1 was killed by SIGKILL; it is started again", output)
        self.assert_same_results(self.undisturbed, self.folder / "detector")

    def test_killed_frontend(self):
        output = self.disturb("frontend", self.kill("frontend"))
        self.assertIn("frontend was killed by SIGKILL; it is started again", output)

    def test_stopped_processes(self):
        for name in system.NAMES:
            with self.subTest(name):
                def stop(run):
                    pid = run["processes"][name]["pid"]
                    os.kill(pid, signal.SIGSTOP)
                    time.sleep(STOPPED_S)
                    os.kill(pid, signal.SIGCONT)
                self.disturb(f"stopped_{name}", stop)
                # In lockstep all wait: nothing differs.
                self.assert_same_results(self.undisturbed, self.folder / f"stopped_{name}")


if __name__ == "__main__":
    unittest.main()
