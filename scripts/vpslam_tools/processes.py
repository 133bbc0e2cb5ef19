"""The process graph of a run, and the command line of each of its processes.

    player -> frontend <-> backend
                  \\         /
                   recorder
"""

from vpslam_tools import paths

# From the source downstream; the player ends first, the recorder last.
GRAPH = ["player", "frontend", "backend", "recorder"]


def command_lines(options, url, session, out):
    """{name: command} for `vpslam run` options. Options that were not given are not passed: the
    defaults are the binaries' own."""
    def given(flag, value):
        return [] if value is None else [flag, str(value)]

    common = (["--url", url, "--session", str(session), "--require",
               ",".join(GRAPH[1:])] + given("--pace", options.pace))
    system = given("--config", options.config) + given("--seed", options.seed)
    arguments = {
        "player": ([options.sequence, "--wait-for", ",".join(GRAPH[1:])]
                   + given("--camera", options.camera) + given("--frames", options.frames)
                   + given("--start", options.start)),
        "frontend": system + given("--preset", options.preset),
        "backend": system + given("--preset", options.preset),
        "recorder": ["--out", str(out), "--progress"] + given("--seed", options.seed),
    }
    return {name: [str(paths.binaries() / name)] + arguments[name] + common for name in GRAPH}
