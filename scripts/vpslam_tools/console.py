"""What the program `console` knows of running graphs and of logs (console/main.cpp)."""

import json
import subprocess

from vpslam_tools import paths, registry
from vpslam_tools.errors import UserError


def command_line(*arguments):
    return [str(paths.binaries() / "console"), *arguments]


def read_log(path):
    """What a log holds; console/log_summary.h has the fields."""
    done = subprocess.run(command_line("log", str(path)), capture_output=True, text=True)
    if done.returncode != 0:
        raise UserError(done.stderr.strip().removeprefix("console: ") or f"{path}: unreadable")
    return json.loads(done.stdout)


def find_url(given):
    """The URL that was named, or that of the only run of this user."""
    if given:
        return given
    runs = registry.alive_runs()
    if not runs:
        raise UserError("no run is going on; start one with `vpslam run`, or name its --url")
    if len(runs) > 1:
        listed = "".join(f"\n  --url '{run['url']}'  {run['sequence']}" for run in runs)
        raise UserError("several runs are going on; name one:" + listed)
    return runs[0]["url"]
