"""Which sequences are there: those of the catalogue, and any further ones below the same folder."""

import os
import pathlib
from dataclasses import dataclass

from vpslam_tools.benchmark.catalogue import Sequence
from vpslam_tools.errors import UserError


@dataclass(frozen=True)
class Found:
    sequence: Sequence
    source: str          # what `vpslam run` is given
    frames: int          # None if not known


def is_sequence(folder):
    """As the player recognises them (docs/operating.md)."""
    return ((folder / "rgb.txt").is_file() or (folder / "mav0" / "cam0" / "data.csv").is_file()
            or ((folder / "times.txt").is_file()
                and any((folder / name).is_dir() for name in ("image_0", "image_2")))
            or any(folder.glob("*.gt.freiburg")))


def count_frames(folder):
    for listing in (folder / "rgb.txt", folder / "mav0" / "cam0" / "data.csv", folder / "times.txt"):
        if listing.is_file():
            lines = listing.read_text(errors="replace").splitlines()
            return sum(1 for line in lines if line.strip() and not line.startswith("#")) or None
    return sum(1 for _ in (folder / "rgb").glob("*.png")) or None


def discover(catalogue, data):
    """([Found], [Sequence] that are missing). `data` may itself be a sequence."""
    data = pathlib.Path(data)
    if not data.is_dir():
        raise UserError(f"{data}: no such folder; name one with --data, or fill it with "
                        "scripts/fetch-datasets")
    if is_sequence(data):
        name = os.path.basename(os.path.abspath(data))  # of a link: its own
        known = [each for each in catalogue if pathlib.Path(each.folder).name == name]
        return [_found(known[0] if known else Sequence(name, name), data)], []
    found = [_found(each, data / each.folder) for each in catalogue
             if is_sequence(data / each.folder)]
    missing = [each for each in catalogue if not is_sequence(data / each.folder)]
    listed = {(data / each.folder).resolve() for each in catalogue}
    further = [folder for folder in sorted(data.iterdir())
               if folder.resolve() not in listed and folder.is_dir() and is_sequence(folder)]
    found += [_found(Sequence(folder.name, folder.name), folder) for folder in further]
    return found, missing


def simulated(catalogue):
    return [Found(each, each.folder, 600) for each in catalogue]


def _found(sequence, folder):
    return Found(sequence, os.path.abspath(folder), count_frames(folder))
