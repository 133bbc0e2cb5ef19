"""Two variants on one sequence, run by run: over the frames that both tracked.

A variant that is lost early is not judged by its small error, and one that goes on where the other
is lost not by what it met there: of each pair of runs with one seed, only the frames that both have a
pose for count, and each trajectory is aligned on these.
"""

import pathlib

import numpy as np

from vpslam_tools import evaluation, trajectory
from vpslam_tools.errors import UserError

MAX_RATIO = 0.05         # how much higher the ATE may be ...
MAX_DIFFERENCE_M = 0.002  # ... or by this, or by the reference's spread over the seeds
MAX_COVERAGE_LOSS = 0.01


def ates_over_common_frames(first, second):
    """(number of frames that both results folders have a pose for, ATE of the first in m, of the
    second); no ATEs where there are too few for an alignment."""
    try:
        estimates = [trajectory.read_trajectory(folder / "trajectory.txt")
                     for folder in (first, second)]
    except UserError:
        return 0, None, None
    ours, theirs = trajectory.associate(*estimates, evaluation.SAME_STAMP_S)
    if len(ours) == 0:
        return 0, None, None
    try:
        truth = trajectory.read_trajectory(first / "truth.txt")
        return len(ours), *(evaluation.evaluate(each, truth).ate_m.rmse for each in (ours, theirs))
    except UserError:
        return len(ours), None, None


def compare(reference_runs, runs):
    """Whether `runs` are never worse than `reference_runs` of the same sequence, paired by seed.

    {"pairs": [{"seed", "frames", "reference_ate_m", "ate_m", "reference_coverage", "coverage"}],
     "allowed_m", "worse_by_m" (the most over the seeds; both None without any common frames),
     "coverage_loss" (likewise), "worse": [what is worse]}"""
    pairs = []
    by_seed = {run["seed"]: run for run in runs}
    for reference in reference_runs:
        run = by_seed.get(reference["seed"])
        if run is None:
            continue
        frames, reference_ate_m, ate_m = ates_over_common_frames(
            pathlib.Path(reference["results"]), pathlib.Path(run["results"]))
        pairs.append({"seed": run["seed"], "frames": frames, "reference_ate_m": reference_ate_m,
                      "ate_m": ate_m, "reference_coverage": _coverage(reference),
                      "coverage": _coverage(run)})
    return dict(judge(pairs), pairs=pairs)


def judge(pairs):
    """What compare() says of its pairs."""
    compared = [pair for pair in pairs if pair["ate_m"] is not None]
    coverage_loss = max((pair["reference_coverage"] - pair["coverage"] for pair in pairs),
                        default=None)
    worse, allowed_m, worse_by_m = [], None, None
    if compared:
        references = np.array([pair["reference_ate_m"] for pair in compared])
        differences = np.array([pair["ate_m"] for pair in compared]) - references
        allowed = np.maximum(MAX_RATIO * references, max(MAX_DIFFERENCE_M, np.ptp(references)))
        worst = int(np.argmax(differences - allowed))
        allowed_m, worse_by_m = float(allowed[worst]), float(differences[worst])
        if worse_by_m > allowed_m:
            worse.append("ATE")
    if coverage_loss is not None and coverage_loss > MAX_COVERAGE_LOSS:
        worse.append("coverage")
    return {"allowed_m": allowed_m, "worse_by_m": worse_by_m, "coverage_loss": coverage_loss,
            "worse": worse}


def _coverage(run):
    return run["scores"]["coverage"] if run["status"] == "done" else 0.0
