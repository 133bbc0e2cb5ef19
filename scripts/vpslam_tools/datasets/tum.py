"""TUM RGB-D: one archive per sequence, of which the colour images and the truth are unpacked."""

import re

from vpslam_tools.benchmark import catalogue
from vpslam_tools.datasets import Archive, Item, Part
from vpslam_tools.errors import UserError

PAGE = "https://cvg.cit.tum.de/data/datasets/rgbd-dataset/download"
LICENCE = "CC BY 4.0"
URL = "https://cvg.cit.tum.de/rgbd/dataset/freiburg{camera}/{folder}.tgz"
NAMES = "such as fr1/desk or freiburg1_desk; paper: the nine of the paper, and one more with truth"
NO_TRUTH = ("no truth is published for *_validation sequences: they run, and are compared with "
            "nothing; the sequence without that suffix has one")


def items(names):
    folders = []
    for name in names:
        folders += [each.folder for each in catalogue.TUM] if name == "paper" else [folder_of(name)]
    return [_item(folder) for folder in dict.fromkeys(folders)]


def folder_of(name):
    found = re.fullmatch(r"(?:rgbd_dataset_)?(?:fr|freiburg)([123])[/_](\w+)", name)
    if not found:
        raise UserError(f"{name}: is no sequence of TUM's; write it as fr1/desk (their list: {PAGE})")
    return f"rgbd_dataset_freiburg{found.group(1)}_{found.group(2)}"


def _item(folder):
    camera = re.search(r"freiburg([123])", folder).group(1)
    archive = Archive(URL.format(camera=camera, folder=folder), "0.2 to 2 GB")
    pattern = r"[^/]+/(?P<path>rgb/[^/]+\.png|rgb\.txt|groundtruth\.txt)"
    return Item(folder, folder, (Part(archive, pattern),),
                note=NO_TRUTH if folder.endswith("_validation") else "")
