"""Suites of sequences: the whole system on each, by several seeds, against the truth."""

import argparse
import os
import pathlib

from vpslam_tools import install_build, paths, presets, run_command
from vpslam_tools.benchmark import catalogue
from vpslam_tools.errors import UserError

FORWARDED = ["config", "detectors"]
DEFAULT_PACES = "lockstep,realtime"


class SequenceSuite:
    def __init__(self, name, what, sequences, default_data):
        self.NAME = name
        self.HELP = what
        self.sequences = sequences
        self.default_data = default_data  # a function; None: no data is needed

    def run(self, args):
        args.pace = args.pace or DEFAULT_PACES
        install_build.prepare()
        # What needs numpy, which may have just been installed.
        from vpslam_tools.benchmark import discovery, report, runs
        if self.default_data is None:
            found, missing = discovery.simulated(self.sequences), []
        else:
            found, missing = discovery.discover(self.sequences, args.data or self.default_data())
        if args.sequence:
            found, missing = select(found, missing, args.sequence)
        for each in missing:
            print(f"missing  {each.name}  ({each.folder})", flush=True)
        if not found:
            raise UserError("none of the suite's sequences is there; name their folder with --data, "
                            "or fetch them with scripts/fetch-datasets")
        done = runs.run_all(found, options(args), args.out, lambda text: print(text, flush=True))
        print(report.write(self.NAME, found, missing, done, args, args.out))
        return 0 if all(run["status"] == "done" for run in done) else 1


def select(found, missing, names):
    """Those that --sequence names."""
    def wanted(sequence):
        return sequence.name in names or sequence.folder in names
    chosen = [each for each in found if wanted(each.sequence)]
    absent = [each for each in missing if wanted(each)]
    known = {name for each in [each.sequence for each in chosen] + absent
             for name in (each.name, each.folder)}
    for name in names:
        if name not in known:
            raise UserError(f"--sequence {name}: the suite has none of this name")
    return chosen, absent


def options(args, preset_words=None, pictures=True):
    """Of all runs. preset_words: instead of the preset and switches that were given."""
    forwarded = [word for name in FORWARDED if getattr(args, name) is not None
                 for word in (f"--{name}", str(getattr(args, name)))]
    forwarded += presets.words(args) if preset_words is None else preset_words
    forwarded += [word for setting in args.set for word in ("--set", setting)]
    return argparse.Namespace(seeds=args.seeds, paces=args.pace.split(","), frames=args.frames,
                              camera=args.camera, run_options=forwarded,
                              pictures=pictures and not args.no_pictures)


def add_arguments(group):
    group.add_argument("--seeds", type=run_command.at_least(1), default=1, metavar="N",
                       help="run each sequence with the seeds 1 to N (default: 1)")
    group.add_argument("--pace", metavar="PACE[,PACE]",
                       help="as `vpslam run` has it; several stand side by side "
                       f"(default: {DEFAULT_PACES})")
    group.add_argument("--sequence", action="append", default=[], metavar="NAME",
                       help="only this one; may be repeated")
    group.add_argument("--frames", type=run_command.at_least(1), metavar="N",
                       help="at most so many frames of each")
    group.add_argument("--camera", metavar="FILE", help="calibration for all of them")
    group.add_argument("--no-pictures", action="store_true", help="tables only")
    presets.add_arguments(group)
    for name, metavar in (("config", "FILE"), ("detectors", "N")):
        group.add_argument(f"--{name}", metavar=metavar, help="passed on to `vpslam run`")
    group.add_argument("--set", action="append", default=[], metavar="SECTION.KEY=VALUE",
                       help="passed on to `vpslam run`; may be repeated")


def shared_data():
    return pathlib.Path(os.environ.get("VPSLAM_SHARED_DATA", paths.ROOT.parent / "shared" / "data"))


def datasets(name):
    return lambda: pathlib.Path("datasets", name)


SUITES = [
    SequenceSuite("shared", "seven excerpts and renderings, one of each kind of difficulty",
                  catalogue.SHARED, shared_data),
    SequenceSuite("tum", "TUM RGB-D: those of the paper, and whatever else is there",
                  catalogue.TUM, datasets("tum")),
    SequenceSuite("euroc", "EuRoC, left camera", catalogue.EUROC, datasets("euroc")),
    SequenceSuite("icl", "ICL-NUIM", catalogue.ICL, datasets("icl")),
    SequenceSuite("kitti", "KITTI odometry, left camera", catalogue.KITTI, datasets("kitti")),
    SequenceSuite("sim", "the simulated places; needs no data", catalogue.SIM, None),
]
