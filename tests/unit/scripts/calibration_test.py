"""The procedure of docs/calibration.md finds the camera that took the pictures, however it was
held: what the player plays are pixels as the sensor stores them."""

import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[3]

try:
    import cv2
    import numpy as np
except ImportError:
    print("SKIPPED: python3-opencv is not installed")
    sys.exit(0)

WIDTH, HEIGHT = 640, 360
K = np.array([[465., 0, 305.], [0, 464., 191.], [0, 0, 1]])
DISTORTION = np.array([.08, -.15, 0, 0, 0])
COLUMNS, ROWS, SQUARE_M = 9, 6, 0.025  # inner corners, as in the document


def pictures(count):
    """Of a chessboard, in random poses."""
    rng = np.random.default_rng(3)
    px = 60
    board = np.full(((ROWS + 3) * px, (COLUMNS + 3) * px), 255, np.uint8)
    for y in range(ROWS + 1):
        for x in range(COLUMNS + 1):
            if (x + y) % 2 == 0:
                board[(y + 1) * px:(y + 2) * px, (x + 1) * px:(x + 2) * px] = 20
    grid = np.stack(np.meshgrid(np.arange(WIDTH), np.arange(HEIGHT)), -1).reshape(-1, 1, 2)
    rays = cv2.undistortPoints(grid.astype(np.float64), K, DISTORTION).reshape(-1, 2)
    rays = np.c_[rays, np.ones(len(rays))]
    while count > 0:
        rotation = cv2.Rodrigues(rng.uniform(-.6, .6, 3))[0]
        translation = [rng.uniform(-.16, .1), rng.uniform(-.12, .06), rng.uniform(.28, .5)]
        on_board = rays @ np.linalg.inv(np.c_[rotation[:, :2], translation]).T
        on_board = on_board[:, :2] / on_board[:, 2:]
        x, y = ((on_board / SQUARE_M + 2) * px - .5).astype(np.float32).T.reshape(2, HEIGHT, WIDTH)
        image = cv2.remap(board, x, y, cv2.INTER_AREA, borderValue=160)
        image = cv2.GaussianBlur(image, (0, 0), .7)
        if cv2.findChessboardCornersSB(image, (COLUMNS, ROWS))[0]:
            count -= 1
            yield image


def jpeg_with_orientation(image, orientation):
    """As a phone stores it: an APP1 segment with a TIFF directory of one entry (tag 0x0112)."""
    jpeg = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, 98])[1].tobytes()
    tiff = (b"MM\0*\0\0\0\x08" + b"\0\x01" + b"\x01\x12\0\x03\0\0\0\x01"
            + bytes([0, orientation, 0, 0]) + b"\0\0\0\0")
    exif = b"Exif\0\0" + tiff
    return jpeg[:2] + b"\xff\xe1" + (len(exif) + 2).to_bytes(2, "big") + exif + jpeg[2:]


class Calibration(unittest.TestCase):
    def test_of_pictures_that_a_phone_turned(self):
        text = (SOURCE / "docs" / "calibration.md").read_text()
        procedure = re.search(r"```python\n(.*?)```", text, re.DOTALL).group(1)
        with tempfile.TemporaryDirectory() as folder:
            board = pathlib.Path(folder) / "board"
            board.mkdir()
            for number, image in enumerate(pictures(14)):
                orientation = 6 if number % 2 else 1  # held upright, held level
                (board / f"{number:02}.jpg").write_bytes(
                    jpeg_with_orientation(image, orientation))
            turned = cv2.imread(str(board / "01.jpg"), cv2.IMREAD_GRAYSCALE)
            self.assertEqual(turned.shape, (WIDTH, HEIGHT), "the tag is there, and is obeyed")
            done = subprocess.run([sys.executable, "-c", procedure], cwd=folder, text=True,
                                  capture_output=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        lines = dict(re.findall(r"^(\w+): (\S+)$", done.stdout, re.MULTILINE))
        found = {name: float(value) for name, value in lines.items()}
        self.assertEqual((found["width"], found["height"]), (WIDTH, HEIGHT), done.stdout)
        for name, true in (("fx", 465), ("fy", 464), ("cx", 305), ("cy", 191)):
            self.assertAlmostEqual(found[name], true, delta=4, msg=name)


if __name__ == "__main__":
    unittest.main()
