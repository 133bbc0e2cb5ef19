"""What a run was worth, and several runs of one sequence together."""

import csv
import json
import math

import numpy as np

from vpslam_tools import evaluation, outcome, trajectory
from vpslam_tools.errors import UserError


def score(results, truth=None, least_frames=0):
    """Figures of one results folder of `vpslam run`; None where there is nothing to compare.
    truth: file with the true poses; default: the folder's own. least_frames: so many were to be
    tracked, whatever the folder says."""
    truth = truth or results / "truth.txt"
    with open(results / "frames.csv", encoding="utf-8") as file:
        frames = sum(1 for _ in csv.DictReader(file))
    # Frames that were dropped or skipped are in no table, but were there to be tracked.
    frames = max(frames, outcome.expected(json.loads((results / "summary.json").read_text())),
                 least_frames)
    figures = {"frames": frames, "poses": 0, "coverage": 0.0, "ate_m": None, "rotation_deg": None,
               "rotation_median_deg": None, "rotation_drift_deg_per_m": None, "rpe_m": None,
               "rpe_deg": None, "scale": None, "why": None}
    try:
        estimate = trajectory.read_trajectory(results / "trajectory.txt")
    except UserError:
        figures["why"] = "no pose: tracking never started"
        return figures
    figures["poses"] = len(estimate)
    figures["coverage"] = len(estimate) / frames if frames else 0.0
    if not truth.exists():
        figures["why"] = "no truth"
        return figures
    try:
        result = evaluation.evaluate(estimate, trajectory.read_trajectory(truth))
    except UserError as error:
        figures["why"] = str(error)
        return figures
    figures.update(ate_m=result.ate_m.rmse, rotation_deg=result.rotation_deg.rmse,
                   rotation_median_deg=result.rotation_deg.median,
                   rotation_drift_deg_per_m=result.rotation_drift_deg_per_m, scale=result.scale,
                   compared=result.compared)
    if result.rpe_translation_m:
        figures.update(rpe_m=result.rpe_translation_m.rmse, rpe_deg=result.rpe_rotation_deg.rmse)
    return figures


def combine(runs):
    """Median and worst over the runs of one sequence at one pace. `runs`: what runs.run_all() keeps;
    a run that failed counts as one without poses."""
    scores = [run["scores"] for run in runs if run["status"] == "done"]

    def over(key, worst):
        values = [each[key] for each in scores if each.get(key) is not None]
        return ({"median": float(np.median(values)), "worst": float(worst(values)),
                 "runs": len(values)} if values else None)

    coverages = [each["coverage"] for each in scores] + [0.0] * (len(runs) - len(scores))
    reasons = sorted({run.get("why") or run["scores"]["why"] for run in runs
                      if run["status"] != "done" or run["scores"]["why"]})
    return {"runs": len(runs), "failed": len(runs) - len(scores),
            "frames": max((each["frames"] for each in scores), default=0),
            "ate_m": over("ate_m", max), "rotation_deg": over("rotation_deg", max),
            "rotation_median_deg": over("rotation_median_deg", max),
            "rotation_drift_deg_per_m": over("rotation_drift_deg_per_m", max),
            "rpe_m": over("rpe_m", max), "rpe_deg": over("rpe_deg", max),
            "coverage": {"median": float(np.median(coverages)), "worst": min(coverages)},
            "why": "; ".join(reasons) or None}


def is_number(value):
    return value is not None and math.isfinite(value)
