"""How far the runs of one sequence scatter that differ by first frame and seed alone.

A run is a row here, {column: value}, and runs.csv holds rows; see COLUMNS. What could not be
measured, because nothing was tracked or the run failed, is None in a row and counts as worse than
whatever was measured.
"""

import csv
import io
import math
import os
from dataclasses import dataclass

import numpy as np

from vpslam_tools.benchmark import tables
from vpslam_tools.errors import UserError

STARTS = 5            # first frames 0 to 4
SEEDS_A_ROUND = 2     # all starts with both seeds are ten runs; then come the next two seeds
SHARE = 0.9           # of the runs, for the figure between median and worst

TEXTS = ["sequence", "status", "inputs", "programs", "settings", "why"]
COUNTS = ["start", "seed", "frames", "poses"]
FIGURES = ["coverage", "ate_m", "rotation_deg", "rotation_median_deg", "wall_s"]
COLUMNS = ["sequence", "start", "seed", "status", "frames", "poses", *FIGURES, "inputs", "programs",
           "settings", "why"]


@dataclass(frozen=True)
class Metric:
    column: str
    title: str
    digits: int
    sign: int      # +1: less is better, -1: more is better
    missing: float  # what None stands for

    def value(self, row):
        return self.missing if row[self.column] is None else row[self.column]

    def text(self, value):
        return f"{value:.{self.digits}f}" if math.isfinite(value) else "none"


METRICS = [Metric("ate_m", "ATE (m)", 4, +1, math.inf),
           Metric("rotation_deg", "rotation (deg)", 3, +1, math.inf),
           Metric("coverage", "coverage", 4, -1, 0.0)]


def start_and_seed(number):
    """Of run `number` of a sequence, from 0: each five runs have every start once, and both seeds."""
    return number % STARTS, (1 + number // (STARTS * SEEDS_A_ROUND) * SEEDS_A_ROUND
                             + number % SEEDS_A_ROUND)


def row_of(run, **about):
    """run: of runs.run_jobs(). about: columns that it does not have."""
    figures = run["scores"] if run["status"] == "done" else {"coverage": 0.0, "poses": 0}
    return {**dict.fromkeys(COLUMNS), **{key: figures.get(key) for key in COLUMNS if key in figures},
            "sequence": run["sequence"], "seed": run["seed"], "status": run["status"],
            "wall_s": run["wall_s"], "why": run.get("why") or figures.get("why"), **about}


def write_csv(path, columns, rows):
    """As a whole or not at all: others may read it meanwhile."""
    text = io.StringIO()
    writer = csv.DictWriter(text, columns, lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    new = path.with_name(path.name + ".new")
    new.write_text(text.getvalue(), encoding="utf-8")
    os.replace(new, path)


def read_rows(path):
    """Rows of a runs.csv."""
    def convert(column, text):
        if column in TEXTS:
            return text
        return None if text == "" else int(text) if column in COUNTS else float(text)

    try:
        with open(path, encoding="utf-8", newline="") as file:
            reader = csv.DictReader(file)
            rows = []
            for row in reader:
                try:
                    rows.append({column: convert(column, row[column]) for column in COLUMNS})
                except (KeyError, TypeError, ValueError):
                    raise UserError(f"{path}:{reader.line_num}: is no row of runs.csv of --suite "
                                    "spread; run the suite into this folder again") from None
            return rows
    except OSError as error:
        raise UserError(f"{path}: cannot be read ({error.strerror})") from None


def scatter(metric, rows):
    """(median, what SHARE of the runs is not worse than, worst)"""
    badness = np.array([metric.sign * metric.value(row) for row in rows], float)
    return tuple(float(metric.sign * value) for value in (
        np.median(badness), np.percentile(badness, 100 * SHARE, method="inverted_cdf"),
        badness.max()))


def by_sequence(rows):
    """{sequence: its rows}, in the order in which they come."""
    names = dict.fromkeys(row["sequence"] for row in rows)
    return {name: [row for row in rows if row["sequence"] == name] for name in names}


def summarise(rows):
    """A row per sequence, for summary.csv."""
    summary = []
    for name, own in by_sequence(rows).items():
        line = {"sequence": name, "runs": len(own),
                "failed": sum(row["status"] != "done" for row in own)}
        for metric in METRICS:
            for what, value in zip(("median", "90", "worst"), scatter(metric, own)):
                line[f"{metric.column}_{what}"] = value
        summary.append(line)
    return summary


def table(summary, runs_asked):
    """summary: of summarise()."""
    header = ["sequence", "runs"]
    for metric in METRICS:
        header += [f"{metric.title}: median", "90 %", "worst"]
    rows = []
    for line in summary:
        runs = str(line["runs"]) + f" of {runs_asked}" * (line["runs"] < runs_asked)
        rows.append([line["sequence"], runs + f", {line['failed']} failed" * (line["failed"] > 0)]
                    + [metric.text(line[f"{metric.column}_{what}"]) for metric in METRICS
                       for what in ("median", "90", "worst")])
    return tables.markdown(header, rows)
