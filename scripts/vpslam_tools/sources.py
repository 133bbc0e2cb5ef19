"""What `vpslam run` has to know of the player's sources; their formats are the player's matter."""

import os
import pathlib
import re

from vpslam_tools import paths
from vpslam_tools.errors import UserError

OPTIONS = ["source", "camera", "fps", "width", "height", "pixel_format", "mask"]  # passed on to the player
NOT_A_PATH = re.compile(r"sim:|camera:|\w+://")


def add_arguments(parser):
    parser.add_argument("sequence", metavar="SEQUENCE",
                        help="folder of a sequence (TUM RGB-D, ETH3D, EuRoC, TUM-VI, KITTI, ICL-NUIM, "
                        "TartanAir, 7-Scenes, or plain images), one series of a folder's images "
                        "('FOLDER/left*.png', where * stands for a number), video file, live camera "
                        "(camera:0), or a simulated place (sim:room, sim:corridor)")
    parser.add_argument("--source", metavar="KIND",
                        help="kind of SEQUENCE, if not the one that is recognised: sim, camera, icl, "
                        "eth3d, tum, tumvi, euroc, kitti, tartanair, 7scenes, images, video")
    parser.add_argument("--camera", metavar="FILE",
                        help="calibration, such as those in config/cameras; default: the "
                        "sequence's own, or the published one of its TUM RGB-D camera")
    parser.add_argument("--mask", metavar="FILE",
                        help="picture of the images' size: where it is black they are not used, "
                        "since what moves with the camera is there (default: the calibration's)")
    parser.add_argument("--fps", metavar="HZ", help="rate of plain images, a video or a camera")
    parser.add_argument("--width", metavar="PX", help="asked of a live camera")
    parser.add_argument("--height", metavar="PX", help="asked of a live camera")
    parser.add_argument("--pixel-format", metavar="FOURCC",
                        help="asked of a live camera, such as MJPG, YUYV, GREY (default: MJPG if it "
                        "has that, since raw images come slowly over USB)")


def check(args):
    """What need not wait until the processes are up; the rest the player checks."""
    path = pathlib.Path(args.sequence)
    is_series = "*" in path.name and path.parent.is_dir()
    if not NOT_A_PATH.match(args.sequence) and not path.exists() and not is_series:
        raise UserError(f"{args.sequence}: no such folder, video or camera; for a first try there is "
                        "sim:room")


def published_camera(sequence):
    """File of the calibration that TUM RGB-D publishes for the camera of this sequence, known by the
    name of its folder or of what that links to; None where the folder has its own, or is of another
    kind."""
    folder = pathlib.Path(sequence)
    if folder.name == "rgb.txt":
        folder = folder.parent  # the player takes its folder as well
    if not (folder / "rgb.txt").is_file():
        return None
    if (folder / "camera.yaml").exists() or (folder / "calibration.txt").exists():
        return None
    freiburg = re.search(r"freiburg([123])",
                         f"{os.path.basename(os.path.abspath(folder))} {folder.resolve().name}")
    return str(paths.CONFIG / "cameras" / f"tum{freiburg.group(1)}.yaml") if freiburg else None


def short_name(sequence):
    """For a results folder."""
    if not NOT_A_PATH.match(sequence):
        sequence = os.path.basename(os.path.abspath(sequence))
    return re.sub(r"[^\w.]+", "-", sequence).strip("-") or "run"
