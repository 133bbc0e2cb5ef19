"""Figures of trajectories, as PNG for the screen and SVG for papers.

    trajectory_figure(truth, {"VP-SLAM": estimate}, out / "trajectory", title="sim:room")

Drawn with matplotlib's Agg, which needs no display. Colours are those of Okabe and Ito ("Color
universal design", 2008), which people of any colour vision tell apart; lines differ in style, too.
"""

import pathlib

import numpy as np

from vpslam_tools import evaluation, trajectory
from vpslam_tools.alignment import align
from vpslam_tools.errors import UserError

TRUTH_COLOUR = "#4d4d4d"
COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9"]
LINE_STYLES = ["-", "--", "-.", ":"]
GAP_S = 0.5       # a longer time without a pose is drawn as a gap
WIDTH_IN = 7.2    # two columns of a paper
STYLE = {
    "font.family": "DejaVu Sans", "font.size": 8, "axes.titlesize": 8, "axes.labelsize": 8,
    "legend.fontsize": 7.5, "xtick.labelsize": 7, "ytick.labelsize": 7,
    "axes.spines.top": False, "axes.spines.right": False, "axes.linewidth": 0.6,
    "xtick.major.width": 0.6, "ytick.major.width": 0.6, "axes.grid": True, "grid.color": "#e5e5e5",
    "grid.linewidth": 0.5, "axes.axisbelow": True, "legend.frameon": False,
    "svg.fonttype": "none", "svg.hashsalt": "vpslam", "savefig.dpi": 200,
}


def _pyplot():
    try:
        import matplotlib
    except ImportError:
        raise UserError("python3-matplotlib is missing; as root type: apt-get install "
                        "python3-matplotlib") from None
    matplotlib.use("Agg")
    from matplotlib import pyplot
    return pyplot


def trajectory_figure(truth, estimates, path, title="", with_scale=True):
    """Writes `path`.png and `path`.svg: the trajectories from above beside the truth, and the
    distance from the truth over time.

    truth: Trajectory, m. estimates: {label: Trajectory}; each is aligned with the truth, by a
    similarity (with_scale) or rigidly. Returns the two paths.
    """
    pyplot = _pyplot()
    path = pathlib.Path(path)
    aligned = {label: _align(poses, truth, with_scale) for label, poses in estimates.items()}
    axes_shown = _plane(truth.positions)
    with pyplot.rc_context(STYLE):
        figure, (plan, error) = pyplot.subplots(
            1, 2, figsize=(WIDTH_IN, 0.46 * WIDTH_IN), layout="constrained",
            gridspec_kw={"width_ratios": [1.0, 1.0]})
        _draw_plan(plan, truth, aligned, axes_shown)
        _draw_error(error, truth, aligned)
        if title:
            figure.suptitle(title, fontsize=9)
        paths = [path.with_name(path.name + ending) for ending in (".png", ".svg")]
        for each in paths:
            # No date: the same figure is the same file.
            metadata = {"Date": None} if each.suffix == ".svg" else {"Software": "VP-SLAM"}
            figure.savefig(each, metadata=metadata)
        pyplot.close(figure)
    return paths


def _align(poses, truth, with_scale):
    """(all positions in the truth's frame, times and errors in m of those that have a truth)"""
    paired, paired_truth = trajectory.associate(poses, truth, evaluation.MAX_DIFFERENCE_S)
    if len(paired) < 3:
        raise UserError(f"only {len(paired)} poses have a truth near in time; nothing to draw")
    similarity = align(paired.positions, paired_truth.positions, with_scale)
    error_m = np.linalg.norm(similarity.apply(paired.positions) - paired_truth.positions, axis=1)
    return similarity.apply(poses.positions), poses.stamps_s, paired.stamps_s, error_m


def _plane(positions):
    """The two axes along which most happens: x and y of a world with z up, x and z of a camera's."""
    spread = np.ptp(positions, axis=0)
    return sorted(np.argsort(-spread, kind="stable")[:2])


def _with_gaps(stamps_s, values):
    """NaN where poses are missing, so that no line is drawn across."""
    gaps = np.flatnonzero(np.diff(stamps_s) > GAP_S) + 1
    return np.insert(stamps_s, gaps, np.nan), np.insert(values.astype(float), gaps, np.nan, axis=0)


def _draw_plan(axes, truth, aligned, axes_shown):
    first, second = axes_shown
    _, positions = _with_gaps(truth.stamps_s, truth.positions)
    axes.plot(positions[:, first], positions[:, second], color=TRUTH_COLOUR, linewidth=2.4,
              alpha=0.45, label="truth", solid_capstyle="round")
    for index, (label, (all_positions, stamps_s, _, _)) in enumerate(aligned.items()):
        _, positions = _with_gaps(stamps_s, all_positions)
        axes.plot(positions[:, first], positions[:, second], color=COLOURS[index % len(COLOURS)],
                  linestyle=LINE_STYLES[index % len(LINE_STYLES)], linewidth=1.0, label=label)
    start, end = truth.positions[0], truth.positions[-1]
    axes.plot(start[first], start[second], "o", color="black", markersize=4, label="start")
    axes.plot(end[first], end[second], "s", color="black", markersize=4, markerfacecolor="white",
              label="end")
    axes.set_aspect("equal", adjustable="datalim")
    axes.margins(0.08)
    axes.set_xlabel(f"{'xyz'[first]} (m)")
    axes.set_ylabel(f"{'xyz'[second]} (m)")
    axes.set_title("trajectory", loc="left")
    axes.legend(loc="best", handlelength=2.2)


def _draw_error(axes, truth, aligned):
    begin_s = truth.stamps_s[0]
    for index, (label, (_, _, stamps_s, error_m)) in enumerate(aligned.items()):
        times, errors = _with_gaps(stamps_s - begin_s, error_m)
        rmse = float(np.sqrt(np.mean(error_m ** 2)))
        colour = COLOURS[index % len(COLOURS)]
        axes.plot(times, 1000 * errors, color=colour, linewidth=1.0,
                  linestyle=LINE_STYLES[index % len(LINE_STYLES)],
                  label=f"{label}: ATE {1000 * rmse:.1f} mm (rmse)")
        axes.axhline(1000 * rmse, color=colour, linewidth=0.6, alpha=0.6)
    axes.set_xlim(0, truth.stamps_s[-1] - begin_s)
    axes.set_ylim(bottom=0)
    axes.set_xlabel("time (s)")
    axes.set_ylabel("distance from the truth (mm)")
    axes.set_title("absolute trajectory error", loc="left")
    axes.legend(loc="upper left")


def path_length_m(poses):
    return float(np.sum(np.linalg.norm(np.diff(poses.positions, axis=0), axis=1)))
