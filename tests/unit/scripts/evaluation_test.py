"""vpslam evaluate against values that were worked out by hand or by brute force."""

import io
import json
import math
import pathlib
import sys
import tempfile
import unittest
from contextlib import redirect_stderr, redirect_stdout

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "scripts"))
from vpslam_tools import cli, evaluation, rotations, trajectory  # noqa: E402
from vpslam_tools.alignment import align  # noqa: E402
from vpslam_tools.errors import UserError  # noqa: E402

IDENTITY = [0.0, 0.0, 0.0, 1.0]


def turn(axis, angle_deg):
    """Quaternion of a rotation about a coordinate axis."""
    quaternion = np.zeros(4)
    quaternion["xyz".index(axis)] = math.sin(math.radians(angle_deg) / 2)
    quaternion[3] = math.cos(math.radians(angle_deg) / 2)
    return quaternion


def times(a, b):
    """Quaternion product a * b, written out by Hamilton's rules."""
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return np.array([aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx,
                     aw * bz + ax * by - ay * bx + az * bw, aw * bw - ax * bx - ay * by - az * bz])


def poses(stamps, positions, orientations=None):
    if orientations is None:
        orientations = [IDENTITY] * len(stamps)
    return trajectory.Trajectory(np.array(stamps, float), np.array(positions, float),
                                 rotations.normalised(np.array(orientations, float)))


def random_rotation(generator):
    return rotations.to_matrices(rotations.normalised(generator.normal(size=(1, 4))))[0]


def rodrigues(vector):
    angle = np.linalg.norm(vector)
    if angle < 1e-12:
        return np.eye(3)
    x, y, z = vector / angle
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross


def brute_force_rmse(estimated, true, with_scale, generator):
    """Smallest RMSE that Levenberg-Marquardt on a numeric Jacobian finds from 20 random starts."""
    def residuals(p):
        scale = math.exp(p[6]) if with_scale else 1.0
        return (scale * estimated @ rodrigues(p[:3]).T + p[3:6] - true).ravel()
    best = math.inf
    for _ in range(20):
        p, damping = np.append(generator.normal(size=3) * 2, np.zeros(4)), 1e-3
        for _ in range(200):
            r = residuals(p)
            jacobian = np.stack([(residuals(p + d) - residuals(p - d)) / 2e-6
                                 for d in np.eye(7) * 1e-6], axis=1)
            step = np.linalg.solve(jacobian.T @ jacobian + damping * np.eye(7), -jacobian.T @ r)
            if np.sum(residuals(p + step) ** 2) < np.sum(r ** 2):
                p, damping = p + step, damping / 5
            else:
                damping *= 5
        best = min(best, math.sqrt(np.sum(residuals(p) ** 2) / len(true)))
    return best


class Alignment(unittest.TestCase):
    def test_closed_form(self):
        # Truth -1, 0, 1 on the x axis; the estimate's middle point is off by d = 1.5 across. By
        # symmetry no rotation helps, and with centred coordinates
        #   scale = sum(t.e) / sum(e.e) = 2 / (2 + 2 d^2 / 3) = 4/7
        #   ATE^2 = (sum(t.t) - scale sum(t.e)) / 3 = (2 - 8/7) / 3 = 2/7;  without scale 1.5 / 3.
        true = poses([0, 1, 2], [[-1, 0, 0], [0, 0, 0], [1, 0, 0]])
        estimate = poses([0, 1, 2], [[-1, 0, 0], [0, 1.5, 0], [1, 0, 0]])
        with_scale = evaluation.evaluate(estimate, true)
        self.assertAlmostEqual(with_scale.scale, 4 / 7, places=12)
        self.assertAlmostEqual(with_scale.ate_m.rmse, math.sqrt(2 / 7), places=12)
        without = evaluation.evaluate(estimate, true, with_scale=False)
        self.assertEqual(without.scale, 1.0)
        self.assertAlmostEqual(without.ate_m.rmse, math.sqrt(0.5), places=12)
        self.assertAlmostEqual(without.ate_m.max, 1.0, places=12)     # |(0, 1)| of (0, 2/3 * 1.5)
        self.assertAlmostEqual(without.ate_m.median, 0.5, places=12)  # |(0, 1/3 * 1.5)|

    def test_finds_the_similarity_that_was_applied(self):
        generator = np.random.default_rng(1)
        for _ in range(100):
            rotation, shift = random_rotation(generator), generator.normal(size=3) * 10
            scale = math.exp(generator.normal())
            estimated = generator.normal(size=(10, 3))
            found = align(estimated, scale * estimated @ rotation.T + shift, with_scale=True)
            self.assertAlmostEqual(found.scale, scale, places=9)
            np.testing.assert_allclose(found.rotation, rotation, atol=1e-9)
            np.testing.assert_allclose(found.translation, shift, atol=1e-8)

    def test_is_as_good_as_brute_force(self):
        generator = np.random.default_rng(2)
        for with_scale in (True, False):
            for noise in (0.1, 1.0):
                estimated = generator.normal(size=(8, 3))
                true = (1.3 * estimated @ random_rotation(generator).T
                        + noise * generator.normal(size=(8, 3)))
                found = align(estimated, true, with_scale).apply(estimated) - true
                self.assertAlmostEqual(math.sqrt(np.sum(found ** 2) / 8),
                                       brute_force_rmse(estimated, true, with_scale, generator),
                                       places=6)

    def test_never_mirrors(self):
        generator = np.random.default_rng(3)
        estimated = generator.normal(size=(20, 3))
        found = align(estimated, estimated * [1, 1, -1], with_scale=True)
        self.assertAlmostEqual(np.linalg.det(found.rotation), 1.0, places=9)

    def test_positions_on_a_line(self):
        line = np.arange(5.0)[:, None] * [1.0, 2.0, -1.0]
        found = align(line, 3 * line + [1, 1, 1], with_scale=True)
        np.testing.assert_allclose(found.apply(line), 3 * line + [1, 1, 1], atol=1e-12)

    def test_coinciding_positions_have_no_scale(self):
        with self.assertRaisesRegex(UserError, "--se3"):
            align(np.ones((5, 3)), np.eye(5, 3), with_scale=True)
        align(np.ones((5, 3)), np.eye(5, 3), with_scale=False)


