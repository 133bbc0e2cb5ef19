"""Sequences in which the camera is covered, carried away or put back, made of a sequence in TUM's
layout: images are linked, listing and truth written anew. Time goes on as if the camera had
filmed it so."""

from dataclasses import dataclass
import pathlib

from vpslam_tools.errors import UserError

PERTURBATIONS = ("black", "cut", "back", "elsewhere")


@dataclass
class Entry:
    stamp_s: float
    image: pathlib.Path  # None for a black one
    truth: str           # "tx ty tz qx qy qz qw"; None where there is none


@dataclass
class Kidnapping:
    entries: list
    seen_from: int  # index of the first frame, after what happened, of a place seen before


def read_tum(folder):
    folder = pathlib.Path(folder)
    try:
        listing = _rows(folder / "rgb.txt")
        truth = [(float(row[0]), " ".join(row[1:8])) for row in _rows(folder / "groundtruth.txt")]
    except (OSError, ValueError, IndexError) as error:
        raise UserError(f"{folder}: no sequence in TUM's layout ({error}); name a folder with "
                        "rgb.txt and groundtruth.txt") from None
    entries, at = [], 0
    for row in listing:
        stamp = float(row[0])
        while at + 1 < len(truth) and abs(truth[at + 1][0] - stamp) <= abs(truth[at][0] - stamp):
            at += 1
        near = bool(truth) and abs(truth[at][0] - stamp) < 0.02
        entries.append(Entry(stamp, (folder / row[1]).resolve(), truth[at][1] if near else None))
    if len(entries) < 2:
        raise UserError(f"{folder}/rgb.txt: fewer than two images; name another sequence")
    return entries


def kidnap(how, entries, at, frames, alien=None):
    """`how` of PERTURBATIONS, beginning at index `at`, lasting (or going back) `frames`."""
    if not 0 < at < len(entries) or frames < 1:
        raise UserError(f"the sequence has {len(entries)} frames, too few for what was asked")
    head, tail = entries[:at], entries[at:]
    if how == "black":
        middle = [Entry(0, None, None) for _ in tail[:frames]]
        tail, seen_from = tail[frames:], at + len(middle)
    elif how == "cut":
        middle, tail, seen_from = [], tail[frames:], at
    elif how == "back":
        middle, tail, seen_from = [], entries[max(0, at - frames):], at
    elif how == "elsewhere":
        middle = [Entry(0, entry.image, None) for entry in (alien or [])[:frames]]
        seen_from = at + len(middle)
    else:
        raise UserError(f"{how}: choose of {', '.join(PERTURBATIONS)}")
    period = (entries[-1].stamp_s - entries[0].stamp_s) / (len(entries) - 1)
    made = [Entry(entries[0].stamp_s + i * period, entry.image, entry.truth)
            for i, entry in enumerate(head + middle + tail)]
    return Kidnapping(made, seen_from)


def write_tum(folder, made, camera, size):
    """`camera`: text of camera.yaml. `size`: width, height of the black image."""
    folder = pathlib.Path(folder)
    (folder / "rgb").mkdir(parents=True, exist_ok=True)
    black = folder / "black.pgm"
    black.write_bytes(b"P5\n%d %d\n255\n" % size + bytes(size[0] * size[1]))
    listing, truth = [], []
    for index, entry in enumerate(made.entries):
        image = entry.image or black.resolve()
        name = f"rgb/{index:06d}{image.suffix}"
        link = folder / name
        link.unlink(missing_ok=True)
        link.symlink_to(image)
        listing.append(f"{entry.stamp_s:.6f} {name}\n")
        if entry.truth:
            truth.append(f"{entry.stamp_s:.6f} {entry.truth}\n")
    (folder / "groundtruth.txt").write_text("".join(truth))
    (folder / "camera.yaml").write_text(camera)
    (folder / "rgb.txt").write_text("".join(listing))


def frames_to_recover(made, stamps_s, seen_from, window_s=10.0):
    """Frames from the return to a seen place until the first of them with a pose of the main map;
    None if there is none within the window. `stamps_s`: of the poses of that map."""
    tracked = set(round(stamp, 3) for stamp in stamps_s)
    for index in range(seen_from, len(made.entries)):
        if made.entries[index].stamp_s > made.entries[seen_from].stamp_s + window_s:
            return None
        if round(made.entries[index].stamp_s, 3) in tracked:
            return index - seen_from
    return None


def _rows(path):
    return [line.split() for line in path.read_text().splitlines()
            if line.strip() and not line.startswith("#")]
