"""Trajectories in TUM's text format: `timestamp tx ty tz qx qy qz qw`, camera-to-world."""

from dataclasses import dataclass

import numpy as np

from vpslam_tools import rotations, text_lines
from vpslam_tools.errors import UserError


@dataclass
class Trajectory:
    """Poses in order of time. stamps_s: (n,); positions: (n, 3); orientations: (n, 4) unit
    quaternions x y z w; both of the camera in the world."""
    stamps_s: np.ndarray
    positions: np.ndarray
    orientations: np.ndarray

    def __len__(self):
        return len(self.stamps_s)

    def select(self, indices):
        return Trajectory(self.stamps_s[indices], self.positions[indices],
                          self.orientations[indices])


POSE_FORM = "a line holds 8 numbers: timestamp tx ty tz qx qy qz qw"


def _pose(words):
    if len(words) == 12:
        raise ValueError("has 12 numbers, as KITTI's poses have; " + POSE_FORM)
    if len(words) != 8:
        raise ValueError("is not a pose; " + POSE_FORM)
    try:
        row = [float(word) for word in words]
    except ValueError:
        raise ValueError("is not a pose; " + POSE_FORM) from None
    if not np.all(np.isfinite(row)):
        raise ValueError("holds NaN or infinity; remove the line")
    text_lines.seconds(words[0])
    if np.linalg.norm(row[4:]) < 1e-6:
        raise ValueError("the quaternion is zero; identity is '0 0 0 1'")
    return row


def read_trajectory(path):
    rows = text_lines.rows(path, _pose)
    if not rows:
        raise UserError(f"{path}: holds no pose")
    table = np.array(rows)
    table = table[np.argsort(table[:, 0], kind="stable")]
    return Trajectory(table[:, 0], table[:, 1:4], rotations.normalised(table[:, 4:]))


def _listed_stamp(words):
    try:
        float(words[0])
    except ValueError:
        raise ValueError("does not start with a time stamp; a line reads: timestamp filename"
                         ) from None
    if len(words) > 2 and words[1].isdigit():
        raise ValueError("has a decimal comma; write times with a point")
    return text_lines.seconds(words[0])


def read_frame_stamps(path):
    """Time stamps of an rgb.txt: the first field of each line; sorted, repeated ones once."""
    stamps = text_lines.rows(path, _listed_stamp)
    if not stamps:
        raise UserError(f"{path}: lists no frame")
    return np.unique(stamps)


def nearest(sorted_stamps, stamps):
    """For each of `stamps` the index of the nearest in `sorted_stamps`, and the distance."""
    right = np.clip(np.searchsorted(sorted_stamps, stamps), 1, max(1, len(sorted_stamps) - 1))
    left = right - 1
    right = np.minimum(right, len(sorted_stamps) - 1)
    index = np.where(np.abs(stamps - sorted_stamps[left]) <= np.abs(sorted_stamps[right] - stamps),
                     left, right)
    return index, np.abs(sorted_stamps[index] - stamps)


def associate(estimate, truth, max_difference_s):
    """Pairs each estimated pose with the truth nearest in time; drops those without one near."""
    index, distance = nearest(truth.stamps_s, estimate.stamps_s)
    kept = distance <= max_difference_s
    return estimate.select(kept), truth.select(index[kept])


def associate_interpolated(estimate, truth, max_gap_s):
    """Pairs each estimated pose with the truth interpolated to its time (positions linearly,
    orientations along the great circle) between neighbours at most max_gap_s apart."""
    after = np.searchsorted(truth.stamps_s, estimate.stamps_s)
    exact = np.isin(estimate.stamps_s, truth.stamps_s)
    inside = exact | ((after > 0) & (after < len(truth)))
    estimate, after = estimate.select(inside), after[inside]
    after = np.clip(after, 1, max(1, len(truth) - 1)) if len(truth) > 1 else after * 0
    before = np.maximum(after - 1, 0)
    gap = truth.stamps_s[after] - truth.stamps_s[before]
    share = np.divide(estimate.stamps_s - truth.stamps_s[before], gap, out=np.zeros(len(gap)),
                      where=gap > 0)
    near = (gap <= max_gap_s) | (share == 0) | (share == 1)
    estimate, before, after, share = estimate.select(near), before[near], after[near], share[near]
    positions = ((1 - share)[:, None] * truth.positions[before]
                 + share[:, None] * truth.positions[after])
    orientations = rotations.slerp(truth.orientations[before], truth.orientations[after], share)
    return estimate, Trajectory(estimate.stamps_s, positions, orientations)
