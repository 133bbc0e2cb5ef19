"""Figures of maps and times, and `evaluate --plot`."""

import pathlib
import subprocess
import sys
import tempfile
import unittest

import numpy as np

SOURCE = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(SOURCE / "scripts"))

from vpslam_tools import map_figure, time_figure  # noqa: E402
from vpslam_tools.alignment import Similarity  # noqa: E402
from vpslam_tools.errors import UserError  # noqa: E402

POINTS_ONLY = """ply
format ascii 1.0
comment points grey, keyframes red
element vertex 3
property float x
property float y
property float z
property uchar red
property uchar green
property uchar blue
end_header
1 2 3 160 160 160
4 5 6 160 160 160
0 0 1 220 40 40
"""
WITH_LINES = """ply
format ascii 1.0
element vertex 4
element edge 1
property int vertex1
property int vertex2
end_header
1 2 3 160 160 160
0 0 1 220 40 40
7 8 9 0 114 178
7 8 10 0 114 178
2 3
"""
PATH = np.array([[0, 0, 0], [1, 0.5, 0], [2, 0.2, 0.1]])


class Figures(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="vpslam-figures-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.ply = self.folder / "map.ply"

    def read(self, text):
        self.ply.write_text(text)
        return map_figure.read_ply(self.ply)

    def test_points_and_keyframes(self):
        ply_map = self.read(POINTS_ONLY)
        np.testing.assert_array_equal(ply_map.points, [[1, 2, 3], [4, 5, 6]])
        np.testing.assert_array_equal(ply_map.keyframes, [[0, 0, 1]])
        self.assertEqual(ply_map.segments.shape, (0, 2, 3))

    def test_ends_of_lines_are_no_points(self):
        ply_map = self.read(WITH_LINES)
        np.testing.assert_array_equal(ply_map.points, [[1, 2, 3]])
        np.testing.assert_array_equal(ply_map.segments, [[[7, 8, 9], [7, 8, 10]]])

    def test_moves_by_a_similarity(self):
        moved = self.read(WITH_LINES).moved(Similarity(2.0, np.eye(3), np.array([1.0, 0, 0])))
        np.testing.assert_array_equal(moved.points, [[3, 4, 6]])
        np.testing.assert_array_equal(moved.segments, [[[15, 16, 18], [15, 16, 20]]])

    def test_not_a_map(self):
        for text in ("", "ply\nformat binary_little_endian 1.0\nelement vertex 0\nend_header\n",
                     POINTS_ONLY.replace("4 5 6", "4 5 x"), WITH_LINES.replace("2 3\n", "2 9\n")):
            with self.subTest(text), self.assertRaises(UserError):
                self.read(text)
        with self.assertRaises(UserError):
            map_figure.read_ply(self.folder / "none.ply")

    def test_map_from_three_sides(self):
        for name, text in (("points", POINTS_ONLY), ("lines", WITH_LINES)):
            paths = map_figure.map_figure(self.read(text), PATH, self.folder / name, title="a title")
            self.assertEqual([path.name for path in paths], [f"{name}.png", f"{name}.svg"])
            again = map_figure.map_figure(self.read(text), PATH, self.folder / "b", title="a title")
            self.assertEqual(paths[1].read_bytes(), again[1].read_bytes())
        for words in ("a title", "x (m)", "y (m)", "z (m)", "1 points", "1 lines", "1 keyframes"):
            self.assertIn(words, paths[1].read_text())

    def test_times(self):
        paths = time_figure.time_figure({"a": np.array([1.0, np.nan, 3.0, 100.0])},
                                        self.folder / "times", interval_ms=33.3)
        figure = paths[1].read_text()
        self.assertIn("a: median 3.0 ms, mean 34.7 ms", figure)
        self.assertIn("between images: 33.3 ms", figure)
        time_figure.time_figure({"none": np.array([np.nan])}, self.folder / "empty")

    def test_evaluate_plots(self):
        for name, scale in (("truth.txt", 1.0), ("estimate.txt", 0.5)):
            (self.folder / name).write_text("".join(
                f"{i / 10} {scale * i} {scale * i * i / 9} 0 0 0 0 1\n" for i in range(30)))
        done = subprocess.run(
            [SOURCE / "scripts" / "vpslam", "evaluate", self.folder / "estimate.txt",
             self.folder / "truth.txt", "--plot", self.folder / "new" / "plots"],
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self.assertEqual(done.returncode, 0, done.stdout)
        for ending in ("png", "svg"):
            self.assertTrue((self.folder / "new" / "plots" / f"trajectory.{ending}").is_file())


if __name__ == "__main__":
    unittest.main()
