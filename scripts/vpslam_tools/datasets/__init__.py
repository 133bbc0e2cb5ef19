"""Public datasets: where their archives are, and which of their files make a sequence.

One module per dataset, with NAMES (or an explanation of them), PAGE, LICENCE, and items(names).
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class Archive:
    url: str
    size: str            # roughly, to be told before it is fetched
    md5: str = None      # where the publisher gives one
    shared: bool = False  # holds more than one sequence, so it is kept


@dataclass(frozen=True)
class Part:
    """Files of an archive, by a regular expression; what it matches from group `path` on is the
    name below the folder that it goes to."""
    archive: Archive
    pattern: str
    inner: str = None    # expression of an archive within the archive, to which `pattern` applies


@dataclass(frozen=True)
class Item:
    name: str
    folder: str          # below the dataset's own
    parts: tuple         # of Part
    extra: tuple = ()    # (file below the dataset's own folder, Part): not in `folder`
    note: str = ""
