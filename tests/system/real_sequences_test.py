"""Excerpts of real sequences, where they are at hand."""

import os
import pathlib
import unittest

import system

FRAMES = 200
# name: (ATE in m, coverage) that an excerpt of so many frames has to reach
LIMITS = {"red_kitchen": (0.05, 0.995), "car_park": (0.2, 0.995), "kitti00_start": (1.5, 0.995)}


def shared_data():
    return pathlib.Path(os.environ.get("VPSLAM_SHARED_DATA", system.SOURCE.parent / "shared/data"))


class RealSequences(system.SystemTest):
    def check(self, name):
        folder = shared_data() / name
        out = self.folder / name
        status, output = self.run_to_end(folder, "--out", out, "--frames", FRAMES)
        self.assertEqual(status, 0, output)
        result = self.evaluate(out, folder)
        max_ate_m, min_coverage = LIMITS[name]
        print(f"{name}: ATE {result['ate_m']['rmse']:.4f} m, {result['poses']} poses")
        self.assertLess(result["ate_m"]["rmse"], max_ate_m)
        self.assertGreaterEqual(result["poses"] / FRAMES, min_coverage)
        self.assert_nothing_left()
        return out

    def test_red_kitchen(self):
        first = self.check("red_kitchen")
        lossy = self.folder / "red_kitchen_lossy"
        status, output = self.run_to_end(shared_data() / "red_kitchen", "--out", lossy, "--frames",
                                         FRAMES, **system.BAD_NETWORK)
        self.assertEqual(status, 0, output)
        self.assert_same_results(first, lossy)

    def test_car_park(self):
        self.check("car_park")

    def test_kitti00_start(self):
        self.check("kitti00_start")

    def test_replay(self):
        """From images and from features, of real images."""
        for name in ("red_kitchen", "car_park"):
            recorded = self.folder / f"{name}_recorded"
            status, output = self.run_to_end(shared_data() / name, "--out", recorded, "--frames",
                                             60, "--record", "all")
            self.assertEqual(status, 0, output)
            for words in ([], ["--features"]):
                replayed = self.folder / f"{name}_replayed{''.join(words)}"
                status, output = self.run_to_end(recorded, "--out", replayed, *words,
                                                 command="replay")
                self.assertEqual(status, 0, output)
                self.assert_same_results(recorded, replayed)


if __name__ == "__main__":
    if shared_data().is_dir():
        unittest.main()
    print(f"SKIPPED: no real sequences in {shared_data()}; name the folder that holds "
          "red_kitchen, car_park and kitti00_start in VPSLAM_SHARED_DATA")