class RotationError(unittest.TestCase):
    def test_constant_rotation_is_taken_out(self):
        # E_i = C^-1 R_i e_i with e_i = -2, 0, 2 degrees about the camera's z: the best constant
        # rotation is C, by symmetry, and leaves 2, 0, 2.
        constant = times(turn("x", 40), turn("y", -75))
        inverse = constant * [-1, -1, -1, 1]
        true, estimated = [], []
        for angle, error in ((10, -2), (10, 0), (10, 2)):
            true.append(times(turn("z", angle), turn("x", 20)))
            estimated.append(times(times(inverse, true[-1]), turn("z", error)))
        estimated[1] = -estimated[1]  # the same rotation
        places = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
        result = evaluation.evaluate(poses([0, 1, 2], places, estimated),
                                     poses([0, 1, 2], places, true))
        self.assertAlmostEqual(result.rotation_deg.max, 2.0, places=9)
        self.assertAlmostEqual(result.rotation_deg.median, 2.0, places=9)
        self.assertAlmostEqual(result.rotation_deg.rmse, math.sqrt(8 / 3), places=9)

    def test_angles_up_to_a_half_turn(self):
        angles = [0.0, 1e-7, 0.5, 90.0, 179.0, 180.0]
        matrices = rotations.to_matrices(np.array([turn("y", angle) for angle in angles]))
        np.testing.assert_allclose(np.degrees(rotations.angles_rad(matrices)), angles, atol=1e-12)


class RelativeError(unittest.TestCase):
    def test_a_jump_is_seen_by_the_pairs_that_span_it(self):
        # 10 Hz for 4 s along x; from 2 s on the estimate is off by 0.1 m and 3 degrees. Of the 31
        # pairs a second apart, the 10 that start at 1.0 .. 1.9 s span the jump.
        stamps = np.arange(41) / 10
        positions = np.stack([stamps, 0 * stamps, 0 * stamps], axis=1)
        jumped = stamps >= 1.95
        estimate = poses(stamps, positions + jumped[:, None] * [0, 0.1, 0],
                         [turn("x", 3) if late else IDENTITY for late in jumped])
        translation, rotation = evaluation.relative_errors(estimate, poses(stamps, positions), 1.0)
        self.assertEqual(len(translation), 31)
        self.assertEqual(np.count_nonzero(translation > 1e-9), 10)
        self.assertAlmostEqual(translation.max(), 0.1, places=12)
        np.testing.assert_allclose(np.degrees(rotation[translation > 1e-9]), 3.0, atol=1e-9)
        self.assertLess(rotation[translation <= 1e-9].max(), 1e-9)

    def test_motion_is_seen_in_the_camera_s_axes_and_scaled(self):
        # Half size, in a world turned by 90 degrees: no error at scale 2.
        stamps = np.arange(30) / 10
        true = poses(stamps, np.stack([stamps ** 2, stamps, 0 * stamps], axis=1),
                     [turn("z", 20 * t) for t in stamps])
        estimate = poses(stamps, np.stack([-stamps, stamps ** 2, 0 * stamps], axis=1) / 2,
                         [turn("z", 90 + 20 * t) for t in stamps])
        translation, rotation = evaluation.relative_errors(estimate, true, 2.0)
        self.assertEqual(len(translation), 20)
        self.assertLess(max(translation.max(), rotation.max()), 1e-9)

    def test_slow_sequences_have_no_pairs(self):
        stamps = [0.0, 5.0, 10.0]
        where = [[0, 0, 0], [1, 0, 0], [1, 1, 0]]
        result = evaluation.evaluate(poses(stamps, where), poses(stamps, where))
        self.assertIsNone(result.rpe_translation_m)


