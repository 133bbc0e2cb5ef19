"""Figures of trajectories: what is drawn, and that it is drawn the same way each time."""

import pathlib
import re
import sys
import tempfile
import unittest

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "scripts"))

from vpslam_tools import plots  # noqa: E402
from vpslam_tools.errors import UserError  # noqa: E402
from vpslam_tools.trajectory import Trajectory  # noqa: E402


def circle(count=100, radius_m=2.0, scale=1.0, noise_m=0.0):
    angle = np.linspace(0, 5, count)
    positions = np.column_stack([radius_m * np.cos(angle), radius_m * np.sin(angle), 0 * angle + 1])
    positions += noise_m * np.random.default_rng(1).standard_normal(positions.shape)
    return Trajectory(angle, scale * positions, np.tile([0.0, 0.0, 0.0, 1.0], (count, 1)))


class Plots(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="vpslam-plots-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def test_writes_png_and_svg_that_repeat(self):
        estimates = {"points": circle(scale=0.3, noise_m=0.01), "lines": circle(scale=7)}
        first = plots.trajectory_figure(circle(), estimates, self.folder / "a", title="a title")
        second = plots.trajectory_figure(circle(), estimates, self.folder / "b", title="a title")
        self.assertEqual([path.name for path in first], ["a.png", "a.svg"])
        for one, other in zip(first, second):
            self.assertEqual(one.read_bytes(), other.read_bytes())
        figure = first[1].read_text()
        for text in ("a title", "truth", "points: ATE", "lines: ATE 0.0000 m", "x (m)", "y (m)",
                     "z (m)"):
            self.assertIn(text, figure)

    def test_errors_are_those_of_the_alignment(self):
        estimate = circle(scale=0.5, noise_m=0.01)  # 0.01 m in the truth's metres, in each axis
        figure = plots.trajectory_figure(circle(), {"x": estimate}, self.folder / "a")[1].read_text()
        error_m = float(re.search(r"x: ATE ([\d.]+) m", figure).group(1))
        self.assertAlmostEqual(error_m, 0.01 * 3 ** 0.5, delta=0.002)

    def test_gaps_are_not_bridged(self):
        stamps, values = plots._with_gaps(np.array([0.0, 0.1, 2.0, 2.1]), np.arange(4))
        self.assertEqual(len(values), 5)
        self.assertTrue(np.isnan(values[2]) and np.isnan(stamps[2]))

    def test_plane_is_the_one_of_the_motion(self):
        self.assertEqual(plots._plane(np.array([[0, 0, 0], [1, 0.1, 9]])), [0, 2])
        self.assertEqual(plots._plane(circle().positions), [0, 1])

    def test_path_length(self):
        self.assertAlmostEqual(plots.path_length_m(circle(1000)), 10, delta=1e-3)

    def test_too_few_poses_are_refused(self):
        with self.assertRaisesRegex(UserError, "only 2 poses"):
            plots.trajectory_figure(circle(), {"x": circle().select(np.arange(2))},
                                    self.folder / "a")


if __name__ == "__main__":
    unittest.main()
