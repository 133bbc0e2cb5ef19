"""The process graph of a run, and the command line of each of its processes.

    player -> frontend <-> backend
                  \\         /
                   recorder
"""

import json

from vpslam_tools import paths, sources

# From the source downstream; the player ends first, the recorder last.
GRAPH = ["player", "frontend", "backend", "recorder"]
# What summary.json says of how a run was started.
TOLD_OPTIONS = ["sequence", *sources.OPTIONS, "config", "set", "pace", "preset", "start", "frames"]


def command_lines(options, url, session, out):
    """{name: command} for the options of `vpslam run`. What was not given is not passed: the
    defaults are the binaries' own. `session` is the player's, after which it names the shared
    memory."""
    def given(*names):
        return [word for name in names if getattr(options, name) is not None
                for word in (f"--{name}", str(getattr(options, name)))]

    # Each stream waits for those of its consumers that are named here.
    common = ["--url", url, "--require", ",".join(GRAPH[1:])] + given("pace")
    settings = [word for setting in options.set for word in ("--set", setting)]
    told = {name: getattr(options, name) for name in TOLD_OPTIONS
            if getattr(options, name) not in (None, [])}
    arguments = {
        "player": [options.sequence, "--session", session, "--truth", str(out / "truth.txt")]
        + given(*sources.OPTIONS, "start", "frames"),
        "frontend": given("config", "seed") + settings,
        "backend": given("config") + settings,
        "recorder": ["--out", str(out), "--progress", "--options", json.dumps(told)]
        + given("seed"),
    }
    return {name: [str(paths.binaries() / name)] + arguments[name] + common for name in GRAPH}
