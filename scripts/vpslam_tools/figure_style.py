"""How all figures look, and how they are written: PNG for the screen, SVG for papers.

Drawn with matplotlib's Agg, which needs no display. Colours are those of Okabe and Ito ("Color
universal design", 2008), which people of any colour vision tell apart; lines differ in style, too.
"""

import pathlib

from vpslam_tools.errors import UserError

TRUTH_COLOUR = "#4d4d4d"
COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9"]
LINE_STYLES = ["-", "--", "-.", ":"]
WIDTH_IN = 7.2    # two columns of a paper
STYLE = {
    "font.family": "DejaVu Sans", "font.size": 8, "axes.titlesize": 8, "axes.labelsize": 8,
    "legend.fontsize": 7.5, "xtick.labelsize": 7, "ytick.labelsize": 7,
    "axes.spines.top": False, "axes.spines.right": False, "axes.linewidth": 0.6,
    "xtick.major.width": 0.6, "ytick.major.width": 0.6, "axes.grid": True, "grid.color": "#e5e5e5",
    "grid.linewidth": 0.5, "axes.axisbelow": True, "legend.frameon": False,
    "svg.fonttype": "none", "svg.hashsalt": "vpslam", "savefig.dpi": 200,
}


def pyplot():
    try:
        import matplotlib
    except ImportError:
        raise UserError("python3-matplotlib is missing; as root type: apt-get install "
                        "python3-matplotlib") from None
    matplotlib.use("Agg")
    from matplotlib import pyplot as module
    return module


def write(figure, path):
    """Writes `path`.png and `path`.svg and closes the figure; returns the two paths."""
    path = pathlib.Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    paths = [path.with_name(path.name + ending) for ending in (".png", ".svg")]
    for each in paths:
        # No date: the same figure is the same file.
        metadata = {"Date": None} if each.suffix == ".svg" else {"Software": "VP-SLAM"}
        figure.savefig(each, metadata=metadata)
    pyplot().close(figure)
    return paths


def colour(index):
    return COLOURS[index % len(COLOURS)]


def line_style(index):
    return LINE_STYLES[index % len(LINE_STYLES)]
