"""What became of the images of a sequence: the end of the console's output, from summary.json.

One form for all of it: `played N of M images: K skipped (reason), ...` for what was not played, and
`no pose for P of N images: K reason, ...` for what was not tracked.
"""

MAX_NOTES = 8  # the others are in logs/player.log


def lines(summary):
    """A line each, for the console. `summary`: what summary.json holds."""
    told = [played_line(summary)]
    without_pose = no_pose_line(summary)
    if without_pose:
        told.append(without_pose)
    notes = summary.get("sequence", {}).get("notes", [])
    told += [f"note     {note}" for note in notes[:MAX_NOTES]]
    if len(notes) > MAX_NOTES:
        told.append(f"note     {len(notes) - MAX_NOTES} more in logs/player.log")
    return told


def played_line(summary):
    """`expected` is null where it is not known how many images there should have been."""
    sequence = summary.get("sequence", {})
    played = summary["frames"]["in"]
    expected = sequence.get("expected", played)
    end_missing = sequence.get("end_missing")
    line = f"played {played} of {'at least ' if end_missing else ''}"
    line += f"{'unknown' if expected is None else expected} images"
    reasons = [f"{count} skipped ({reason})" for reason, count in sequence.get("skipped", {}).items()]
    if end_missing:
        reasons.append(f"the rest skipped ({end_missing})")
    return line + (": " + ", ".join(reasons) if reasons else "")


def no_pose_line(summary):
    """None where every image has a pose, or it is not known."""
    reasons = {reason: count for reason, count in summary.get("no_pose", {}).items() if count > 0}
    if not reasons:
        return None
    listed = ", ".join(f"{count} {reason}" for reason, count in reasons.items())
    return f"no pose for {sum(reasons.values())} of {summary['frames']['in']} images: {listed}"


def coverage(summary, poses):
    """Poses as a share of the images that the sequence should have, not of those that were played."""
    return poses / max(expected(summary), 1)


def expected(summary):
    """Images that the sequence should have, as far as is known; those that were played, at least."""
    return max(summary.get("sequence", {}).get("expected") or 0, summary["frames"]["in"])
