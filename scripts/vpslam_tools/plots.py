"""Figures of trajectories: against the truth from above and from the side, and the error over time.

    trajectory_figure(truth, {"VP-SLAM": estimate}, out / "trajectory", title="sim:room")
    path_figure({"VP-SLAM": estimate}, out / "trajectory", title="my camera")  # without truth
"""

import numpy as np

from vpslam_tools import evaluation, trajectory
from vpslam_tools.alignment import align
from vpslam_tools.errors import UserError
from vpslam_tools.figure_style import STYLE, TRUTH_COLOUR, WIDTH_IN, colour, line_style, pyplot, write

GAP_S = 0.5          # a longer time without a pose is drawn as a gap
LEAST_SHARE = 0.3    # height of a flat view, of the largest extent


def trajectory_figure(truth, estimates, path, title="", with_scale=True):
    """Writes `path`.png and `path`.svg: the trajectories and the truth from above and from the side,
    and the distance from the truth over time.

    truth: Trajectory, m. estimates: {label: Trajectory}; each is aligned with the truth, by a
    similarity (with_scale) or rigidly. Returns the two paths.
    """
    aligned = {label: _align(poses, truth, with_scale) for label, poses in estimates.items()}
    first, second = _plane(truth.positions)
    third = 3 - first - second
    with pyplot().rc_context(STYLE):
        figure = pyplot().figure(figsize=(WIDTH_IN, 0.72 * WIDTH_IN), layout="constrained")
        grid = figure.add_gridspec(2, 2, height_ratios=[1.25, 1])
        above, side = (figure.add_subplot(grid[0, column]) for column in (0, 1))
        _draw_view(above, truth, aligned, (first, second), "trajectory, from above")
        _draw_view(side, truth, aligned, (first, third), "from the side")
        above.legend(loc="best", handlelength=2.2)
        _draw_error(figure.add_subplot(grid[1, :]), truth, aligned)
        if title:
            figure.suptitle(title, fontsize=9)
        return write(figure, path)


def path_figure(estimates, path, title=""):
    """As trajectory_figure, where no truth is known: each estimate in the frame and units of its map.
    """
    shown = {label: (poses.positions, poses.stamps_s) for label, poses in estimates.items()}
    first, second = _plane(np.vstack([positions for positions, _ in shown.values()]))
    third = 3 - first - second
    with pyplot().rc_context(STYLE):
        figure, views = pyplot().subplots(1, 2, figsize=(WIDTH_IN, 0.45 * WIDTH_IN),
                                          layout="constrained")
        for axes, axes_shown, name in ((views[0], (first, second), "trajectory, from above"),
                                       (views[1], (first, third), "from the side")):
            _draw_paths(axes, shown, axes_shown)
            positions = next(iter(shown.values()))[0]
            _mark_ends(axes, positions[0], positions[-1], axes_shown)
            _set_limits(axes, [positions for positions, _ in shown.values()], axes_shown,
                        "units of the map", name)
        views[0].legend(loc="best", handlelength=2.2)
        if title:
            figure.suptitle(title, fontsize=9)
        return write(figure, path)


def _align(poses, truth, with_scale):
    """(all positions in the truth's frame, times and errors in m of those that have a truth)"""
    paired, paired_truth = trajectory.associate(poses, truth, evaluation.MAX_DIFFERENCE_S)
    if len(paired) < 3:
        raise UserError(f"only {len(paired)} poses have a truth near in time; nothing to draw")
    similarity = align(paired.positions, paired_truth.positions, with_scale)
    error_m = np.linalg.norm(similarity.apply(paired.positions) - paired_truth.positions, axis=1)
    return similarity.apply(poses.positions), poses.stamps_s, paired.stamps_s, error_m


def _plane(positions):
    """The two axes along which most happens, which is from above where a camera is carried or
    driven about: x and y of a world with z up, x and z of a camera's."""
    spread = np.ptp(positions, axis=0)
    return sorted(np.argsort(-spread, kind="stable")[:2])


def _limits(low, high, largest):
    """With a margin; a flat view keeps some height."""
    middle, half = (low + high) / 2, max(0.5 * (high - low), LEAST_SHARE * largest / 2)
    half += 0.05 * largest
    return middle - half, middle + half


def _with_gaps(stamps_s, values):
    """NaN where poses are missing, so that no line is drawn across."""
    gaps = np.flatnonzero(np.diff(stamps_s) > GAP_S) + 1
    return np.insert(stamps_s, gaps, np.nan), np.insert(values.astype(float), gaps, np.nan, axis=0)


def _draw_view(axes, truth, aligned, axes_shown, title):
    first, second = axes_shown
    _, positions = _with_gaps(truth.stamps_s, truth.positions)
    axes.plot(positions[:, first], positions[:, second], color=TRUTH_COLOUR, linewidth=2.4,
              alpha=0.45, label="truth", solid_capstyle="round")
    shown = {label: (positions, stamps_s) for label, (positions, stamps_s, _, _) in aligned.items()}
    _draw_paths(axes, shown, axes_shown)
    _mark_ends(axes, truth.positions[0], truth.positions[-1], axes_shown)
    _set_limits(axes, [truth.positions] + [positions for positions, _ in shown.values()],
                axes_shown, "m", title)


def _draw_paths(axes, shown, axes_shown):
    """shown: {label: (positions, times)}"""
    first, second = axes_shown
    for index, (label, (all_positions, stamps_s)) in enumerate(shown.items()):
        _, positions = _with_gaps(stamps_s, all_positions)
        axes.plot(positions[:, first], positions[:, second], color=colour(index),
                  linestyle=line_style(index), linewidth=1.0, label=label)


def _mark_ends(axes, start, end, axes_shown):
    first, second = axes_shown
    axes.plot(start[first], start[second], "o", color="black", markersize=4, label="start")
    axes.plot(end[first], end[second], "s", color="black", markersize=4, markerfacecolor="white",
              label="end")


def _set_limits(axes, positions, axes_shown, unit, title):
    first, second = axes_shown
    shown = np.vstack(positions)
    low, high = shown.min(axis=0), shown.max(axis=0)
    largest = max(1e-9, float(np.max(high - low)))
    axes.set_xlim(*_limits(low[first], high[first], largest))
    axes.set_ylim(*_limits(low[second], high[second], largest))
    axes.set_aspect("equal", adjustable="box")
    axes.set_xlabel(f"{'xyz'[first]} ({unit})")
    axes.set_ylabel(f"{'xyz'[second]} ({unit})")
    axes.set_title(title, loc="left")


def _draw_error(axes, truth, aligned):
    begin_s = truth.stamps_s[0]
    for index, (label, (_, _, stamps_s, error_m)) in enumerate(aligned.items()):
        times, errors = _with_gaps(stamps_s - begin_s, error_m)
        rmse = float(np.sqrt(np.mean(error_m ** 2)))
        axes.plot(times, errors, color=colour(index), linewidth=1.0,
                  linestyle=line_style(index), label=f"{label}: ATE {rmse:.4f} m (rmse)")
        axes.axhline(rmse, color=colour(index), linewidth=0.6, alpha=0.6)
    axes.set_xlim(0, truth.stamps_s[-1] - begin_s)
    axes.set_ylim(bottom=0)
    axes.set_xlabel("time (s)")
    axes.set_ylabel("distance from the truth (m)")
    axes.set_title("absolute trajectory error", loc="left")
    axes.legend(loc="upper left")


def path_length_m(poses):
    return float(np.sum(np.linalg.norm(np.diff(poses.positions, axis=0), axis=1)))
