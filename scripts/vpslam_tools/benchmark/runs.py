"""Runs of sequences, one process each (job_of(): `vpslam run`), each in a folder of its own:

    <out>/runs/<sequence>/<pace>-seed<N>/     results, and bench.json once the run is complete

bench.json holds the key of the run: its options, and digests of the programs and of the calibration
and settings that it reads. A run whose key is still the same is not repeated, so that an interrupted
bench goes on where it stopped.
"""

import concurrent.futures
import functools
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
import typing
from dataclasses import dataclass

from vpslam_tools import paths, processes, sources
from vpslam_tools.benchmark import scores
from vpslam_tools.benchmark.discovery import Found
from vpslam_tools.errors import UserError
from vpslam_tools.progress import QUIET_S

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
    key: dict           # what the results follow from; a run with the same is not repeated
    score: typing.Callable = scores.score  # (results folder) -> figures
    stop_signal: int = signal.SIGINT       # ends it early
    program: str = "`vpslam run`"          # what the command is, for messages


def plan(found, options):
    """[(Found, pace, seed)] in the order in which they run: every sequence once before any twice."""
    return [(each, pace, seed) for pace in options.paces for seed in range(1, options.seeds + 1)
            for each in found]


def folder_of(out, found, pace, seed):
    return out / "runs" / sources.short_name(found.sequence.folder) / f"{pace}-seed{seed}"


@functools.lru_cache(maxsize=None)
def programs_digest():
    # What a preset stands for is decided beside the programs.
    return files_digest([paths.TOOLS / "presets.py"] + [paths.binaries() / name for name in (
        "player", processes.DETECTOR, "frontend", "backend", "recorder")])


def inputs_digest(command):
    """Of the texts that a run reads: sequence and settings."""
    return files_digest(sequence_texts(command[command.index("run") + 1]) + [
        pathlib.Path(command[index + 1]) for index, word in enumerate(command)
        if word in ("--camera", "--config")])


@functools.lru_cache(maxsize=None)
def sequence_texts(source):
    """Listing, calibration, truth. Images are taken to stay what they are."""
    source = pathlib.Path(source)
    files = sorted(path for path in source.rglob("*") if path.suffix in TEXTS)
    files.append(source / "../../poses" / f"{source.name}.txt")  # KITTI's truth
    files.append(pathlib.Path(sources.published_camera(str(source)) or ""))
    return files


def files_digest(files):
    """Of their contents; one that is not there counts as empty."""
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
    command = command_of(found, pace, seed, results, options)
    key = {"command": [word for word in command[4:] if word != str(results)],
           "programs": programs_digest(), "inputs": inputs_digest(command)}
    return Job(found, pace, seed, results, command,
               min(frames, options.frames) if options.frames else frames, title,
               {"variant": variant} if variant else {}, key)


def run_jobs(jobs, tell, at_once=1, on_run=lambda job, run: None):
    """The runs, in the order of `jobs`; `at_once` at a time. What Ctrl-C interrupts is not kept.
    on_run() is called after each of them, one call at a time."""
    clock = Clock([job.frames for job in jobs])
    children = Children()
    one_call = threading.Lock()

    def do(index, job):
        title = f"[{index + 1}/{len(jobs)}] {job.title}"
        run = read_complete(job)
        if run:
            clock.skip(index)
            tell(f"{title}: done before")
        else:
            run = run_one(job, children, lambda frame, line: tell(
                f"{title}: {line}; {clock.at(index, frame)}"))
            run.update(job.about, sequence=job.found.sequence.name, pace=job.pace, seed=job.seed,
                       key=job.key, results=str(job.results))
            write_json(job.results / "bench.json", run)
            tell(f"{title}: {describe(run)}; {clock.at(index, job.frames)}")
        with one_call:
            on_run(job, run)
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
        self._running = {}  # process: the signal that ends it
        self.stopped = False

    def start(self, command, stop_signal):
        with self._lock:
            if self.stopped:
                raise Stopped
            process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                       text=True, errors="replace", stdin=subprocess.DEVNULL)
            self._running[process] = stop_signal
            return process

    def wait(self, process):
        status = process.wait()
        with self._lock:
            self._running.pop(process)
            if self.stopped:
                raise Stopped
        return status

    def stop(self):
        with self._lock:
            self.stopped = True
            for process, stop_signal in self._running.items():
                process.send_signal(stop_signal)


def run_one(job, children, on_frame):
    """on_frame(number, line of progress), now and then"""
    shutil.rmtree(job.results, ignore_errors=True)
    job.results.mkdir(parents=True)
    began = last_told = time.monotonic()
    last_lines = []
    process = start(job, children)
    for line in process.stdout:
        last_lines = (last_lines + [line.rstrip()])[-6:]
        frame = re.match(r"frame (\d+) ", line)
        if frame and time.monotonic() >= last_told + QUIET_S / 2:
            last_told = time.monotonic()
            on_frame(int(frame.group(1)), line.rstrip())
    status = children.wait(process)
    if status == WRONG_COMMAND_LINE:
        raise UserError(f"{job.program} refuses the options:\n" + "\n".join(last_lines))
    run = {"status": "failed", "why": f"failed: {last_lines[-1] if last_lines else status}",
           "exit_code": status, "wall_s": time.monotonic() - began}
    if status == 0 and (job.results / "summary.json").exists():
        run["summary"] = json.loads((job.results / "summary.json").read_text())
        if run["summary"].get("interrupted"):
            run["why"] = "failed: it was interrupted"
        else:
            run.update(status="done", why=None, scores=job.score(job.results))
    return run


def start(job, children):
    try:
        return children.start(job.command, job.stop_signal)
    except OSError as error:
        raise UserError(f"{job.command[0]}: cannot be started ({error.strerror}); build it with "
                        "`scripts/vpslam build`") from None


def read_complete(job):
    try:
        run = json.loads((job.results / "bench.json").read_text())
    except (OSError, ValueError):
        return None
    if not isinstance(run, dict) or run.get("key") != job.key or run.get("status") != "done":
        return None
    try:
        return dict(run, scores=job.score(job.results))  # the way of scoring may have changed
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
