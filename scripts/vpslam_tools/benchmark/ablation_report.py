"""What the ablation leaves behind: a table of variants by sequence, and whether the default is ever
worse than points alone."""

import pathlib

import numpy as np

from vpslam_tools.benchmark import comparison, report, scores, tables, timing
from vpslam_tools.benchmark.runs import write_json

EXPLANATION = """\
ATE: RMSE after alignment by a similarity. Rotation: median over the frames of the angle left after
one constant rotation. Drift: median error of the relative rotation over half of the way, by
its length. Coverage: frames with a pose / frames. Where there are several seeds: median / worst.
Frontend: median over the frames of the time from image to pose, without transport and without
waiting for lines. CPU: mean per frame, of the frontend and of all processes. Both are those of
seed 1, which ran alone.
\\* poses for less than 90 % of the frames: the error is that of a part.
"""
PAIRED = """\
Paired by seed, over the frames that both tracked, each aligned on these: the seed that is nearest to
failing. Allowed is the most of 5 %, 0.002 m and the spread of points' ATE over the seeds; of
coverage 1 %.
"""
TIMES = ["frontend_ms", "frontend_cpu_ms", "all_cpu_ms"]


def write(variants, reference, judged, found, missing, runs, args, out):
    """Writes results.json and results.md; returns the text. variants: names in the order of the
    table; `judged` of them is compared with `reference`."""
    def of(each, variant):
        return [run for run in runs if run["sequence"] == each.sequence.name
                and run["variant"] == variant]
    figures = {(each.sequence.name, variant): dict(scores.combine(own), **times_alone(own))
               for each in found for variant in variants if (own := of(each, variant))}
    compared = {each.sequence.name: comparison.compare(of(each, reference), of(each, judged))
                for each in found}
    commits, command = report.commits_of(runs), report.command_line()
    parts = ["# Ablation\n", report.origin(command, commits, args.seeds)]
    if missing:
        parts.append("Missing: " + ", ".join(each.name for each in missing) + ".\n")
    parts += [table(figures), EXPLANATION, f"## {judged} against {reference}\n",
              paired(compared, reference, judged), PAIRED]
    text = "\n".join(parts)
    (out / "results.md").write_text(text)
    write_json(out / "results.json", {
        "suite": args.suite, "command": command, "commits": commits, "machine": report.machine(),
        "missing": [each.name for each in missing],
        "figures": [dict(own, sequence=name, variant=variant)
                    for (name, variant), own in figures.items()],
        "compared": compared, "runs": runs})
    return f"\n{text}\nresults  {out}"


def times_alone(runs):
    """Of the run that went alone, which is that of seed 1; None where it failed."""
    for run in runs:
        if run["seed"] == 1 and run["status"] == "done":
            work = timing.frontend_work_ms(
                timing.read_times(pathlib.Path(run["results"]))["tracking"])
            cpu = run["summary"].get("cpu_ms_per_frame", {})
            return {"frontend_ms": float(np.nanmedian(work)) if np.isfinite(work).any() else None,
                    "frontend_cpu_ms": cpu.get("frontend"), "all_cpu_ms": cpu.get("total")}
    return dict.fromkeys(TIMES)


def table(figures):
    """figures: {(sequence, variant): of scores.combine(), with TIMES}."""
    header = ["sequence", "variant", "ATE (m)", "rotation (deg)", "drift (deg/m)", "coverage",
              "frontend (ms)", "its CPU (ms)", "all CPU (ms)"]
    rows, notes, before = [], [], None
    for (name, variant), own in figures.items():
        ate = tables.median_and_worst(own["ate_m"], 4)
        if own["ate_m"] and own["coverage"]["worst"] < tables.LOW_COVERAGE:
            ate += " \\*"
        rows.append([name if name != before else "", variant, ate,
                     tables.median_and_worst(own["rotation_median_deg"], 2),
                     tables.median_and_worst(own["rotation_drift_deg_per_m"], 3),
                     tables.median_and_worst(dict(own["coverage"], runs=own["runs"]), 3),
                     *(tables.number(own[key], 1) for key in TIMES)])
        if own["why"]:
            notes.append(f"\n- {name}, {variant}: {own['why']}")
        before = name
    return tables.markdown(header, rows) + "".join(notes) + "\n" * bool(notes)


def paired(compared, reference, judged):
    """compared: {sequence: of comparison.compare()}."""
    header = ["sequence", "common frames", f"ATE of {reference} (m)", f"of {judged}", "higher by",
              "allowed", "coverage lower by", "never worse"]
    rows = []
    for name, own in compared.items():
        pairs = own["pairs"]

        def median(key):
            values = [pair[key] for pair in pairs if pair[key] is not None]
            return float(np.median(values)) if values else None
        frames = median("frames")
        rows.append([name, tables.number(frames, 0), tables.number(median("reference_ate_m")),
                     tables.number(median("ate_m")), tables.number(own["worse_by_m"]),
                     tables.number(own["allowed_m"]), tables.number(own["coverage_loss"], 3),
                     f"**no: {', '.join(own['worse'])}**" if own["worse"] else
                     "yes" if pairs else "-"])
    return tables.markdown(header, rows)
