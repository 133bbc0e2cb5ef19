"""A whole run: results, their accuracy, and that they repeat exactly."""

import csv
import json
import re
import unittest

import system

MAX_ATE_M = 0.02     # of a walk of two metres
MIN_COVERAGE = 0.95


class Run(system.SystemTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.out = cls.folder / "first"

    def setUp(self):
        super().setUp()
        if not self.out.exists():
            type(self).status, type(self).output = self.run_to_end(
                system.sequence(), "--out", self.out, "--seed", 3)
        self.assertEqual(self.status, 0, self.output)

    def summary(self, out=None):
        return json.loads(((out or self.out) / "summary.json").read_text())

    def test_nothing_is_left(self):
        self.assert_nothing_left()

    def test_says_what_one_wants_to_know(self):
        self.assertRegex(self.output, r"LCM URL  udpm://239\.255\.76\.67:\d+\?ttl=0")
        self.assertRegex(self.output, r"frame +\d+ .*fps")
        self.assertRegex(self.output, r"ATE +\d+\.\d+ m")
        self.assertRegex(self.output, r"coverage +\d\.\d+")
        self.assertIn(str(self.out), self.output)

    def test_accuracy(self):
        result = self.evaluate(self.out, system.sequence(), "--frames",
                               system.sequence() / "rgb.txt")
        self.assertLess(result["ate_m"]["rmse"], MAX_ATE_M)
        self.assertGreaterEqual(result["coverage"], MIN_COVERAGE)
        self.assertLess(result["rotation_deg"]["median"], 0.5)

    def test_files(self):
        for name in (*system.RESULTS, "frames.csv", "keyframes.csv", "summary.json",
                     *(f"logs/{process}.log" for process in system.NAMES)):
            self.assertTrue((self.out / name).exists(), name)
        self.assertEqual(list(self.out.glob("trajectory_map*.txt")), [])
        header = (self.out / "map.ply").read_bytes().split(b"end_header")[0].decode()
        points = int(re.search(r"element vertex (\d+)", header).group(1))
        self.assertGreater(points, 200)

    def test_tables(self):
        frames = len((system.sequence() / "rgb.txt").read_text().splitlines())
        with open(self.out / "frames.csv", newline="") as table:
            rows = list(csv.DictReader(table))
        self.assertEqual(len(rows), frames)
        for column in ("decode_ms", "transport_ms", "features_ms", "initial_pose_ms",
                       "local_map_ms", "total_ms"):
            measured = [float(row[column]) for row in rows if row[column]]
            self.assertTrue(measured and min(measured) >= 0, column)
        with open(self.out / "keyframes.csv", newline="") as table:
            rows = list(csv.DictReader(table))
        self.assertGreaterEqual(len(rows), 5)
        for row in rows:
            self.assertAlmostEqual(float(row["timestamp"]), 1000 + int(row["frame"]) / 30, places=5)
        for column in ("insertion_ms", "feature_culling_ms", "feature_creation_ms",
                       "keyframe_culling_ms", "local_ba_ms", "total_ms"):
            self.assertTrue(any(row[column] for row in rows), column)

    def test_summary(self):
        summary = self.summary()
        frames = len((system.sequence() / "rgb.txt").read_text().splitlines())
        poses = len((self.out / "trajectory.txt").read_text().splitlines())
        self.assertEqual(summary["frames"]["in"], frames)
        self.assertEqual(summary["frames"]["processed"], frames)
        self.assertEqual(summary["frames"]["dropped"], 0)
        self.assertEqual(summary["frames"]["tracked"], poses)
        self.assertGreater(summary["latency_ms"]["median"], 0)
        self.assertGreaterEqual(summary["latency_ms"]["p95"], summary["latency_ms"]["median"])
        for process in system.WITHOUT_DETECTORS + ["vpdetector"]:
            self.assertGreater(summary["cpu_ms_per_frame"][process], 0)
            self.assertGreater(summary["peak_rss_mb"][process], 1)
        self.assertGreater(summary["wall_s"], 0)
        self.assertEqual((summary["maps"], summary["seed"]), (1, 3))
        self.assertEqual(summary["options"]["pace"], "lockstep")
        self.assertEqual(summary["options"]["preset"], "default")
        self.assertEqual(summary["options"]["detectors"], 1)
        self.assertEqual(summary["options"]["sequence"], str(system.sequence()))

    def test_a_second_run_is_the_same(self):
        status, output = self.run_to_end(system.sequence(), "--out", self.folder / "second",
                                         "--seed", 3)
        self.assertEqual(status, 0, output)
        self.assert_same_results(self.out, self.folder / "second")

    def test_a_run_with_losses_is_the_same(self):
        status, output = self.run_to_end(system.sequence(), "--out", self.folder / "lossy",
                                         "--seed", 3, **system.BAD_NETWORK)
        self.assertEqual(status, 0, output)
        self.assert_same_results(self.out, self.folder / "lossy")
        self.assert_nothing_left()

    def test_a_part_of_the_sequence(self):
        out = self.folder / "part"
        status, output = self.run_to_end(system.sequence(), "--out", out, "--start", 30,
                                         "--frames", 40)
        self.assertEqual(status, 0, output)
        self.assertEqual(self.summary(out)["frames"]["in"], 40)
        listed = (system.sequence() / "rgb.txt").read_text().splitlines()[30:70]
        stamps = [line.split()[0] for line in (out / "trajectory.txt").read_text().splitlines()]
        self.assertTrue(stamps)
        self.assertLessEqual({float(stamp) for stamp in stamps},
                             {float(line.split()[0]) for line in listed})


if __name__ == "__main__":
    unittest.main()
