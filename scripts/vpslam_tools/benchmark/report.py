"""What a suite leaves behind: results.json, results.md, and pictures."""

import os
import pathlib
import platform
import shlex
import shutil
import subprocess
import sys

from vpslam_tools import paths
from vpslam_tools.benchmark import scores, tables, timing
from vpslam_tools.benchmark.runs import has_pictures, write_json
from vpslam_tools.errors import UserError

EXPLANATION = """\
ATE: RMSE after alignment by a similarity. Rotation: RMSE of the angle left after one constant
rotation. Coverage: frames with a pose / frames. Where there are several runs: median / worst.
\\* poses for less than 90 % of the frames: the error is that of a part.
Other systems' figures come from real time and, where they say so, with loops closed. Lockstep waits
for mapping after each keyframe, so it flatters. Bold: the least of the paper's table and ours, in
real time where that was run.
"""


def write(suite, found, missing, runs, args, out):
    """Writes all files; returns the text of the tables."""
    paces = args.pace.split(",")
    entries = [(each, {pace: scores.combine(own) for pace in paces
                       if (own := _of(runs, each, pace))}) for each in found]
    times = {(each.sequence.name, pace): [timing.read_times(pathlib.Path(run["results"]))
                                          for run in _of(runs, each, pace)
                                          if run["status"] == "done"]
             for each in found for pace in paces}
    per_sequence = [(name, pace, timing.summarise(own)) for (name, pace), own in times.items() if own]
    per_pace = {pace: timing.summarise([each for (_, other), own in times.items() if other == pace
                                        for each in own]) for pace in paces}
    summaries = [(each.sequence.name, pace, own) for each in found for pace in paces
                 if (own := [run["summary"] for run in _of(runs, each, pace)
                             if run["status"] == "done"])]
    commits, command = commits_of(runs), command_line()
    text = _text(suite, command, commits, entries, paces, missing, per_pace, per_sequence,
                 summaries, runs, args)
    (out / "results.md").write_text(text)
    write_json(out / "results.json", {
        "suite": suite, "command": command, "commits": commits, "machine": machine(),
        "missing": [each.name for each in missing],
        "sequences": [{"name": each.sequence.name, "source": each.source,
                       "paper": each.sequence.paper, "elsewhere": each.sequence.elsewhere,
                       "by_pace": by_pace} for each, by_pace in entries],
        "times": {"by_pace": per_pace,
                  "by_sequence": [dict(sequence=name, pace=pace, **summary)
                                  for name, pace, summary in per_sequence]},
        "runs": runs})
    if not args.no_pictures:
        _draw(runs, entries, out)
    return f"\n{text}\nresults  {out}"


def _of(runs, found, pace):
    return [run for run in runs if run["sequence"] == found.sequence.name and run["pace"] == pace]


def command_line():
    return shlex.join(["scripts/vpslam", "bench", *sys.argv[2:]])


def commits_of(runs):
    return [revision()] if revision() else sorted(
        {run["summary"]["commit"] for run in runs if "summary" in run})


def origin(command, commits, seeds=None):
    """The sentence that says where a table's figures come from. seeds: how many, where there are."""
    here = machine()
    of_seeds = f"{seeds} seed{'s' * (seeds > 1)}, " if seeds else ""
    return (f"`{command}`, commit {', '.join(commits) or 'unknown'}, "
            f"{of_seeds}{here['cores']} cores of {here['cpu']}, load "
            f"{here['load']} in the end.\n")


def revision():
    """Commit of the source tree, "+" if files differ from it; None where programs from elsewhere are
    run. Those carry the last commit that touched the sources."""
    def git(*words):
        return subprocess.run(["git", "-C", str(paths.ROOT), *words], stdout=subprocess.PIPE,
                              stderr=subprocess.DEVNULL, text=True).stdout.strip()
    if not paths.has_to_build() or not shutil.which("git"):
        return None
    commit = git("rev-parse", "--short=12", "HEAD")
    return commit and commit + "+" * bool(git("status", "--porcelain", "--untracked-files=no"))


def machine():
    model = ""
    cpuinfo = pathlib.Path("/proc/cpuinfo")
    if cpuinfo.exists():
        model = next((line.split(":")[1].strip() for line in cpuinfo.read_text().splitlines()
                      if line.startswith("model name")), "")
    return {"cpu": model or platform.machine(), "cores": os.cpu_count(),
            "load": round(os.getloadavg()[0], 1)}


def _text(suite, command, commits, entries, paces, missing, per_pace, per_sequence, summaries,
          runs, args):
    minutes = sum(run["wall_s"] for run in runs) / 60
    parts = [f"# Suite {suite}\n", origin(command, commits, args.seeds),
             f"The runs took {minutes:.1f} minutes.\n"]
    if missing:
        parts.append("Missing: " + ", ".join(each.name for each in missing) + ".\n")
    if not args.no_pictures:
        parts.append("Runs of seed 1 have previews, for their pictures.\n")
    parts += ["## Accuracy (the paper's table I)\n", tables.accuracy(entries, paces), EXPLANATION]
    for pace, summary in per_pace.items():
        if summary["tracking"]:
            parts += [f"## Time, {pace} (the paper's table II)\n", tables.times(summary)]
    parts += ["## Time by sequence: critical path and overlap\n",
              tables.times_by_sequence(per_sequence),
              "Critical path: image published to pose published. Beside it, in other processes: "
              "decoding (of simulated places: rendering), lines and VPs, mapping. Overlap: their "
              "share in all work. Waiting for a busy processor counts as time of the stage.\n",
              "## Frames dropped, latency and CPU time\n", tables.budget(summaries),
              "Medians over the seeds; of dropped frames the most. Latency is that of the critical "
              "path. Two cores at 30 Hz have 66 ms of CPU time per frame.\n"]
    return "\n".join(parts)


def _draw(runs, entries, out):
    from vpslam_tools.benchmark import pictures
    names = [found.sequence.name for found, _ in entries]
    for run in runs:
        if run["status"] == "done" and has_pictures(run["seed"]) and run["sequence"] in names:
            try:
                pictures.draw(pathlib.Path(run["results"]), f"{run['sequence']}, {run['pace']}",
                              out / "pictures" / pathlib.Path(run["results"]).parent.name
                              / run["pace"])
            except UserError as error:
                print(f"no picture of {run['sequence']}: {error}", flush=True)
