"""`vpslam log`: what a log holds, with the sequence numbers that are missing."""

import json
import pathlib

from vpslam_tools import console, install_build


def add_parser(commands):
    parser = commands.add_parser("log", help="tell what the log of a run holds")
    parser.add_argument("log", metavar="LOG", help="log.lcm of a run, or the run's folder")
    parser.add_argument("--json", action="store_true", help="for programs")
    parser.set_defaults(function=show)


def show(args):
    install_build.prepare()
    path = pathlib.Path(args.log)
    summary = console.read_log(path / "log.lcm" if path.is_dir() else path)
    print(json.dumps(summary) if args.json else describe(summary))
    return 0


def describe(summary):
    lines = []
    if summary["run"]:
        lines.append(f"run      seed {summary['run']['seed']}, {summary['run']['commit']}")
        lines += [f"         {name} {value}" for name, value in summary["run"]["options"].items()
                  if name != "settings"]
    if summary["camera"]:
        lines.append("camera   {width} x {height} px".format(**summary["camera"]))
    lines.append(f"length   {summary['duration_s']:.1f} s, {summary['events']} messages")
    if summary["damaged_bytes"]:
        lines.append(f"damaged  {summary['damaged_bytes']} bytes in {summary['damaged_places']} "
                     "places, which are left out")
    unended = [name for name, channel in summary["channels"].items()
               if name in ("IMAGE", "FEATURES") and not channel["ended"]]
    if unended:
        lines.append(f"cut off  {', '.join(unended)}: the end of the sequence is missing")
    lines.append(f"{'channel':<14}{'messages':>9}{'missing':>9}{'repeated':>9}{'MB':>10}")
    for name, channel in summary["channels"].items():
        missing, repeated = ("-" if channel[key] is None else channel[key]
                             for key in ("missing", "repeated"))
        lines.append(f"{name:<14}{channel['messages']:>9}{missing:>9}{repeated:>9}"
                     f"{channel['bytes'] / 1e6:>10.3f}")
    return "\n".join(lines)
