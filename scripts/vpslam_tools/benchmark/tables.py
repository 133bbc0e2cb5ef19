"""Markdown in the form of the paper's tables I and II."""

import statistics

from vpslam_tools.benchmark import timing
from vpslam_tools.benchmark.catalogue import PAPER_TIMES_MS

LOW_COVERAGE = 0.9
PAPER_SYSTEMS = ["paper", "ORB-SLAM2", "PL-SLAM"]

# Our stage, its name in table II, and the row of PAPER_TIMES_MS.
TRACKING_ROWS = [
    ("transport", "Image transport", None), ("features", "Feature extraction", "features"),
    ("wait_for_lines", "Waiting for lines and VPs", None),
    ("initial_pose", "Initial pose estimation", "initial_pose"),
    ("rotation", "Rotation from VPs", None), ("translation", "Translation refinement", None),
    ("local_map", "Track local map", "local_map"), ("rest", "Rest", None),
    ("total", "**Total**, image published to pose published", "total")]
BESIDE_ROWS = [
    ("decode", "Decoding (player)", None), ("lines", "Lines (vpdetector)", None),
    ("vps", "VP extraction (vpdetector)", "vps")]
MAPPING_ROWS = [
    ("insertion", "Keyframe insertion", "insertion"),
    ("feature_culling", "Map feature culling", "feature_culling"),
    ("feature_creation", "Map feature creation", "feature_creation"),
    ("keyframe_culling", "Keyframe culling", "keyframe_culling"),
    ("local_ba", "Local BA", "local_ba"), ("total", "**Total**", "mapping_total")]


def markdown(header, rows):
    lines = [header, ["---"] * len(header)] + rows
    return "\n".join("| " + " | ".join(line) + " |" for line in lines) + "\n"


def number(value, digits=4):
    return "-" if value is None else f"{value:.{digits}f}"


def median_and_worst(figures, digits):
    if figures is None:
        return "-"
    if figures.get("runs", 2) == 1:
        return number(figures["median"], digits)
    return f"{number(figures['median'], digits)} / {number(figures['worst'], digits)}"


def accuracy(entries, paces):
    """entries: [(Found, {pace: scores.combine()})]. Columns of the paper only where it has figures; bold
    is the least of these and ours, in real time where that was run."""
    with_paper = any(found.sequence.paper for found, _ in entries)
    header = ["sequence", "frames"]
    for pace in paces:
        header += [f"{pace}: ATE (m)", "coverage", "rotation (deg)"]
    header += (PAPER_SYSTEMS + ["best elsewhere"]) * with_paper
    rows, notes = [], []
    for found, by_pace in entries:
        frames = max((figures["frames"] for figures in by_pace.values()), default=0)
        row = [found.sequence.name, str(frames or "-")]
        for pace in paces:
            figures = by_pace.get(pace)
            row += _accuracy_cells(figures)
            if figures and figures["why"]:
                notes.append(f"{found.sequence.name}: {figures['why']}")
        if with_paper:
            paper = found.sequence.paper or (None,) * 3
            row += [number(value, 3) for value in paper] + [found.sequence.elsewhere or "-"]
            ours = paces.index("realtime") if "realtime" in paces else 0
            _mark_least(row, [2 + 3 * ours, *range(len(row) - 1 - len(paper), len(row) - 1)])
        if found.sequence.note:
            notes.append(f"{found.sequence.name}: {found.sequence.note}")
        rows.append(row)
    return markdown(header, rows) + "".join(f"\n- {note}" for note in notes) + "\n" * bool(notes)


def _mark_least(row, columns):
    """Bold, as in the paper; an error of a part of the sequence does not compete."""
    values = {column: float(row[column].split()[0]) for column in columns
              if row[column] != "-" and "*" not in row[column]}
    for column, value in values.items():
        if value == min(values.values()):
            row[column] = f"**{row[column]}**"


