"""Excerpts of real sequences, where they are at hand."""

import os
import pathlib
import unittest

import system

FRAMES = 200
# name: (ATE in m, coverage) that an excerpt of so many frames has to reach
LIMITS = {"red_kitchen": (0.05, 0.9), "car_park": (0.3, 0.9)}


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


if __name__ == "__main__":
    if shared_data().is_dir():
        unittest.main()
    print(f"SKIPPED: no real sequences in {shared_data()}; name the folder that holds "
          "red_kitchen and car_park in VPSLAM_SHARED_DATA")
