"""ICL-NUIM, in its form compatible with TUM RGB-D: one archive per sequence, without depth."""

import re

from vpslam_tools.datasets import Archive, Item, Part
from vpslam_tools.errors import UserError

PAGE = "https://www.doc.ic.ac.uk/~ahanda/VaFRIC/iclnuim.html"
LICENCE = "CC BY 3.0"
URL = "https://www.doc.ic.ac.uk/~ahanda/{folder}.tar.gz"
NAMES = "lr/kt0 to lr/kt3 (living room), of/kt0 to of/kt3 (office), or all"
ALL = [f"{place}/kt{i}" for place in ("lr", "of") for i in range(4)]


def items(names):
    wanted = [each for name in names for each in (ALL if name == "all" else [name])]
    return [_item(name) for name in dict.fromkeys(wanted)]


def _item(name):
    found = re.fullmatch(r"(lr|of)/kt([0-3])", name)
    if not found:
        raise UserError(f"{name}: is no sequence of ICL-NUIM; there are {', '.join(ALL)}")
    prefix = {"lr": "living_room_", "of": ""}[found.group(1)]
    folder = f"{prefix}traj{found.group(2)}_frei_png"
    pattern = r"(?:.*/)?(?P<path>rgb/[^/]+\.png|associations\.txt|[^/]+\.gt\.freiburg)"
    return Item(name, folder, (Part(Archive(URL.format(folder=folder), "0.5 GB"), pattern),))
