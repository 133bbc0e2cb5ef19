"""Vanishing points on a folder in the manner of the York Urban database, by york_bench."""

import pathlib
import subprocess

from vpslam_tools import install_build, paths
from vpslam_tools.errors import UserError

NAME = "york"
HELP = ("vanishing points of every method with every line detector, against annotated truth; "
        "--data: a folder with images/, manhattan.txt, camera.yaml and, if there are, lines.txt")


def add_arguments(group):
    group.add_argument("--annotated", action="store_true",
                       help="run the methods on the annotated segments, too")


def run(args):
    if not args.data:
        raise UserError("--suite york needs --data FOLDER")
    if not pathlib.Path(args.data).is_dir():
        raise UserError(f"{args.data}: no such folder; name one with --data")
    install_build.prepare()
    command = [str(paths.binaries() / "york_bench"), "--data", args.data, "--out", str(args.out)]
    try:
        return subprocess.run(command + ["--annotated"] * args.annotated).returncode
    except OSError as error:
        raise UserError(f"{command[0]}: cannot be started ({error.strerror}); build it with "
                        "`scripts/vpslam build`") from None
