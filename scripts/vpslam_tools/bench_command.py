"""`vpslam bench`: measures, one suite at a time."""

import pathlib
import signal

from vpslam_tools import suites
from vpslam_tools.errors import UserError


def add_parser(commands):
    parser = commands.add_parser(
        "bench", help="measure accuracy and time",
        description="Runs one suite of measurements, prints its tables and leaves them in a folder.")
    parser.add_argument("--suite", required=True, choices=list(suites.ALL),
                        help="; ".join(f"{name}: {suite.HELP}" for name, suite in
                                       suites.ALL.items()))
    parser.add_argument("--data", metavar="FOLDER",
                        help="what to measure on; default: ../shared/data for shared, "
                        "ablation, spread and york, datasets/SUITE for tum, euroc, icl and kitti")
    parser.add_argument("--out", metavar="DIR",
                        help="folder for the results, made if missing; runs that are complete there "
                        "are not repeated (default: results/bench-SUITE)")
    for names, add_arguments in suites.ARGUMENTS.items():
        add_arguments(parser.add_argument_group(f"suite {names}"))
    parser.set_defaults(function=run)


def run(args):
    args.out = pathlib.Path(args.out or f"results/bench-{args.suite}").resolve()
    try:
        args.out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UserError(f"{args.out}: cannot be made ({error.strerror}); name another folder with "
                        "--out") from None
    # What ends the bench ends its runs as well.
    for number in (signal.SIGTERM, signal.SIGHUP):
        if signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, signal.default_int_handler)
    return suites.ALL[args.suite].run(args)
