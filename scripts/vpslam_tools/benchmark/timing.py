"""Time per stage, from frames.csv and keyframes.csv: the paper's table II.

A frame's critical path goes from the image published to its pose published (`total`):
    transport, features, wait_for_lines, initial_pose, rotation, translation, local_map
one after the other; `rest` is what total has beyond their sum. Beside it, on other cores, the player
decodes the next image, detectors find lines and vanishing points (of which the frame only sees
wait_for_lines), and the backend maps. In lockstep a frame that follows a keyframe is not published
before the map is up to date, so mapping lengthens the run, but no frame's total.
"""

import csv

import numpy as np

CRITICAL = ["transport", "features", "wait_for_lines", "initial_pose", "rotation", "translation",
            "local_map"]
BESIDE = ["decode", "lines", "vps"]
TRACKING = CRITICAL + ["total"] + BESIDE
MAPPING = ["insertion", "feature_culling", "feature_creation", "keyframe_culling", "local_ba",
           "total"]


def read_column(rows, column):
    values = [float(row[column]) if row.get(column) else np.nan for row in rows]
    return np.array(values, float)


def read_times(results):
    """{"tracking": {stage: (n,) ms, NaN where it did not run}, "mapping": {...}}"""
    def rows(name):
        with open(results / name, encoding="utf-8") as file:
            return list(csv.DictReader(file))
    frames, keyframes = rows("frames.csv"), rows("keyframes.csv")
    tracking = {stage: read_column(frames, f"{stage}_ms") for stage in TRACKING}
    spent = np.nansum(np.array([tracking[stage] for stage in CRITICAL]), axis=0)
    tracking["rest"] = tracking["total"] - spent
    return {"tracking": tracking,
            "mapping": {stage: read_column(keyframes, f"{stage}_ms") for stage in MAPPING}}


def frontend_work_ms(tracking):
    """(n,) of each frame: from image to pose, without transport and without waiting for lines.
    tracking: of read_times(). NaN where a frame has no total."""
    waiting = np.nansum(np.array([tracking["transport"], tracking["wait_for_lines"]]), axis=0)
    return tracking["total"] - waiting


def summarise(list_of_times):
    """Mean, median and count of each stage over all frames of several runs."""
    summary = {}
    for part in ("tracking", "mapping"):
        stages = list_of_times[0][part] if list_of_times else {}
        summary[part] = {}
        for stage in stages:
            values = np.concatenate([times[part][stage] for times in list_of_times])
            values = values[np.isfinite(values)]
            summary[part][stage] = None if len(values) == 0 else {
                "mean_ms": float(np.mean(values)), "median_ms": float(np.median(values)),
                "p95_ms": float(np.percentile(values, 95)), "count": len(values)}
    return summary
