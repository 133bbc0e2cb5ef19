"""Runs `vpslam run` for every sequence, seed and pace, each in a folder of its own:

    <out>/runs/<sequence>/<pace>-seed<N>/     results, and bench.json once the run is complete

bench.json holds the key of the run: its options, and digests of the programs and of the calibration
and settings that it reads. A run whose key is still the same is not repeated, so that an interrupted
bench goes on where it stopped.
"""

import concurrent.futures
import hashlib
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import threading
import time
from dataclasses import dataclass

from vpslam_tools import paths, processes, sources
from vpslam_tools.benchmark import scores
from vpslam_tools.benchmark.discovery import Found
from vpslam_tools.errors import UserError

WRONG_COMMAND_LINE = 2
TEXTS = {".txt", ".csv", ".yaml", ".freiburg"}


@dataclass(frozen=True)
class Job:
    """One run that is to be done."""
    found: Found
    pace: str
    seed: int
    results: pathlib.Path
    command: list
    frames: int         # how many it takes, or a guess
    title: str          # for the progress
    about: dict         # kept with the run, beside sequence, pace and seed


def plan(found, options):
    """[(Found, pace, seed)] in the order in which they run: every sequence once before any twice."""
    return [(each, pace, seed) for pace in options.paces for seed in range(1, options.seeds + 1)
            for each in found]


def folder_of(out, found, pace, seed):
    return out / "runs" / sources.short_name(found.sequence.folder) / f"{pace}-seed{seed}"


def programs_digest():
    # What a preset stands for is decided beside the programs.
    digest = hashlib.sha256((paths.TOOLS / "presets.py").read_bytes())
    for name in ("player", processes.DETECTOR, "frontend", "backend", "recorder"):
        path = paths.binaries() / name
        digest.update(path.read_bytes() if path.exists() else b"")
    return digest.hexdigest()[:16]


def inputs_digest(command):
    """Of the texts that a run reads: listing, calibration, truth, settings. Images are taken to stay
    what they are."""
    source = pathlib.Path(command[command.index("run") + 1])
    files = sorted(path for path in source.rglob("*") if path.suffix in TEXTS)
    files.append(source / "../../poses" / f"{source.name}.txt")  # KITTI's truth
    files.append(pathlib.Path(sources.published_camera(str(source)) or ""))
    files += [pathlib.Path(command[index + 1]) for index, word in enumerate(command)
              if word in ("--camera", "--config")]
    digest = hashlib.sha256()
    for path in files:
        digest.update(path.read_bytes() if path.is_file() else b"")
    return digest.hexdigest()[:16]


def has_pictures(seed):
    return seed == 1


def command_of(found, pace, seed, results, options):
    return ([sys.executable, "-I", str(paths.TOOLS), "run", found.source, "--out", str(results),
             "--pace", pace, "--seed", str(seed)]
            + (["--camera", options.camera] if options.camera else [])
            + (["--frames", str(options.frames)] if options.frames else [])
            + ["--preview"] * (options.pictures and has_pictures(seed)) + options.run_options)


def run_all(found, options, out, tell):
    """[run], each {"sequence", "pace", "seed", "status": "done" or "failed", "scores", ...}."""
    return run_jobs([job_of(each, pace, seed, options, folder_of(out, each, pace, seed))
                     for each, pace, seed in plan(found, options)], tell)


def job_of(found, pace, seed, options, results, variant=None):
    """`variant`: name of what `options` stand for, where there are several."""
    frames = found.frames or 600
    title = ", ".join([found.sequence.name, variant or pace, f"seed {seed}"])
    return Job(found, pace, seed, results, command_of(found, pace, seed, results, options),
               min(frames, options.frames) if options.frames else frames, title,
               {"variant": variant} if variant else {})


