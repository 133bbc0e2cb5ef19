"""Whether one version is better than another, by pairs of runs with the same first frame and seed.

The sign test asks how likely it is that as many pairs or more point to one side if each pointed to
either with probability 1/2. Pairs that are equal are left out. It supposes nothing about how the
errors are distributed.
[W. J. Dixon, A. M. Mood, "The statistical sign test", J. Am. Stat. Assoc. 41, 1946]
"""

import math

import numpy as np

from vpslam_tools.benchmark import spread, tables

ALL = "all"
COLUMNS = ["metric", "sequence", "pairs", "baseline", "judged", "ratio", "better", "worse", "equal",
           "p"]


def sign_test(better, worse):
    """Two-sided p-value of so many pairs of either kind."""
    count = better + worse
    tail = sum(math.comb(count, k) for k in range(min(better, worse) + 1))
    return min(1.0, 2 * tail / 2 ** count)


def pair(baseline, judged):
    """([(row, row)] of the same sequence, first frame and seed, {sequence: how many cannot be
    compared because they were about other frames or another calibration or truth})."""
    partners = {(row["sequence"], row["start"], row["seed"]): row for row in baseline}
    pairs, unlike = [], {}
    for row in judged:
        other = partners.get((row["sequence"], row["start"], row["seed"]))
        if other is None:
            continue
        if all(row[key] == other[key] for key in ("inputs", "frames")):
            pairs.append((other, row))
        else:
            unlike[row["sequence"]] = unlike.get(row["sequence"], 0) + 1
    return pairs, unlike


def compare(pairs):
    """A row per metric and sequence, and one over all sequences; see COLUMNS. baseline, judged: the
    medians; ratio: judged / baseline, over all the geometric mean of those of the sequences."""
    names = list(dict.fromkeys(judged["sequence"] for _, judged in pairs))
    lines = []
    for metric in spread.METRICS:
        ratios = []
        for name in names:
            own = [each for each in pairs if each[1]["sequence"] == name]
            baseline, judged = (spread.scatter(metric, side)[0] for side in zip(*own))
            ratio = _ratio(judged, baseline)
            ratios.append(ratio)
            lines.append({"metric": metric.column, "sequence": name, "baseline": baseline,
                          "judged": judged, "ratio": ratio, **_signs(metric, own)})
        finite = [ratio for ratio in ratios if ratio]
        lines.append({"metric": metric.column, "sequence": ALL, "baseline": None, "judged": None,
                      "ratio": float(np.exp(np.mean(np.log(finite)))) if finite else None,
                      **_signs(metric, pairs)})
    return lines


def _ratio(judged, baseline):
    return judged / baseline if baseline and math.isfinite(judged + baseline) else None


def _signs(metric, pairs):
    differences = []
    for baseline, judged in pairs:
        values = metric.value(judged), metric.value(baseline)
        differences.append(0.0 if values[0] == values[1] else  # both may be infinite
                           metric.sign * (values[0] - values[1]))
    better, worse = sum(each < 0 for each in differences), sum(each > 0 for each in differences)
    return {"pairs": len(pairs), "better": better, "worse": worse,
            "equal": len(pairs) - better - worse, "p": sign_test(better, worse)}


def text(lines):
    """lines: of compare(). A table per metric."""
    parts = []
    for metric in spread.METRICS:
        header = [metric.title, "pairs", "baseline", "judged", "ratio", "better", "worse", "equal",
                  "p"]
        rows = [[line["sequence"], str(line["pairs"]),
                 *("-" if line[side] is None else metric.text(line[side])
                   for side in ("baseline", "judged")), tables.number(line["ratio"], 3),
                 *(str(line[key]) for key in ("better", "worse", "equal")), f"{line['p']:.3f}"]
                for line in lines if line["metric"] == metric.column]
        parts.append(tables.markdown(header, rows))
    return "\n".join(parts)
