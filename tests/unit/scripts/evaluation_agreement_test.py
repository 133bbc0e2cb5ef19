"""vpslam evaluate agrees to 1e-6 with a second computation (evaluation_reference.py): on a made-up
trajectory, on true trajectories of real sequences where they are at hand, made worse, and on any
pairs of files named in VPSLAM_TRAJECTORIES=ESTIMATE:TRUTH,..."""

import os
import pathlib
import sys
import tempfile
import unittest

import numpy as np

import evaluation_reference

SOURCE = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(SOURCE / "scripts"))
from vpslam_tools import evaluation, rotations, trajectory  # noqa: E402

SHARED = pathlib.Path(os.environ.get("VPSLAM_SHARED_DATA", SOURCE.parent / "shared" / "data"))
TOLERANCE = 1e-6


def write(poses, path):
    with open(path, "w", encoding="utf-8") as file:
        for stamp, position, orientation in zip(poses.stamps_s, poses.positions, poses.orientations):
            numbers = [*position, *orientation]
            file.write(f"{stamp:.6f} " + " ".join(f"{number:.9f}" for number in numbers) + "\n")


def made_worse(truth, seed):
    """Another scale, world and clock; noise; gaps."""
    generator = np.random.default_rng(seed)
    count = len(truth)
    world = rotations.normalised(generator.normal(size=4))
    spread = np.ptp(truth.positions, axis=0).max()
    positions = truth.positions + 0.02 * spread * generator.normal(size=(count, 3))
    positions = 0.37 * positions @ rotations.to_matrices(world[None])[0].T + [3.0, -5.0, 8.0]
    noise = rotations.normalised(np.column_stack([0.01 * generator.normal(size=(count, 3)),
                                                  np.ones(count)]))
    orientations = product(product(world[None].repeat(count, axis=0), truth.orientations), noise)
    estimate = trajectory.Trajectory(truth.stamps_s + generator.uniform(-1e-3, 1e-3, count),
                                     positions, orientations)
    return estimate.select(np.sort(generator.permutation(count)[:max(3, 4 * count // 5)]))


def product(a, b):
    ax, ay, az, aw = a.T
    bx, by, bz, bw = b.T
    return np.column_stack([aw * bx + ax * bw + ay * bz - az * by,
                            aw * by - ax * bz + ay * bw + az * bx,
                            aw * bz + ax * by - ay * bx + az * bw,
                            aw * bw - ax * bx - ay * by - az * bz])


class Agreement(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="vpslam-evaluation-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def check(self, estimate, truth):
        for with_scale in (True, False):
            result = evaluation.evaluate(trajectory.read_trajectory(estimate),
                                         trajectory.read_trajectory(truth), with_scale=with_scale)
            other = evaluation_reference.evaluate(evaluation_reference.read(estimate),
                                                  evaluation_reference.read(truth), with_scale)
            for name, value in (("ate_m", result.ate_m.rmse), ("scale", result.scale),
                                ("rotation_deg", result.rotation_deg.rmse),
                                ("rpe_m", result.rpe_translation_m.rmse),
                                ("rpe_deg", result.rpe_rotation_deg.rmse),
                                ("drift_deg_per_m", result.rotation_drift_deg_per_m)):
                self.assertAlmostEqual(value, other[name], delta=TOLERANCE,
                                       msg=f"{name} of {estimate}, with scale: {with_scale}")

    def check_made_worse(self, truth, seed):
        write(truth, self.folder / "truth.txt")
        write(made_worse(truth, seed), self.folder / "estimate.txt")
        self.check(self.folder / "estimate.txt", self.folder / "truth.txt")

    def test_made_up(self):
        time_s = np.arange(0, 20, 1 / 30)
        positions = np.column_stack([np.cos(time_s), 2 * np.sin(0.7 * time_s), 0.1 * time_s])
        orientations = rotations.normalised(np.column_stack(
            [np.sin(0.3 * time_s), np.cos(0.5 * time_s), 0.2 * time_s, np.ones_like(time_s)]))
        self.check_made_worse(trajectory.Trajectory(time_s, positions, orientations), 1)

    def test_true_trajectories_of_sequences(self):
        found = sorted(SHARED.glob("*/groundtruth.txt"))
        if not found:
            self.skipTest(f"no sequences in {SHARED}")
        for seed, path in enumerate(found):
            with self.subTest(path.parent.name):
                truth = trajectory.read_trajectory(path)
                self.check_made_worse(truth.select(np.arange(min(600, len(truth)))), seed)

    def test_named_trajectories(self):
        pairs = os.environ.get("VPSLAM_TRAJECTORIES")
        if not pairs:
            self.skipTest("VPSLAM_TRAJECTORIES names none")
        for pair in pairs.split(","):
            self.check(*pair.split(":"))


if __name__ == "__main__":
    unittest.main()
