"""How far an estimated trajectory is from the truth.

- ATE: distance between aligned and true positions.
- RPE: error of the motion between two poses one second apart, in the camera's axes: translation in
  metres (after the scale of the alignment) and rotation in degrees
  [J. Sturm et al., "A benchmark for the evaluation of RGB-D SLAM systems", IROS 2012].
- Rotation error: angle of  R_i^T (C E_i),  with E_i the estimated and R_i the true orientation
  (camera-to-world) and C the constant rotation from the estimate's world to the true one which
  minimises  sum |R_i - C E_i|^2  (Frobenius). C comes from the orientations alone, so positions do
  not disturb it. A constant rotation on the camera's side is not taken out: both trajectories
  speak of the same camera, and an error there is an error.
- Rotation drift: over every stretch that is half as long as the whole true path, the angle between
  estimated and true relative rotation, divided by the stretch's length; the median, in degrees per
  metre.
- Coverage: frames with a pose / frames of the sequence.
"""

from dataclasses import asdict, dataclass

import numpy as np

from vpslam_tools import rotations, trajectory
from vpslam_tools.alignment import align
from vpslam_tools.errors import UserError

MAX_DIFFERENCE_S = 0.02    # estimate to nearest truth
MAX_TRUTH_GAP_S = 0.25     # between the two truths that one is interpolated from
RPE_DELTA_S = 1.0
SAME_STAMP_S = 0.001       # a pose belongs to the frame with this time stamp; files round


@dataclass
class Statistics:
    rmse: float
    median: float
    max: float

    @staticmethod
    def of(errors):
        if len(errors) == 0:
            return None
        return Statistics(float(np.sqrt(np.mean(errors ** 2))), float(np.median(errors)),
                          float(np.max(errors)))


@dataclass
class Evaluation:
    ate_m: Statistics
    rpe_translation_m: Statistics  # None where no two poses are a second apart
    rpe_rotation_deg: Statistics
    rpe_delta_s: float
    rotation_deg: Statistics
    rotation_drift_deg_per_m: float  # None where the truth does not move
    scale: float
    alignment: str  # "sim3" or "se3"
    poses: int      # in the estimate
    compared: int   # of them, with a truth near
    frames: int     # of the sequence, None if not known
    coverage: float

    def as_dict(self):
        return asdict(self)


def evaluate(estimate, truth, frame_stamps_s=None, with_scale=True, interpolate=False):
    """estimate, truth: Trajectory. frame_stamps_s: every frame of the sequence, or None."""
    repeated = np.flatnonzero(np.diff(estimate.stamps_s) == 0)
    if len(repeated) > 0:
        raise UserError(f"the estimate has the time stamp {estimate.stamps_s[repeated[0]]:.6f} "
                        "twice; one pose a frame can be compared")
    if interpolate:
        paired_estimate, paired_truth = trajectory.associate_interpolated(
            estimate, truth, MAX_TRUTH_GAP_S)
    else:
        paired_estimate, paired_truth = trajectory.associate(estimate, truth, MAX_DIFFERENCE_S)
    count = len(paired_estimate)
    if count < 3:
        raise UserError(
            f"{count} of {len(estimate)} poses have a truth near in time, at least 3 are needed; "
            f"the estimate covers {_span(estimate.stamps_s)}, the truth {_span(truth.stamps_s)}"
            + _unit_hint("the truth", truth.stamps_s, estimate.stamps_s))

    similarity = align(paired_estimate.positions, paired_truth.positions, with_scale)
    ate = np.linalg.norm(similarity.apply(paired_estimate.positions) - paired_truth.positions,
                         axis=1)
    rpe_translation, rpe_rotation = relative_errors(paired_estimate, paired_truth,
                                                    similarity.scale)
    covered, frames = None, None
    if frame_stamps_s is not None:
        frames = len(frame_stamps_s)
        _, distance = trajectory.nearest(estimate.stamps_s, frame_stamps_s)
        covered = float(np.count_nonzero(distance <= SAME_STAMP_S)) / frames
        if covered == 0:
            raise UserError(
                f"none of the {frames} frames has the time stamp of a pose; the estimate covers "
                f"{_span(estimate.stamps_s)}, the frames {_span(frame_stamps_s)}"
                + _unit_hint("the frames", frame_stamps_s, estimate.stamps_s))
    return Evaluation(
        ate_m=Statistics.of(ate),
        rpe_translation_m=Statistics.of(rpe_translation),
        rpe_rotation_deg=Statistics.of(np.degrees(rpe_rotation)),
        rpe_delta_s=RPE_DELTA_S,
        rotation_deg=Statistics.of(np.degrees(rotation_errors(paired_estimate, paired_truth))),
        rotation_drift_deg_per_m=rotation_drift_deg_per_m(paired_estimate, paired_truth),
        scale=float(similarity.scale), alignment="sim3" if with_scale else "se3",
        poses=len(estimate), compared=count, frames=frames, coverage=covered)


