"""The figures of one results folder of `vpslam run`."""

import csv

import numpy as np

from vpslam_tools import evaluation, frame_figure, map_figure, plots, time_figure, trajectory
from vpslam_tools.alignment import align
from vpslam_tools.benchmark import timing
from vpslam_tools.errors import UserError


def draw(results, title, folder):
    """Into `folder`: trajectory, map, frame and times, as far as the run got. Returns the paths."""
    written = time_figure.time_figure(
        {"VP-SLAM": timing.read_times(results)["tracking"]["total"]}, folder / "times", title,
        interval_ms(results))
    if (results / "preview.jpg").exists():
        written += frame_figure.frame_figure(results / "preview.jpg", folder / "frame", title)
    if not (results / "trajectory.txt").read_text().strip():
        return written  # nothing was tracked
    estimate = trajectory.read_trajectory(results / "trajectory.txt")
    ply_map = map_figure.read_ply(results / "map.ply")
    positions, unit = estimate.positions, "units of the map"
    try:
        truth = trajectory.read_trajectory(results / "truth.txt")
        written += plots.trajectory_figure(truth, {"VP-SLAM": estimate}, folder / "trajectory", title)
    except UserError:  # there is none, or too little of it
        written += plots.path_figure({"VP-SLAM": estimate}, folder / "trajectory", title)
    else:
        paired, paired_truth = trajectory.associate(estimate, truth, evaluation.MAX_DIFFERENCE_S)
        similarity = align(paired.positions, paired_truth.positions, with_scale=True)
        ply_map, positions = ply_map.moved(similarity), similarity.apply(positions)
        unit = "m"
    return written + map_figure.map_figure(ply_map, positions, folder / "map", title, unit)


def interval_ms(results):
    with open(results / "frames.csv", encoding="utf-8") as file:
        stamps_s = [float(row["timestamp"]) for row in csv.DictReader(file)]
    return 1000 * float(np.median(np.diff(stamps_s))) if len(stamps_s) > 1 else None
