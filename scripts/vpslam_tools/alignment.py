"""The similarity that brings an estimated trajectory onto the true one.

    true_i  ~  scale * rotation * estimated_i + translation     in the least-squares sense

S. Umeyama, "Least-squares estimation of transformation parameters between two point patterns",
PAMI 13(4), 1991. Where all positions lie on a line, the rotation about it is free; every error that
is computed from the aligned positions is the same for all of them.
"""

from dataclasses import dataclass

import numpy as np

from vpslam_tools import rotations
from vpslam_tools.errors import UserError


@dataclass
class Similarity:
    scale: float
    rotation: np.ndarray
    translation: np.ndarray

    def apply(self, positions):
        return self.scale * positions @ self.rotation.T + self.translation


def align(estimated, true, with_scale):
    """estimated, true: (n, 3) positions, paired."""
    estimated_mean, true_mean = estimated.mean(axis=0), true.mean(axis=0)
    centred_estimate, centred_truth = estimated - estimated_mean, true - true_mean
    rotation = rotations.nearest_rotation(centred_truth.T @ centred_estimate)
    scale = 1.0
    if with_scale:
        spread = np.sum(centred_estimate ** 2)
        if spread <= 1e-18 * max(1.0, np.sum(estimated ** 2)):
            raise UserError("all estimated positions coincide, so there is no scale to find; "
                            "compare with --se3")
        scale = np.sum(centred_truth * (centred_estimate @ rotation.T)) / spread
    return Similarity(scale, rotation, true_mean - scale * rotation @ estimated_mean)