class Association(unittest.TestCase):
    def test_nearest_within_20_ms(self):
        true = poses([10.0, 10.1, 10.2, 10.3], [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 1]])
        estimate = poses([9.985, 10.115, 10.179, 10.221, 10.30], [[0, 0, 0]] * 5)
        kept, matched = trajectory.associate(estimate, true, 0.02)
        np.testing.assert_array_equal(kept.stamps_s, [9.985, 10.115, 10.30])
        np.testing.assert_array_equal(matched.stamps_s, [10.0, 10.1, 10.3])

    def test_interpolation(self):
        true = poses([0.0, 0.1, 0.2, 1.2], [[0, 0, 0], [1, 0, 0], [1, 1, 0], [9, 9, 9]],
                     [turn("z", 0), turn("z", 40), -turn("z", 60), turn("z", 0)])
        estimate = poses([-0.01, 0.0, 0.025, 0.15, 0.2, 0.7, 1.3], [[0, 0, 0]] * 7)
        kept, matched = trajectory.associate_interpolated(estimate, true, 0.25)
        np.testing.assert_array_equal(kept.stamps_s, [0.0, 0.025, 0.15, 0.2])
        np.testing.assert_allclose(
            matched.positions, [[0, 0, 0], [0.25, 0, 0], [1, 0.5, 0], [1, 1, 0]], atol=1e-12)
        for found, angle in zip(matched.orientations, [0, 10, 50, 60]):
            self.assertAlmostEqual(abs(np.dot(found, turn("z", angle))), 1.0, places=12)

    def test_coverage_counts_frames_with_a_pose(self):
        where = [[0, 0, 0], [1, 0, 0], [1, 1, 0]]
        stamps = [5.0, 5.1, 5.2]
        result = evaluation.evaluate(poses(stamps, where), poses(stamps, where),
                                     frame_stamps_s=np.array([4.9, 5.0, 5.1, 5.2000004, 5.3]))
        self.assertEqual(result.frames, 5)
        self.assertAlmostEqual(result.coverage, 0.6)


class Command(unittest.TestCase):
    TRUTH = "# a comment\n0.0 0 0 0 0 0 0 1\n0.1 1 0 0 0 0 0 1\n0.2 1 1 0 0 0 0 1\n"

    def run_command(self, estimate, truth=TRUTH, extra=()):
        with tempfile.TemporaryDirectory() as folder:
            for name, text in (("estimate.txt", estimate), ("truth.txt", truth),
                               ("rgb.txt", "0.0 a.png\n0.1 b.png\n0.2 c.png\n0.3 d.png\n")):
                pathlib.Path(folder, name).write_text(text)
            out, err = io.StringIO(), io.StringIO()
            with redirect_stdout(out), redirect_stderr(err):
                status = cli.main(["evaluate", f"{folder}/estimate.txt", f"{folder}/truth.txt"]
                                  + [item.format(folder) for item in extra])
            return status, out.getvalue(), err.getvalue()

    def test_json(self):
        status, out, _ = self.run_command(self.TRUTH, extra=["--json", "--frames", "{}/rgb.txt"])
        self.assertEqual(status, 0)
        result = json.loads(out)
        self.assertLess(result["ate_m"]["rmse"], 1e-12)
        self.assertEqual(result["coverage"], 0.75)
        self.assertEqual((result["poses"], result["compared"], result["frames"]), (3, 3, 4))

    def test_text(self):
        status, out, _ = self.run_command(self.TRUTH, extra=["--se3", "--interpolate"])
        self.assertEqual(status, 0)
        for word in ("ATE", "RPE", "rotation error", "scale", "coverage", "se3"):
            self.assertIn(word, out)

    def test_bad_input_is_told_in_one_line(self):
        two = "0.0 0 0 0 0 0 0 1\n0.1 1 0 0 0 0 0 1\n"
        cases = {
            "holds no pose": "# nothing\n",
            "estimate.txt:2: is not a pose": "0.0 0 0 0 0 0 0 1\n0.1 1 0 0\n",
            "estimate.txt:1: is not a pose": "image.png 0 0 0 0 0 0 1\n",
            "estimate.txt:1: holds NaN": "0.0 nan 0 0 0 0 0 1\n",
            "estimate.txt:3: the quaternion is zero": two + "0.2 1 1 0 0 0 0 0\n",
            "2 of 2 poses have a truth near": two,
            "0 of 3 poses have a truth near in time": self.TRUTH.replace("\n0.", "\n7.").lstrip(),
            "0.100000 twice": two + "0.1 1 0 0 0 0 0 1\n",
            "--se3": "0.0 1 1 1 0 0 0 1\n0.1 1 1 1 0 0 0 1\n0.2 1 1 1 0 0 0 1\n",
        }
        for expected, estimate in cases.items():
            with self.subTest(expected):
                status, out, err = self.run_command(estimate)
                self.assertEqual((status, out), (1, ""))
                self.assertIn(expected, err)
                self.assertEqual(err.count("\n"), 1, err)

    def test_missing_file(self):
        err = io.StringIO()
        with redirect_stderr(err):
            self.assertEqual(cli.main(["evaluate", "/nonexistent/a", "/nonexistent/b"]), 1)
        self.assertIn("/nonexistent/a: cannot be read", err.getvalue())


if __name__ == "__main__":
    unittest.main()
