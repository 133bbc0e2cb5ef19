"""The runs of this user: one JSON file each, so that other commands find them.

    $XDG_RUNTIME_DIR/vpslam/<session>.json, or /tmp/vpslam-<uid>/ where there is no such folder:
    {"session", "url", "sequence", "out", "started", "launcher": process,
     "processes": {name: process}}          process: {"pid", "start"}

`start` is the time at which the kernel started the process, which tells a process from a later one
with the same id. A run ends in clean_up(), called by the launcher; if that was killed, by the
guardian it left behind (guardian.py); and by every later command for runs that nobody cleaned up.
"""

import json
import os
import pathlib
import signal
import stat
import time

from vpslam_tools.errors import UserError

SHARED_MEMORY = pathlib.Path("/dev/shm")
DEATH_S = 5.0  # a killed process may still be freeing its memory


def directory():
    base = os.environ.get("XDG_RUNTIME_DIR")
    if base and os.path.isdir(base) and os.stat(base).st_uid == os.getuid():
        path = pathlib.Path(base, "vpslam")
    else:
        path = pathlib.Path(f"/tmp/vpslam-{os.getuid()}")
    path.mkdir(mode=0o700, exist_ok=True)
    status = os.lstat(path)
    if (not stat.S_ISDIR(status.st_mode) or status.st_uid != os.getuid()
            or status.st_mode & 0o077):
        raise UserError(f"{path} is not a private folder of this user; remove it")
    return path


def path_of(session):
    return directory() / f"{session}.json"


def write(run):
    path = path_of(run["session"])
    new = path.with_suffix(".new")
    new.write_text(json.dumps(run, indent=2) + "\n")
    os.replace(new, path)


def read(path):
    """The run, or None if the file has gone or is not one."""
    try:
        run = json.loads(path.read_text())
        return run if run["session"] and run["launcher"]["pid"] else None
    except (OSError, ValueError, KeyError, TypeError):
        return None


def identify(pid):
    """What the registry keeps of a process; None if there is no such process (or a zombie)."""
    try:
        # After the name in brackets, which may hold anything: state is field 3, start field 22.
        fields = pathlib.Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return None
    return None if fields[0] in "ZX" else {"pid": pid, "start": int(fields[19])}


def is_alive(process):
    return process is not None and identify(process["pid"]) == process


def alive_runs():
    runs = [read(path) for path in sorted(directory().glob("*.json"))]
    return [run for run in runs if run and is_alive(run["launcher"])]


def clean_up(run):
    """Ends whatever is left of a run and takes away its shared memory and its registration."""
    for process in run["processes"].values():
        if is_alive(process):
            try:
                os.killpg(process["pid"], signal.SIGKILL)
            except ProcessLookupError:
                pass
    deadline = time.monotonic() + DEATH_S
    while any(map(is_alive, run["processes"].values())) and time.monotonic() < deadline:
        time.sleep(0.01)
    unlink_segment(run["session"])
    path_of(run["session"]).unlink(missing_ok=True)


def unlink_segment(session):
    """The player names its segment after its session; it unlinks it itself unless it was killed."""
    try:
        (SHARED_MEMORY / f"vpslam-{session}").unlink()
    except (FileNotFoundError, PermissionError):
        pass


def sweep():
    """Cleans up after runs whose launcher is gone."""
    for path in directory().glob("*.json"):
        run = read(path)
        if run and not is_alive(run["launcher"]):
            clean_up(run)
