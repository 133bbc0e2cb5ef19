"""Vanishing points on a folder in the manner of the York Urban database, by york_bench."""

import pathlib
import subprocess

from vpslam_tools import install_build, paths
from vpslam_tools.errors import UserError
from vpslam_tools.suites.sequences import shared_data

NAME = "york"
HELP = ("vanishing points of every method with every line detector, against annotated truth; "
        "--data: a folder with images/, manhattan.txt, camera.yaml and, if there are, lines.txt")


def add_arguments(group):
    group.add_argument("--annotated", action="store_true",
                       help="run the methods on the annotated segments, too")


def run(args):
    data = pathlib.Path(args.data or shared_data() / "york_urban_train")
    if not data.is_dir():
        raise UserError(f"{data}: no such folder; name one with --data")
    install_build.prepare()
    command = [str(paths.binaries() / "york_bench"), "--data", str(data), "--out", str(args.out)]
    try:
        return subprocess.run(command + ["--annotated"] * args.annotated).returncode
    except OSError as error:
        raise UserError(f"{command[0]}: cannot be started ({error.strerror}); build it with "
                        "`scripts/vpslam build`") from None
