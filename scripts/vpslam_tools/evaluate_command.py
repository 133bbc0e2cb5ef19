"""`vpslam evaluate`: compares a trajectory with the truth."""

import json
import pathlib

from vpslam_tools import install_build, paths
from vpslam_tools.errors import UserError


def add_parser(commands):
    parser = commands.add_parser(
        "evaluate", help="compare a trajectory with the truth",
        description="ATE, RPE over 1 s, rotation error, scale and coverage of a trajectory. Both "
        "files: timestamp tx ty tz qx qy qz qw, camera-to-world.")
    parser.add_argument("estimate", metavar="ESTIMATE")
    parser.add_argument("truth", metavar="GROUNDTRUTH")
    parser.add_argument("--frames", metavar="FILE",
                        help="rgb.txt of the sequence, to know the coverage")
    parser.add_argument("--se3", action="store_true", help="align without scale")
    parser.add_argument("--interpolate", action="store_true",
                        help="interpolate the truth to each pose's time; by default the nearest "
                        "truth within 0.02 s is taken")
    parser.add_argument("--plot", metavar="DIR",
                        help="draw both trajectories and the error over time: DIR/trajectory.png and "
                        ".svg; DIR is made if missing")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    parser.set_defaults(function=run)


def run(args):
    if paths.has_to_build():
        install_build.ensure_packages()  # numpy; nothing is built
    result = evaluate_files(args.estimate, args.truth, args.frames, not args.se3, args.interpolate)
    print(json.dumps(result.as_dict()) if args.json else describe(result))
    if args.plot:
        plot(args)
    return 0


def plot(args):
    from vpslam_tools import plots, trajectory
    out = pathlib.Path(args.plot)
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UserError(f"{out}: cannot be made ({error.strerror}); name another folder with --plot"
                        ) from None
    estimate = pathlib.Path(args.estimate)
    pictures = plots.trajectory_figure(
        trajectory.read_trajectory(args.truth), {"estimate": trajectory.read_trajectory(estimate)},
        out / "trajectory", title=f"{estimate.parent.name}/{estimate.name}".lstrip("/"),
        with_scale=not args.se3)
    if not args.json:
        print(f"{'pictures':<16} " + " ".join(map(str, pictures)))


def evaluate_files(estimate, truth, frames=None, with_scale=True, interpolate=False):
    try:
        import numpy  # noqa: F401  (imported here: the packages may have just been installed)
    except ImportError:
        raise UserError("python3-numpy is missing; as root type: apt-get install python3-numpy"
                        ) from None
    from vpslam_tools import evaluation, trajectory
    frame_stamps = trajectory.read_frame_stamps(frames) if frames else None
    return evaluation.evaluate(trajectory.read_trajectory(estimate),
                               trajectory.read_trajectory(truth),
                               frame_stamps, with_scale, interpolate)


def describe(result):
    def row(name, statistics, unit):
        if statistics is None:
            return f"{name:<16} no two poses are {result.rpe_delta_s:g} s apart"
        return (f"{name:<16} rmse {statistics.rmse:.4f}  median {statistics.median:.4f}  "
                f"max {statistics.max:.4f} {unit}")
    coverage = "not known (give --frames)" if result.coverage is None else (
        f"{result.coverage:.4f} of {result.frames} frames")
    return "\n".join([
        row("ATE", result.ate_m, f"m after {result.alignment} alignment"),
        row(f"RPE over {result.rpe_delta_s:g} s", result.rpe_translation_m, "m"),
        row("", result.rpe_rotation_deg, "deg"),
        row("rotation error", result.rotation_deg, "deg after the best constant rotation"),
        f"{'scale':<16} {result.scale:.6f} metres per unit of the estimate",
        f"{'coverage':<16} {coverage}",
        f"{'compared':<16} {result.compared} of {result.poses} poses with a truth near in time"])