def _span(stamps_s):
    return f"{stamps_s[0]:.3f} to {stamps_s[-1]:.3f} s"


def _unit_hint(name, stamps_s, right_s):
    """In words, if the stamps may be those of `right_s` in a finer unit."""
    length, right = (float(np.ptp(stamps)) for stamps in (stamps_s, right_s))
    for factor, unit in ((1e3, "milliseconds"), (1e6, "microseconds"), (1e9, "nanoseconds")):
        if right > 0 and 0.3 < length / right / factor < 3:
            return f"; {name} may be in {unit}: write seconds"
    return ""


def rotation_errors(estimate, truth):
    """Angles in rad; see the top of this file."""
    estimated = rotations.to_matrices(estimate.orientations)
    true = rotations.to_matrices(truth.orientations)
    constant = rotations.nearest_rotation(np.einsum("nij,nkj->ik", true, estimated))
    return rotations.angles_rad(np.swapaxes(true, 1, 2) @ constant @ estimated)


def rotation_drift_deg_per_m(estimate, truth):
    """See the top of this file."""
    way_m = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(truth.positions, axis=0),
                                                            axis=1))])
    if way_m[-1] <= 0:
        return None
    first = np.flatnonzero(way_m <= 0.5 * way_m[-1])
    second = np.minimum(np.searchsorted(way_m, way_m[first] + 0.5 * way_m[-1]), len(way_m) - 1)
    estimated, true = (rotations.to_matrices(poses.orientations) for poses in (estimate, truth))

    def turns(matrices):
        return np.swapaxes(matrices[first], 1, 2) @ matrices[second]

    angles = rotations.angles_rad(np.swapaxes(turns(true), 1, 2) @ turns(estimated))
    return float(np.median(np.degrees(angles) / (way_m[second] - way_m[first])))


def relative_errors(estimate, truth, scale):
    """Translation errors and rotation errors in rad of the motions over RPE_DELTA_S. The second
    pose is the one nearest to a second later, off by at most half a frame (or 0.02 s)."""
    stamps = estimate.stamps_s
    later, off = trajectory.nearest(stamps, stamps + RPE_DELTA_S)
    kept = off <= max(MAX_DIFFERENCE_S, 0.5 * float(np.median(np.diff(stamps))))
    kept &= later > np.arange(len(estimate))
    first, second = np.flatnonzero(kept), later[kept]

    def motions(poses, factor):
        matrices = rotations.to_matrices(poses.orientations)
        back = np.swapaxes(matrices[first], 1, 2)
        shift = factor * (poses.positions[second] - poses.positions[first])
        return back @ matrices[second], np.einsum("nij,nj->ni", back, shift)

    estimated_turn, estimated_shift = motions(estimate, scale)
    true_turn, true_shift = motions(truth, 1.0)
    # (true motion)^-1 (estimated motion): its translation has the length of the difference.
    return (np.linalg.norm(estimated_shift - true_shift, axis=1),
            rotations.angles_rad(np.swapaxes(true_turn, 1, 2) @ estimated_turn))
