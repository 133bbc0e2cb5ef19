"""`vpslam status`: a table of a running graph's processes, from what they say of themselves."""

import json
import os
import select
import shutil
import subprocess
import sys
import time

from vpslam_tools import console, install_build
from vpslam_tools.errors import UserError
from vpslam_tools.processes import die_with_parent

LISTEN_S = 1.5   # every process speaks once a second
REFRESH_S = 1.0
ENDED = ("finished", "failed")
SILENT_S = 5.0   # then a line is marked
FORGET_S = 60.0  # what ended is shown for so long
COLUMNS = [("process", "{process}", 11), ("pid", "{pid}", 8), ("state", "{state}", 10),
           ("rate Hz", "{rate_hz:.1f}", 8), ("done", "{processed}", 8), ("queue", "{queued}", 6),
           ("drops", "{dropped}", 6), ("gaps", "{gaps}", 6), ("refused", "{rejected}", 8),
           ("resent", "{resent}", 7), ("CPU s", "{cpu_s:.1f}", 8),
           ("peak MB", "{rss_peak_mb:.0f}", 8)]
ORDER = ["player", "vpdetector", "frontend", "backend", "recorder"]


def add_parser(commands):
    parser = commands.add_parser(
        "status", help="tell what the processes of a running graph do",
        description="A line per process: state, messages worked on per second and in all, waiting, "
        "dropped, sequence numbers that never came, messages refused and sent again, CPU time and "
        "peak memory.")
    parser.add_argument("--url", metavar="URL", help="of the graph; default: that of the only run")
    parser.add_argument("--watch", action="store_true",
                        help="again every second, until the graph ends")
    parser.add_argument("--json", action="store_true", help="for programs: a line per process")
    parser.set_defaults(function=show)


class Table:
    """The last status of each process that was heard."""

    def __init__(self):
        self._heard = {}  # by session

    def add(self, line, now):
        try:
            status = json.loads(line)
            self._heard[status["session"]] = (now, status)
        except (ValueError, KeyError, TypeError):
            pass  # a line that was cut off

    def rows(self, now):
        """Statuses, sources first; with `silent_s`."""
        self._heard = {session: (heard, status) for session, (heard, status) in self._heard.items()
                       if now - heard < FORGET_S}
        rows = [dict(status, silent_s=now - heard) for heard, status in self._heard.values()]
        position = {name: number for number, name in enumerate(ORDER)}
        return sorted(rows, key=lambda row: (position.get(row["process"], len(ORDER)),
                                             row["process"], row["pid"]))


def describe(rows):
    lines = ["".join(f"{title:<{width}}" if number in (0, 2) else f"{title:>{width}}  "
                     for number, (title, _, width) in enumerate(COLUMNS))]
    for row in rows:
        cells = "".join(
            f"{form.format(**row):<{width}}" if number in (0, 2)
            else f"{form.format(**row):>{width}}  "
            for number, (_, form, width) in enumerate(COLUMNS))
        ended = row["state"] in ENDED
        silent = f"silent for {row['silent_s']:.0f} s  " * (
            not ended and row["silent_s"] > SILENT_S)
        lines.append((cells + silent + row["message"]).rstrip())
    return "\n".join(lines)


def show(args):
    install_build.prepare()
    url = console.find_url(args.url)
    seconds = [] if args.watch else ["--seconds", str(LISTEN_S)]
    listener = subprocess.Popen(console.command_line("status", "--url", url, *seconds),
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                preexec_fn=die_with_parent())
    try:
        return watch(listener, args.json) if args.watch else once(listener, args.json)
    finally:
        listener.kill()
        listener.communicate()


def draw(text, drawn):
    """Over the `drawn` lines of the last time; the number of lines now."""
    lines = text.split("\n")
    if sys.stdout.isatty():
        width = shutil.get_terminal_size().columns - 1  # a line that wraps would count as two
        lines = [line[:width] for line in lines]
        if drawn:
            print(f"\033[{drawn}A\033[J", end="")
    print("\n".join(lines), flush=True)
    return len(lines)


def once(listener, as_json):
    table = Table()
    output, errors = listener.communicate()
    if listener.returncode != 0:
        raise UserError(errors.strip().removeprefix("console: "))
    for line in output.splitlines():
        table.add(line, time.monotonic())
    rows = table.rows(time.monotonic())
    if not rows:
        raise UserError("nobody says anything there; does the graph still run?")
    print("\n".join(json.dumps(row) for row in rows) if as_json else describe(rows))
    return 0


def watch(listener, as_json):
    """Until the graph has ended: all of its processes have, or are gone without a word."""
    table, shown, drawn, rest = Table(), 0.0, 0, b""
    while True:
        data = None
        if select.select([listener.stdout], [], [], REFRESH_S)[0]:
            data = os.read(listener.stdout.fileno(), 65536)
            if not data:
                break
        now = time.monotonic()
        *lines, rest = (rest + (data or b"")).split(b"\n")
        for line in lines:
            table.add(line.decode(), now)
            if as_json:
                print(line.decode(), flush=True)
        rows = table.rows(now)
        ended = [row["state"] in ENDED for row in rows]
        over = any(ended) and all(end or row["silent_s"] > SILENT_S
                                  for end, row in zip(ended, rows))
        if rows and not as_json and (over or now >= shown + REFRESH_S):
            drawn, shown = draw(describe(rows), drawn), now
        if over:
            return 0
    raise UserError(listener.stderr.read().strip().removeprefix("console: ") or "it fell silent")
