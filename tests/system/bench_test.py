"""`vpslam bench` on a folder in TUM's layout, as a newcomer has one: a trajectory, a table, pictures."""

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


if __name__ == "__main__":
    unittest.main()
