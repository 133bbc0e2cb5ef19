"""`vpslam bench` on a folder in TUM's layout, as a newcomer has one: a trajectory, a table, pictures."""

import csv
import json
import pathlib
import unittest

import system

MAX_ATE_M = 0.03


class Bench(system.SystemTest):
    def bench(self, folder, out):
        return self.finish(self.start("--suite", "tum", "--data", folder, "--out", out, "--frames",
                                      "90", "--pace", "lockstep", command="bench"))

    def test_one_sequence(self):
        folder = self.folder / "rgbd_dataset_freiburg3_large_cabinet"
        folder.symlink_to(system.sequence())
        out = self.folder / "out"
        status, output = self.bench(folder, out)
        self.assertEqual(status, 0, output)
        results = json.loads((out / "results.json").read_text())
        self.assertEqual([each["name"] for each in results["sequences"]], ["fr3/large_cabinet"])
        run, = results["runs"]
        self.assertEqual(run["scores"]["frames"], 90)
        self.assertGreaterEqual(run["scores"]["coverage"], 0.95)
        self.assertLess(run["scores"]["ate_m"], MAX_ATE_M)
        self.assertTrue((pathlib.Path(run["results"]) / "trajectory.txt").is_file())
        for expected in ("table I", "Feature extraction", "Local BA", "fr3/large_cabinet"):
            self.assertIn(expected, (out / "results.md").read_text())
        pictures = {path.name for path in (out / "pictures").rglob("*.*")}
        self.assertEqual(pictures, {f"{name}.{ending}" for name in ("trajectory", "map", "frame", "times")
                                    for ending in ("png", "svg")})
        self.assert_nothing_left()
        status, output = self.bench(folder, out)
        self.assertEqual(status, 0, output)
        self.assertIn("done before", output)

    def test_spread_against_settings(self):
        out = self.folder / "out"
        arguments = ("--suite", "spread", "--data", system.sequence(), "--sequence",
                     system.sequence().name, "--out", out, "--frames", "90", "--runs", "2", "--set",
                     "frontend.num_features_to_start=1000", "--against", "defaults")
        status, output = self.finish(self.start(*arguments, command="bench"))
        self.assertEqual(status, 0, output)
        with open(out / "runs.csv", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([(row["start"], row["seed"], row["frames"]) for row in rows],
                         [("0", "1", "90"), ("1", "2", "90")])
        for row in rows:
            self.assertGreaterEqual(float(row["coverage"]), 0.9)
            self.assertLess(float(row["ate_m"]), MAX_ATE_M)
        with open(out / "comparison.csv", encoding="utf-8") as file:
            lines = {(line["metric"], line["sequence"]): line for line in csv.DictReader(file)}
        ate = lines["ate_m", "all"]
        self.assertEqual((ate["pairs"], ate["equal"]), ("2", "0"))  # the settings reach one side
        status, output = self.finish(self.start(*arguments, command="bench"))
        self.assertEqual(output.count("done before"), 4, output)


if __name__ == "__main__":
    unittest.main()