def run_jobs(jobs, tell, at_once=1):
    """The runs, in the order of `jobs`; `at_once` at a time. What Ctrl-C interrupts is not kept."""
    clock = Clock([job.frames for job in jobs])
    digest = programs_digest()
    children = Children()

    def do(index, job):
        key = {"command": [word for word in job.command[4:] if word != str(job.results)],
               "programs": digest, "inputs": inputs_digest(job.command)}
        title = f"[{index + 1}/{len(jobs)}] {job.title}"
        run = read_complete(job.results, key)
        if run:
            clock.skip(index)
            tell(f"{title}: done before")
            return run
        run = run_one(job, children, lambda frame, line: tell(
            f"{title}: {line}; {clock.at(index, frame)}"))
        run.update(job.about, sequence=job.found.sequence.name, pace=job.pace, seed=job.seed,
                   key=key, results=str(job.results))
        write_json(job.results / "bench.json", run)
        tell(f"{title}: {describe(run)}; {clock.at(index, job.frames)}")
        return run

    with concurrent.futures.ThreadPoolExecutor(at_once) as executor:
        futures = [executor.submit(do, index, job) for index, job in enumerate(jobs)]
        try:
            concurrent.futures.wait(futures, return_when=concurrent.futures.FIRST_EXCEPTION)
            return [future.result() for future in futures if not future.cancelled()]
        except BaseException:
            children.stop()
            raise
        finally:
            for future in futures:
                future.cancel()


class Stopped(Exception):
    """A run was ended before its time: nothing is known about it."""


class Children:
    """The runs in progress, which end together when one has to."""

    def __init__(self):
        self._lock = threading.Lock()
        self._running = set()
        self.stopped = False

    def start(self, command):
        with self._lock:
            if self.stopped:
                raise Stopped
            process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                       text=True, errors="replace", stdin=subprocess.DEVNULL)
            self._running.add(process)
            return process

    def wait(self, process):
        status = process.wait()
        with self._lock:
            self._running.discard(process)
            if self.stopped:
                raise Stopped
        return status

    def stop(self):
        with self._lock:
            self.stopped = True
            for process in self._running:
                process.send_signal(signal.SIGINT)


def run_one(job, children, on_frame):
    """on_frame(number, line of progress)"""
    shutil.rmtree(job.results, ignore_errors=True)
    job.results.mkdir(parents=True)
    began = time.monotonic()
    last_lines = []
    process = children.start(job.command)
    for line in process.stdout:
        last_lines = (last_lines + [line.rstrip()])[-6:]
        frame = re.match(r"frame (\d+) ", line)
        if frame:
            on_frame(int(frame.group(1)), line.rstrip())
    status = children.wait(process)
    if status == WRONG_COMMAND_LINE:
        raise UserError("`vpslam run` refuses the options:\n" + "\n".join(last_lines))
    run = {"status": "failed", "why": f"failed: {last_lines[-1] if last_lines else status}",
           "exit_code": status, "wall_s": time.monotonic() - began}
    if status == 0 and (job.results / "summary.json").exists():
        run["summary"] = json.loads((job.results / "summary.json").read_text())
        if run["summary"].get("interrupted"):
            run["why"] = "failed: it was interrupted"
        else:
            run.update(status="done", why=None, scores=scores.score(job.results))
    return run


def read_complete(results, key):
    try:
        run = json.loads((results / "bench.json").read_text())
    except (OSError, ValueError):
        return None
    if not isinstance(run, dict) or run.get("key") != key or run.get("status") != "done":
        return None
    try:
        return dict(run, scores=scores.score(results))  # the way of scoring may have changed
    except OSError:
        return None


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
        self._worked = {}
        self._began = time.monotonic()

    def skip(self, index):
        self._frames[index] = 0

    def at(self, index, frame):
        """Job `index` has come to `frame`. Says what is left of all jobs."""
        self._worked[index] = min(frame, self._frames[index])
        worked = sum(self._worked.values())
        to_do = sum(self._frames) - worked
        if to_do <= 0:
            return "nothing left"
        if worked <= 0:
            return f"{to_do} frames left"
        left_s = to_do * (time.monotonic() - self._began) / worked
        return f"about {left_s / 60:.0f} min left" if left_s >= 90 else f"about {left_s:.0f} s left"
