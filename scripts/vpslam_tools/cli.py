"""The command line: one sub-command per module."""

import argparse
import sys

from vpslam_tools import (bench_command, demo_command, evaluate_command, fetch_command,
                          install_build, log_command, replay_command, run_command, spy_command,
                          status_command)
from vpslam_tools.errors import UserError, describe


def build_parser():
    parser = argparse.ArgumentParser(
        prog="vpslam",
        description="Monocular visual SLAM as a graph of processes that talk over LCM.")
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)
    demo_command.add_parser(commands)
    run_command.add_parser(commands)
    replay_command.add_parser(commands)
    status_command.add_parser(commands)
    spy_command.add_parser(commands)
    log_command.add_parser(commands)
    evaluate_command.add_parser(commands)
    bench_command.add_parser(commands)
    fetch_command.add_parser(commands)
    install_build.add_parsers(commands)
    return parser


def main(arguments):
    parser = build_parser()
    args, args.rest = parser.parse_known_args(arguments)
    if args.rest and args.command != "test":
        parser.error("unrecognised arguments: " + " ".join(args.rest))
    try:
        return args.function(args)
    except UserError as error:
        print(f"vpslam {args.command}: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        return 130
    except BrokenPipeError:
        # The reader of our output went away (`vpslam evaluate ... | head`); not worth a traceback.
        sys.stderr.close()
        return 1
    except OSError as error:  # a folder that cannot be written, a full disk, ...
        print(f"vpslam {args.command}: {describe(error)}", file=sys.stderr)
        return 1
