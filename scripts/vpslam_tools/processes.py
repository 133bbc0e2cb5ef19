"""The process graph of a run, and the command line of each of its processes.

    player --> frontend <--> backend
        \\     ^     \\        /
      vpdetector     recorder
"""

import ctypes
import json
import os
import pathlib
import signal

from vpslam_tools import paths, presets, sources

DETECTOR = "vpdetector"
PR_SET_PDEATHSIG = 1
STOP_SIGNALS = [signal.SIGINT, signal.SIGTERM, signal.SIGHUP]
# What summary.json says of how a run was started.
TOLD_OPTIONS = ["sequence", *sources.OPTIONS, "config", "set", "pace",
                *presets.options(), "detectors", "start", "frames", "record"]


def die_with_parent(waits_for_signals=False):
    """For Popen's preexec_fn: the process is killed when the one that started it ends, however.
    `waits_for_signals`: it takes SIGINT, SIGTERM and SIGHUP up by itself (core/transport/process.cpp),
    so that one which comes before it is that far is to wait, not to kill it."""
    parent = os.getpid()
    libc = ctypes.CDLL(None)

    def prepare():
        if waits_for_signals:
            signal.pthread_sigmask(signal.SIG_BLOCK, STOP_SIGNALS)
        libc.prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
        if os.getppid() != parent:
            os._exit(1)  # it died before the line above
    return prepare


def detectors(options):
    """Names of the detectors, which do the same work and share it: a run can lose all but one."""
    return [f"{DETECTOR}{number + 1}" for number in range(options.detectors)]


def graph(options):
    """Names from the source downstream; the player ends first, the recorder last."""
    return ["player", *detectors(options), "frontend", "backend", "recorder"]


def command_lines(options, url, session, out):
    """{name: command} for the options of `vpslam run`. What was not given is not passed: the
    defaults are the binaries' own. `session` is the player's, after which it names the shared
    memory."""
    def given(*names):
        return [word for name in names if getattr(options, name) is not None
                for word in ("--" + name.replace("_", "-"), str(getattr(options, name)))]

    # Each stream waits for those of its consumers that are named here.
    required = ["frontend", "backend", "recorder"] + [DETECTOR] * (options.detectors > 0)
    common = ["--url", url, "--require", ",".join(required)] + given("pace", "record")
    settings = [word for setting in presets.settings(options) + options.set
                for word in ("--set", setting)]
    told = {name: getattr(options, name) for name in TOLD_OPTIONS
            if getattr(options, name) not in (None, [])}
    if options.config:  # the file may be another one by the time that a log is replayed
        told["settings"] = pathlib.Path(options.config).read_text(errors="replace")
    from_features = getattr(options, "from_features", False)
    arguments = {
        "player": [options.sequence, "--session", session, "--truth", str(out / "truth.txt")]
        + given(*sources.OPTIONS, "start", "frames") + ["--inline"] * options.inline
        + ["--features"] * from_features,
        "frontend": given("config", "seed") + settings + ["--preview"] * options.preview
        + ["--take-features"] * from_features,
        "backend": given("config") + settings,
        "recorder": ["--out", str(out), "--progress", "--options", json.dumps(told)]
        + given("seed"),
        DETECTOR: given("config") + settings,
    }

    def command(name):
        program = DETECTOR if name in detectors(options) else name
        return [str(paths.binaries() / program)] + arguments[program] + common

    return {name: command(name) for name in graph(options)}
