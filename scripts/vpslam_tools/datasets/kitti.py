"""KITTI odometry, left grey camera: one archive with the images of all sequences, one with the
calibrations, one with the truth of the sequences 00 to 10."""

import re

from vpslam_tools.datasets import Archive, Item, Part
from vpslam_tools.errors import UserError

PAGE = "https://www.cvlibs.net/datasets/kitti/eval_odometry.php"
LICENCE = "CC BY-NC-SA 3.0; the page asks for registration"
_URL = "https://s3.eu-central-1.amazonaws.com/avg-kitti/data_odometry_{}.zip"
IMAGES = Archive(_URL.format("gray"), "22 GB", shared=True)
CALIBRATIONS = Archive(_URL.format("calib"), "1 MB", shared=True)
POSES = Archive(_URL.format("poses"), "4 MB", shared=True)
NAMES = "00 to 21, or all"
ALL = [f"{i:02d}" for i in range(22)]
WITH_TRUTH = 11


def items(names):
    wanted = [each for name in names for each in (ALL if name == "all" else [name])]
    for name in wanted:
        if not re.fullmatch(r"[01]\d|2[01]", name):
            raise UserError(f"{name}: is no sequence of KITTI odometry; there are 00 to 21")
    return [_item(name) for name in dict.fromkeys(wanted)]


def _item(name):
    has_truth = int(name) < WITH_TRUTH
    truth = Part(POSES, rf"(?:.*/)?poses/(?P<path>{name}\.txt)")
    return Item(name, f"sequences/{name}",
                (Part(CALIBRATIONS, rf"(?:.*/)?sequences/{name}/(?P<path>calib\.txt|times\.txt)"),
                 Part(IMAGES, rf"(?:.*/)?sequences/{name}/(?P<path>image_0/\d+\.png)")),
                extra=(("poses", truth),) if has_truth else (),
                note="" if has_truth else "no truth is published for the sequences from 11 on")
