"""Several detectors share the images of a run, and it does not matter which of them live."""

import csv
import json
import os
import pathlib
import re
import signal
import subprocess
import unittest

import system

FRAMES = 80


class Detectors(system.SystemTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.out = cls.folder / "one"

    def setUp(self):
        super().setUp()
        if not self.out.exists():
            type(self).status, type(self).output = self.run_to_end(
                system.sequence(), "--out", self.out, "--frames", FRAMES, "--detectors", 1)
        self.assertEqual(self.status, 0, self.output)

    def answered(self, out, name):
        """Images that a detector says it has answered, by its log."""
        log = (out / "logs" / f"{name}.log").read_text()
        return int(re.search(r"answered (\d+) images", log).group(1))

    def start_with(self, name, detectors):
        names = system.WITHOUT_DETECTORS + [f"vpdetector{number + 1}" for number in range(detectors)]
        return self.start_and_wait_for_frames(
            system.sequence(), "--out", self.folder / name, "--frames", FRAMES,
            "--detectors", detectors, names=names)

    def assert_whole(self, out, status, output):
        self.assertEqual(status, 0, output)
        self.assert_same_results(self.out, out)
        frames = json.loads((out / "summary.json").read_text())["frames"]
        self.assertEqual((frames["in"], frames["dropped"]), (FRAMES, 0))

    def test_tables_and_summary_have_the_stages(self):
        with open(self.out / "frames.csv", newline="") as table:
            rows = list(csv.DictReader(table))
        self.assertEqual(len(rows), FRAMES)
        for column in ("lines_ms", "vps_ms", "wait_for_lines_ms"):
            self.assertTrue(all(row[column] and float(row[column]) >= 0 for row in rows), column)
        summary = json.loads((self.out / "summary.json").read_text())
        for stage in ("lines", "vps", "wait_for_lines"):
            self.assertGreater(summary["stages_ms"][stage], 0)
        self.assertGreater(summary["cpu_ms_per_frame"]["vpdetector"], 0)
        self.assertEqual(summary["options"]["detectors"], 1)
        self.assertEqual(self.answered(self.out, "vpdetector1"), FRAMES)

    def test_two_share_the_images_and_give_the_same(self):
        out = self.folder / "two"
        status, output = self.run_to_end(system.sequence(), "--out", out, "--frames", FRAMES,
                                         "--detectors", 2)
        self.assert_whole(out, status, output)
        shares = [self.answered(out, name) for name in ("vpdetector1", "vpdetector2")]
        self.assertGreaterEqual(sum(shares), FRAMES)
        self.assertGreater(min(shares), FRAMES // 4, shares)
        self.assert_nothing_left()

    def test_losses_change_nothing(self):
        out = self.folder / "lossy"
        status, output = self.run_to_end(system.sequence(), "--out", out, "--frames", FRAMES,
                                         "--detectors", 2, **system.BAD_NETWORK)
        self.assert_whole(out, status, output)

    def test_killed_and_stopped_ones_cost_nothing(self):
        process, run = self.start_with("killed", 3)
        os.kill(run["processes"]["vpdetector1"]["pid"], signal.SIGKILL)
        os.kill(run["processes"]["vpdetector2"]["pid"], signal.SIGSTOP)
        status, output = self.finish(process)
        self.assert_whole(self.folder / "killed", status, output)
        self.assertIn("vpdetector1 was killed by SIGKILL; it is started again", output)
        self.assert_nothing_left()

    def test_one_that_starts_later_takes_its_share(self):
        process, run = self.start_with("late", 1)
        entrance = ["nsenter", "--user", "--net", "--preserve-credentials", "--target",
                    str(run["launcher"]["pid"])] if self.network else []
        binary = pathlib.Path(os.environ["VPSLAM_BIN_DIR"]) / "vpdetector"
        late = subprocess.Popen([*entrance, str(binary), "--url", run["url"]],
                                stderr=subprocess.PIPE, text=True)
        self.addCleanup(late.kill)
        status, output = self.finish(process)
        log = late.communicate(timeout=60)[1]
        self.assertEqual(late.returncode, 0, log)
        self.assertGreater(int(re.search(r"answered (\d+) images", log).group(1)), 5, log)
        self.assert_whole(self.folder / "late", status, output)

    def test_all_are_killed_and_come_back(self):
        process, run = self.start_with("none", 2)
        for name in ("vpdetector1", "vpdetector2"):
            os.kill(run["processes"][name]["pid"], signal.SIGKILL)
        status, output = self.finish(process)
        self.assert_whole(self.folder / "none", status, output)
        self.assert_nothing_left()


if __name__ == "__main__":
    unittest.main()
