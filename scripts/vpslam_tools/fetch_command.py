"""`scripts/fetch-datasets`: public sequences, in the layout that `vpslam bench` expects."""

import pathlib
import shutil
import urllib.parse

from vpslam_tools.datasets import euroc, icl, kitti, tum
from vpslam_tools.datasets.download import download
from vpslam_tools.datasets.unpack import unpack
from vpslam_tools.errors import UserError

DATASETS = {"tum": tum, "euroc": euroc, "icl": icl, "kitti": kitti}


def add_parser(commands):
    parser = commands.add_parser(
        "fetch-datasets", help="download public sequences",
        description="Downloads sequences from where their publishers offer them, and unpacks the "
        "images of one camera, its calibration and the truth. Goes on where an earlier attempt "
        "stopped. Names: " + ". ".join(f"{name}: {dataset.NAMES}"
                                       for name, dataset in DATASETS.items()) + ".")
    parser.add_argument("dataset", choices=list(DATASETS))
    parser.add_argument("names", nargs="+", metavar="NAME")
    parser.add_argument("--out", default="datasets", metavar="DIR",
                        help="DIR/DATASET is filled (default: datasets)")
    parser.add_argument("--keep", action="store_true", help="keep every archive, in DIR/archives; "
                        "without it, those that hold more than one sequence")
    parser.add_argument("--mirror", metavar="URL",
                        help="ask this server for the same paths instead")
    parser.set_defaults(function=run)


def run(args):
    dataset = DATASETS[args.dataset]
    items = dataset.items(args.names)
    out = pathlib.Path(args.out).resolve()
    tell(f"{args.dataset}: {dataset.PAGE} ({dataset.LICENCE})")
    failed = []
    for item in items:
        try:
            fetch(item, out / args.dataset, out / "archives", args)
        except UserError as error:
            if len(items) == 1:
                raise
            failed.append(item.name)
            tell(f"{item.name}: {error}")
    if failed:
        raise UserError(f"{len(failed)} of {len(items)} are missing: {', '.join(failed)}; start again")
    tell(f"next: scripts/vpslam bench --suite {args.dataset} --data {out / args.dataset}")
    return 0


def fetch(item, folder, archives, args):
    target = folder / item.folder
    if item.note:
        tell(f"{item.name}: {item.note}")
    if target.exists():
        tell(f"{item.name}: is there already")
    else:
        unfinished = folder / f".unfinished-{item.folder.replace('/', '-')}"
        shutil.rmtree(unfinished, ignore_errors=True)
        for part in item.parts:
            take(item, part, unfinished, archives, args)
        target.parent.mkdir(parents=True, exist_ok=True)
        unfinished.rename(target)  # all or nothing
        tell(f"{item.name}: {target}")
    for below, part in item.extra:
        take(item, part, folder / below, archives, args)
    for part in item.parts:
        if not part.archive.shared and not args.keep:
            archive_path(part.archive, archives).unlink(missing_ok=True)


def take(item, part, folder, archives, args):
    path = archive_path(part.archive, archives)
    if not path.exists():
        tell(f"{item.name}: fetching {path.name}, {part.archive.size}")
    download(mirrored(part.archive.url, args.mirror), path, part.archive.md5,
             lambda text: tell(f"{item.name}: {text}"))
    tell(f"{item.name}: unpacking")
    try:
        count = unpack(path, part, folder)
    except OSError as error:
        raise UserError(f"{folder}: cannot be written ({error.strerror})") from None
    if count == 0:
        raise UserError(f"{path}: holds none of the files looked for; its layout has changed")


def archive_path(archive, archives):
    words = urllib.parse.urlsplit(archive.url).path.strip("/").split("/")
    return archives / (words[-1] if "." in words[-1] else "-".join(words[-2:]) + ".zip")


def mirrored(url, mirror):
    return mirror.rstrip("/") + urllib.parse.urlsplit(url).path if mirror else url


def tell(text):
    print(text, flush=True)
