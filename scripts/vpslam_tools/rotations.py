"""Rotations as unit quaternions x y z w (Hamilton) and as matrices, in arrays of n."""

import numpy as np


def normalised(quaternions):
    return quaternions / np.linalg.norm(quaternions, axis=-1, keepdims=True)


def to_matrices(quaternions):
    x, y, z, w = np.moveaxis(quaternions, -1, 0)
    rows = [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]
    return np.moveaxis(np.array(rows), -1, 0)


def slerp(first, second, share):
    """Along the shorter great circle from `first` (share 0) to `second` (share 1)."""
    dot = np.sum(first * second, axis=-1)
    second = np.where(dot[:, None] < 0, -second, second)
    angle = np.arctan2(np.linalg.norm(second - first, axis=-1),
                       np.linalg.norm(second + first, axis=-1)) * 2
    # sin(s a) / sin(a) through sinc, which is smooth at a = 0.
    def weight(s):
        return s * np.sinc(s * angle / np.pi) / np.sinc(angle / np.pi)
    return normalised(weight(1 - share)[:, None] * first + weight(share)[:, None] * second)


def angles_rad(matrices):
    """Angle of each rotation, in [0, pi]; from sine and cosine, so that small ones keep their
    digits."""
    sine = np.stack([matrices[:, 2, 1] - matrices[:, 1, 2], matrices[:, 0, 2] - matrices[:, 2, 0],
                     matrices[:, 1, 0] - matrices[:, 0, 1]], axis=-1)
    return np.arctan2(np.linalg.norm(sine, axis=-1), np.trace(matrices, axis1=1, axis2=2) - 1)


def nearest_rotation(matrix):
    """The rotation R that maximises trace(R^T matrix) [Umeyama 1991]."""
    u, _, vt = np.linalg.svd(matrix)
    return u @ np.diag([1, 1, np.sign(np.linalg.det(u @ vt))]) @ vt
