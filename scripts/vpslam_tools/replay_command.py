"""`vpslam replay`: the graph of a run again, from its log."""

import argparse
import pathlib

from vpslam_tools import console, install_build, presets, run_command
from vpslam_tools.errors import UserError

# What of the recorded run is done again; where its images came from matters no more.
RECORDED = ["set", "pace", *presets.options(), "detectors"]


def add_parser(commands):
    parser = commands.add_parser(
        "replay", help="run the process graph on the log of a run",
        description="Plays the log that `vpslam run --record` wrote: its images, or the features "
        "and lines of a log without. Preset, settings and seed are those of the recorded run; in "
        "lockstep the trajectory is the same, byte for byte.")
    parser.add_argument("log", metavar="LOG", help="log.lcm of a run, or the run's folder")
    parser.add_argument("--pace", choices=run_command.PACES,
                        help="default: as recorded; of a run in real time lossless")
    parser.add_argument("--features", action="store_true",
                        help="play features and lines, even if the log has images")
    parser.add_argument("--detectors", type=run_command.at_least(0), metavar="N",
                        help="default: as recorded; features need none")
    parser.add_argument("--start", type=run_command.at_least(0), metavar="N",
                        help="first frame, from 0")
    parser.add_argument("--frames", type=run_command.at_least(1), metavar="N",
                        help="at most so many frames")
    parser.add_argument("--out", metavar="DIR",
                        help="results folder; default: results/DATE-replay")
    run_command.add_graph_arguments(parser)
    parser.set_defaults(function=replay)


def replay(args):
    install_build.prepare()
    path = pathlib.Path(args.log)
    if path.is_dir():
        path = path / "log.lcm"
    summary = console.read_log(path)
    options = run_options(args, path, summary)
    if summary["run"] is None:
        print(f"{path} does not say how it was recorded; defaults are used", flush=True)
    settings = recorded(summary).get("settings")
    if settings is not None:
        out = pathlib.Path(options.out or run_command.make_default_out("replay"))
        try:
            out.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise run_command.cannot_be_made(out, error) from None
        options.out = str(out)
        (out / "settings.yaml").write_text(settings)
        options.config = str(out / "settings.yaml")
    return run_command.run_graph(options)


def recorded(summary):
    return summary["run"]["options"] if summary["run"] else {}


def run_options(args, path, summary):
    """The options of `vpslam run` that do the recorded run again, with what `args` changes."""
    options = argparse.ArgumentParser()
    run_command.add_parser(options.add_subparsers())
    options = options.parse_args(["run", str(path)])
    was = recorded(summary)
    for name in RECORDED:
        if name in was:
            setattr(options, name, was[name])
    if options.preset not in presets.PRESETS:
        raise UserError(f"{path}: recorded with the preset '{options.preset}', which this version "
                        "does not have; use the version that recorded it")
    if summary["run"]:
        options.seed = summary["run"]["seed"]
    options.source = "log"
    if options.pace == "realtime":
        options.pace = "lossless"  # what is in the log is not to be lost again
    for name in ("pace", "detectors"):
        if getattr(args, name) is not None:
            setattr(options, name, getattr(args, name))
    for name in ("start", "frames", "out", "url", "session", "preview"):
        setattr(options, name, getattr(args, name))
    if options.detectors is None:
        options.detectors = presets.detectors(options)
    channels = summary["channels"]
    options.from_features = args.features or "IMAGE" not in channels
    if options.from_features:
        if "FEATURES" not in channels:
            raise UserError(f"{path}: holds neither images nor features; record it with "
                            "`vpslam run --record features` or `all`")
        options.detectors = 0  # the lines are in the log
    return options
