"""How two detectors share images against one, by detector_bench."""

import subprocess

from vpslam_tools import install_build, multicast, paths
from vpslam_tools.errors import UserError

NAME = "detectors"
HELP = ("frames per second and CPU time of one and of two detectors on preloaded images; --data: a "
        "sequence")


def add_arguments(group):
    group.add_argument("--repetitions", type=int, default=3, metavar="N",
                       help="measure so often (default: 3)")


def run(args):
    if not args.data:
        raise UserError("--suite detectors needs --data SEQUENCE")
    install_build.prepare()
    multicast.ensure_multicast()
    done = subprocess.run(
        [str(paths.binaries() / "detector_bench"), "--data", args.data,
         "--repetitions", str(args.repetitions)], stdout=subprocess.PIPE, text=True)
    print(done.stdout, end="")
    (args.out / "detectors.md").write_text(done.stdout)
    return done.returncode
