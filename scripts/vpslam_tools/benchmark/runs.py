"""Runs `vpslam run` for every sequence, seed and pace, each in a folder of its own:

    <out>/runs/<sequence>/<pace>-seed<N>/     results, and bench.json once the run is complete

bench.json holds the key of the run: its options and a digest of the programs. A run whose key is
still the same is not repeated, so that an interrupted bench goes on where it stopped.
"""

import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
import time

from vpslam_tools import paths, processes, sources
from vpslam_tools.benchmark import scores
from vpslam_tools.errors import UserError

WRONG_COMMAND_LINE = 2


def plan(found, options):
    """[(Found, pace, seed)] in the order in which they run: every sequence once before any twice."""
    return [(each, pace, seed) for pace in options.paces for seed in range(1, options.seeds + 1)
            for each in found]


def folder_of(out, found, pace, seed):
    return out / "runs" / sources.short_name(found.sequence.folder) / f"{pace}-seed{seed}"


def programs_digest():
    digest = hashlib.sha256()
    for name in ("player", processes.DETECTOR, "frontend", "backend", "recorder"):
        path = paths.binaries() / name
        digest.update(path.read_bytes() if path.exists() else b"")
    return digest.hexdigest()[:16]


def command_of(found, pace, seed, results, options):
    camera = options.camera or found.camera
    return ([sys.executable, "-I", str(paths.TOOLS), "run", found.source, "--out", str(results),
             "--pace", pace, "--seed", str(seed)]
            + (["--camera", camera] if camera else [])
            + (["--frames", str(options.frames)] if options.frames else []) + options.run_options)


def run_all(found, options, out, tell):
    """[run], each {"sequence", "pace", "seed", "status": "done" or "failed", "scores", ...}."""
    jobs = plan(found, options)
    clock = Clock([_frames(each, options) for each, _, _ in jobs])
    digest = programs_digest()
    done = []
    for index, (each, pace, seed) in enumerate(jobs):
        results = folder_of(out, each, pace, seed)
        command = command_of(each, pace, seed, results, options)
        key = {"command": [word for word in command[4:] if word != str(results)],
               "programs": digest}
        title = f"[{index + 1}/{len(jobs)}] {each.sequence.name}, {pace}, seed {seed}"
        run = read_complete(results, key)
        if run:
            tell(f"{title}: done before")
            clock.skip(index)
        else:
            run = run_one(command, results, clock, index, title, tell)
            run.update(sequence=each.sequence.name, pace=pace, seed=seed, key=key,
                       results=str(results))
            write_json(results / "bench.json", run)
            tell(f"{title}: {describe(run)}; {clock.left(index + 1)}")
        done.append(run)
    return done


def _frames(found, options):
    frames = found.frames or 600
    return min(frames, options.frames) if options.frames else frames


def run_one(command, results, clock, index, title, tell):
    shutil.rmtree(results, ignore_errors=True)
    results.mkdir(parents=True)
    began = time.monotonic()
    last_lines = []
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                               errors="replace", stdin=subprocess.DEVNULL)
    try:
        for line in process.stdout:
            last_lines = (last_lines + [line.rstrip()])[-6:]
            frame = re.match(r"frame (\d+) ", line)
            if frame:
                tell(f"{title}: {line.rstrip()}; {clock.left(index, int(frame.group(1)))}")
        status = process.wait()
    except KeyboardInterrupt:
        process.wait()  # Ctrl-C has reached it as well; what it leaves is not a complete run
        raise
    if status == WRONG_COMMAND_LINE:
        raise UserError("`vpslam run` refuses the options:\n" + "\n".join(last_lines))
    run = {"status": "failed", "why": f"failed: {last_lines[-1] if last_lines else status}",
           "exit_code": status, "wall_s": time.monotonic() - began}
    if status == 0 and (results / "summary.json").exists():
        run.update(status="done", why=None, scores=scores.score(results),
                   summary=json.loads((results / "summary.json").read_text()))
    return run


def read_complete(results, key):
    try:
        run = json.loads((results / "bench.json").read_text())
    except (OSError, ValueError):
        return None
    same = isinstance(run, dict) and run.get("key") == key and run.get("status") == "done"
    return run if same and (results / "summary.json").exists() else None


def write_json(path, value):
    path.parent.mkdir(parents=True, exist_ok=True)
    new = path.with_name(path.name + ".new")
    new.write_text(json.dumps(value, indent=2) + "\n")
    os.replace(new, path)


def describe(run):
    if run["status"] != "done":
        return run["why"]
    figures = run["scores"]
    error = figures["why"] if figures["ate_m"] is None else f"ATE {figures['ate_m']:.4f} m"
    return f"{error}, coverage {figures['coverage']:.3f}, {run['wall_s']:.0f} s"


class Clock:
    """Time left, from the time that frames took so far."""

    def __init__(self, frames):
        self._frames = list(frames)
        self._skipped_frames = 0
        self._began = time.monotonic()

    def skip(self, index):
        self._skipped_frames += self._frames[index]

    def left(self, index, frame=0):
        """At `frame` of job `index`."""
        before = sum(self._frames[:index])
        worked = before - self._skipped_frames + frame
        to_do = sum(self._frames) - before - frame
        if to_do <= 0:
            return "nothing left"
        if worked <= 0:
            return f"{to_do} frames left"
        left_s = to_do * (time.monotonic() - self._began) / worked
        return f"about {left_s / 60:.0f} min left" if left_s >= 90 else f"about {left_s:.0f} s left"
