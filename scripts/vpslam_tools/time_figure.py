"""Histogram of frame times: how long a frame takes from image published to pose published."""

import numpy as np

from vpslam_tools.figure_style import STYLE, WIDTH_IN, colour, pyplot, write

BINS = 60
SHOWN_PERCENT = 99.0  # the tail beyond is counted in the last bin


def time_figure(total_ms_by_label, path, title="", interval_ms=None):
    """total_ms_by_label: {label: (n,) ms}. interval_ms: time between two images, drawn as a line.
    Writes `path`.png and `path`.svg."""
    pools = {label: np.asarray(values)[np.isfinite(values)]
             for label, values in total_ms_by_label.items()}
    pools = {label: values for label, values in pools.items() if len(values)}
    end_ms = max((float(np.percentile(values, SHOWN_PERCENT)) for values in pools.values()),
                 default=1.0)
    edges = np.linspace(0, max(end_ms, 1e-3), BINS + 1)
    with pyplot().rc_context(STYLE):
        figure, axes = pyplot().subplots(figsize=(0.6 * WIDTH_IN, 0.36 * WIDTH_IN),
                                         layout="constrained")
        for index, (label, values) in enumerate(pools.items()):
            median = float(np.median(values))
            axes.hist(np.minimum(values, edges[-1]), edges, color=colour(index), alpha=0.55,
                      label=f"{label}: median {median:.1f} ms, mean {np.mean(values):.1f} ms")
            axes.axvline(median, color=colour(index), linewidth=1.0)
        if interval_ms and interval_ms <= edges[-1]:
            axes.axvline(interval_ms, color="black", linestyle="--", linewidth=0.8,
                         label=f"between images: {interval_ms:.1f} ms")
        axes.set_xlim(0, edges[-1])
        axes.set_xlabel("image published to pose published (ms); last bin: and longer")
        axes.set_ylabel("frames")
        if pools:
            axes.legend(loc="upper right")
        figure.suptitle(title, fontsize=9)
        return write(figure, path)
