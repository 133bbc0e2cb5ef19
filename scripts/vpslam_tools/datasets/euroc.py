"""EuRoC: three archives hold the sequences as archives of their own; the left camera and the truth
are unpacked. Checksums are those of the publisher's page."""

from vpslam_tools.benchmark import catalogue
from vpslam_tools.datasets import Archive, Item, Part
from vpslam_tools.errors import UserError

PAGE = "https://doi.org/10.3929/ethz-b-000690084"
LICENCE = "terms of use: see there"
_URL = "https://www.research-collection.ethz.ch/server/api/core/bitstreams/{}/content"
ARCHIVES = {
    "MH": Archive(_URL.format("7b2419c1-62b5-4714-b7f8-485e5fe3e5fe"), "12.7 GB",
                  "363f5c2502b469cdd97ef85997714806", shared=True),
    "V1": Archive(_URL.format("02ecda9a-298f-498b-970c-b7c44334d880"), "6.0 GB",
                  "5ce06b405827e453a82523d3ca9c2fd0", shared=True),
    "V2": Archive(_URL.format("ea12bc01-3677-4b4c-853d-87c7870b8c44"), "6 GB",
                  "c6347f4e0476aaa9a43a919c163c49c5", shared=True),
}
ALL = [each.folder for each in catalogue.EUROC]
NAMES = "MH_01_easy ... V2_03_difficult, or all"


def items(names):
    wanted = []
    for name in names:
        matching = ALL if name == "all" else [each for each in ALL if each.startswith(name)]
        if not matching:
            raise UserError(f"{name}: is no sequence of EuRoC's; there are {', '.join(ALL)}")
        wanted += matching
    pattern = (r"(?P<path>mav0/cam0/(?:data\.csv|sensor\.yaml|data/[^/]+\.png)"
               r"|mav0/state_groundtruth_estimate0/[^/]+)")
    return [Item(name, name, (Part(ARCHIVES[name[:2]], pattern, inner=rf"(?:.*/)?{name}\.zip"),))
            for name in dict.fromkeys(wanted)]
