"""`vpslam demo`: the whole graph on a simulated room, with figures and a picture of how it went."""

import argparse
import pathlib

from vpslam_tools import install_build, presets, run_command
from vpslam_tools.errors import UserError

SCENE = "sim:room"


def add_parser(commands):
    parser = commands.add_parser(
        "demo", help="install, build, and run on a simulated room, to see that it works",
        description="Installs and builds what is missing, runs the whole graph on a simulated room, "
        "compares the result with the exact truth, and draws both.")
    parser.add_argument("--scene", default=SCENE, metavar="SIM",
                        help=f"simulated place, such as sim:corridor (default: {SCENE})")
    parser.add_argument("--frames", type=run_command.at_least(1), metavar="N",
                        help="at most so many frames")
    parser.add_argument("--out", metavar="DIR", help="results folder; default: results/DATE-demo")
    presets.add_arguments(parser)
    parser.set_defaults(function=run)


def run(args):
    if not args.scene.startswith("sim:"):
        raise UserError(f"--scene {args.scene}: is not simulated; for other sequences there is "
                        f"`vpslam run {args.scene}`")
    install_build.prepare()
    out = pathlib.Path(args.out).resolve() if args.out else run_command.make_default_out("demo")
    print(f"A camera goes round {args.scene}, which exists in code alone (docs/simulator.md).",
          flush=True)
    status = run_command.run(run_options(args, out))
    if status == 0:
        print(conclude(args.scene, out))
    return status


def run_options(args, out):
    """What `vpslam run` would be given on the command line."""
    parser = argparse.ArgumentParser()
    run_command.add_parser(parser.add_subparsers())
    words = ["run", args.scene, "--out", str(out)] + presets.words(args)
    if args.frames:
        words += ["--frames", str(args.frames)]
    return parser.parse_args(words)


def conclude(scene, out):
    from vpslam_tools import evaluation, plots, trajectory  # numpy may have just been installed
    truth = trajectory.read_trajectory(out / "truth.txt")
    estimate = trajectory.read_trajectory(out / "trajectory.txt")
    result = evaluation.evaluate(estimate, truth, truth.stamps_s)
    pictures = plots.trajectory_figure(truth, {"VP-SLAM": estimate}, out / "trajectory",
                                       title=f"{scene}, monocular, aligned by a similarity")
    length_m = plots.path_length_m(truth)
    return "\n".join([
        "",
        f"The camera went {length_m:.2f} m; its estimated path is off by "
        f"{100 * result.ate_m.rmse / length_m:.2f} % of that:",
        f"  ATE       {1000 * result.ate_m.rmse:.1f} mm (rmse), {1000 * result.ate_m.max:.1f} mm at "
        "most",
        f"  rotation  {result.rotation_deg.rmse:.2f} degrees (rmse)",
        f"  coverage  {result.coverage:.3f} of {result.frames} frames",
        f"  picture   {pictures[0]} (and .svg)",
        f"  results   {out}",
        "",
        "What to try next:",
        "  scripts/vpslam run FOLDER                        your own sequence: TUM RGB-D, EuRoC,",
        "                                                   KITTI, ICL-NUIM, or plain images",
        "  scripts/vpslam run VIDEO --camera FILE.yaml      a video",
        "  scripts/vpslam run camera:0 --camera FILE.yaml   your own camera, until Ctrl-C",
        "  scripts/vpslam demo --scene sim:corridor         bare walls: hard for points",
        "  scripts/vpslam spy                               looks into a running graph, with lcm-spy",
        "docs/operating.md says how: the calibration FILE.yaml, and much else."])
