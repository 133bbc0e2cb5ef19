"""Vanishing points on a folder in the manner of the York Urban database, by york_bench."""

import json
import pathlib
import subprocess

from vpslam_tools import install_build, paths
from vpslam_tools.errors import UserError
from vpslam_tools.suites.sequences import shared_data

NAME = "york"
HELP = ("vanishing points of every method with every line detector, against annotated truth; "
        "--data: a folder with images/, manhattan.txt, camera.yaml and, if there are, lines.txt")
# AA@3/5/10 of others on the 51 training images of the database.
ELSEWHERE = ("Elsewhere, AA@3/5/10: J-Linkage 57.7 / 69.3 / 80.5; a least-squares fit to the annotated "
             "segments with their true labels 80 / 88 / 94.")


def add_arguments(group):
    group.add_argument("--annotated", action="store_true",
                       help="run the methods on the annotated segments, too")


def run(args):
    data = pathlib.Path(args.data or shared_data() / "york_urban_train")
    if not data.is_dir():
        raise UserError(f"{data}: no such folder; name one with --data")
    install_build.prepare()
    # What needs numpy, which may have just been installed.
    from vpslam_tools.benchmark import report
    from vpslam_tools.benchmark.runs import write_json
    command = [str(paths.binaries() / "york_bench"), "--data", str(data), "--out", str(args.out)]
    try:
        status = subprocess.run(command + ["--annotated"] * args.annotated).returncode
    except OSError as error:
        raise UserError(f"{command[0]}: cannot be started ({error.strerror}); build it with "
                        "`scripts/vpslam build`") from None
    if status != 0:
        return status
    commits, line = [report.revision()] if report.revision() else [], report.command_line()
    text = "\n".join(["# Suite york\n", report.origin(line, commits),
                      (args.out / "york.md").read_text(), ELSEWHERE + "\n"])
    (args.out / "results.md").write_text(text)
    write_json(args.out / "results.json", {
        "suite": NAME, "command": line, "commits": commits, "machine": report.machine(),
        "rows": json.loads((args.out / "york.json").read_text())})
    print(f"\n{ELSEWHERE}\nresults  {args.out}")
    return 0