def _accuracy_cells(figures):
    if figures is None:
        return ["-"] * 3
    error = median_and_worst(figures["ate_m"], 4)
    if figures["ate_m"] and figures["coverage"]["worst"] < LOW_COVERAGE:
        error += " \\*"
    coverage = dict(figures["coverage"], runs=figures["runs"])
    return [error, median_and_worst(coverage, 3), median_and_worst(figures["rotation_deg"], 2)]


def budget(runs):
    """[(sequence, pace, [summary.json])]: frames dropped, latency, and CPU time per frame of each
    process; medians over the runs, of frames dropped the most."""
    def median(summaries, *keys):
        values = [value for each in summaries if (value := _at(each, *keys)) is not None]
        return statistics.median(values) if values else None
    processes = sorted({name for _, _, summaries in runs for each in summaries
                        for name in each.get("cpu_ms_per_frame", {})} - {"total"})
    header = (["sequence", "pace", "dropped", "of them after the start", "latency, median (ms)",
               "95 %", "CPU per frame (ms)"] + processes)
    rows = []
    for name, pace, summaries in runs:
        dropped = max(each["frames"]["dropped"] for each in summaries)
        late = max(each["frames"]["dropped"] - each["frames"].get("dropped_before_init", 0)
                   for each in summaries)
        rows.append([name, pace, str(dropped), str(late)]
                    + [number(median(summaries, "latency_ms", key), 1) for key in ("median", "p95")]
                    + [number(median(summaries, "cpu_ms_per_frame", key), 1)
                       for key in ["total"] + processes])
    return markdown(header, rows)


def _at(value, *keys):
    for key in keys:
        value = value.get(key) if value is not None else None
    return value


def times(summary):
    """summary: timing.summarise()."""
    header = ["where", "operation", "mean (ms)", "median (ms)", "95 % (ms)"] + [
        f"{name}, mean" for name in PAPER_SYSTEMS]
    rows = []
    for title, part, listed in (("tracking, one after the other", "tracking", TRACKING_ROWS),
                                ("beside it, other processes", "tracking", BESIDE_ROWS),
                                ("local mapping, beside it", "mapping", MAPPING_ROWS)):
        first = True
        for stage, name, paper_row in listed:
            figures = summary[part].get(stage)
            paper = PAPER_TIMES_MS.get(paper_row, (None,) * 3)
            if figures is None and paper[0] is None:
                continue  # neither they nor we have it
            cells = [number(figures and figures[key], 2)
                     for key in ("mean_ms", "median_ms", "p95_ms")]
            rows.append([title if first else "", name] + cells
                        + [number(value, 2) for value in paper])
            first = False
    return markdown(header, rows)


def times_by_sequence(summaries):
    """[(sequence, pace, summary)]: frames' critical path and what runs beside it."""
    header = ["sequence", "pace", "critical path, mean (ms)", "median", "95 %",
              "mapping of a keyframe, mean (ms)", "keyframes (%)", "beside it, ms per frame",
              "overlap (%)"]
    rows = []
    for name, pace, summary in summaries:
        total, mapping = summary["tracking"]["total"], summary["mapping"]["total"]
        beside, share = overlap(summary)
        rows.append([name, pace] + [number(total and total[key], 1)
                                    for key in ("mean_ms", "median_ms", "p95_ms")]
                    + [number(mapping and mapping["mean_ms"], 1),
                       number(100 * mapping["count"] / total["count"] if mapping else 0, 1),
                       number(beside, 1),
                       number(share, 0)])
    return markdown(header, rows)


def overlap(summary):
    """(ms per frame of work beside the critical path, its share in all work in %)."""
    tracking, mapping = summary["tracking"], summary["mapping"]["total"]
    if not tracking["total"]:
        return None, None
    frames = tracking["total"]["count"]
    beside = sum(tracking[stage]["mean_ms"] * tracking[stage]["count"]
                 for stage in timing.BESIDE if tracking[stage])
    beside = (beside + (mapping["mean_ms"] * mapping["count"] if mapping else 0)) / frames
    return beside, 100 * beside / (beside + tracking["total"]["mean_ms"])
