"""The map of a run from three sides: points, line segments, keyframes and the path.

    map_figure(read_ply(out / "map.ply"), path_positions, out / "map", title="sim:room")
"""

from dataclasses import dataclass

import numpy as np

from vpslam_tools.errors import UserError
from vpslam_tools.figure_style import COLOURS, STYLE, WIDTH_IN, pyplot, write

KEYFRAME_RED = 200   # at least so much red, and at most half of it green: a keyframe, not a point
MARGINS_IN = (1.2, 1.1)  # of the figure: labels beside and below the views
MAX_HEIGHT_IN = 9.0
LEAST_SHARE = 0.2     # of the longest side, for the shortest
SHOWN_SHARE = 0.98   # of the points, in each direction; stray ones would shrink the rest to nothing


@dataclass
class PlyMap:
    """In units of the map, or in m once aligned."""
    points: np.ndarray      # (n, 3)
    keyframes: np.ndarray   # (n, 3)
    segments: np.ndarray    # (n, 2, 3), of map lines

    def moved(self, similarity):
        return PlyMap(similarity.apply(self.points), similarity.apply(self.keyframes),
                      similarity.apply(self.segments.reshape(-1, 3)).reshape(-1, 2, 3))


def read_ply(path):
    """map.ply as the recorder writes it: ASCII; vertices x y z red green blue, of which the red ones
    are keyframes; where there are lines, edges of two vertices."""
    try:
        lines = path.read_text().splitlines()
    except OSError as error:
        raise UserError(f"{path}: cannot be read ({error.strerror}); check the path") from None
    try:
        end = lines.index("end_header")
        if lines[:2] != ["ply", "format ascii 1.0"]:
            raise ValueError
        counts = {words[1]: int(words[2]) for words in map(str.split, lines[:end])
                  if words[0] == "element"}
        rows = [line.split() for line in lines[end + 1:]]
        vertices = np.array([row[:6] for row in rows[:counts["vertex"]]], float).reshape(-1, 6)
        edges = np.array([row[:2] for row in rows[counts["vertex"]:][:counts.get("edge", 0)]],
                         int).reshape(-1, 2)
        segments = vertices[edges][:, :, :3]
    except (ValueError, KeyError, IndexError):
        raise UserError(f"{path}: is no map of vpslam's; write one with `vpslam run`") from None
    positions, red, green = vertices[:, :3], vertices[:, 3], vertices[:, 4]
    is_keyframe = (red >= KEYFRAME_RED) & (green <= red / 2)
    is_end = np.isin(np.arange(len(vertices)), edges)
    return PlyMap(positions[~is_keyframe & ~is_end], positions[is_keyframe], segments)


def map_figure(ply_map, path_positions, path, title="", unit="m"):
    """From above, from the front (below it) and from the side (beside it), all to one scale, as in a
    technical drawing. path_positions: (n, 3) of the camera, in the frame of the map. Writes
    `path`.png and .svg."""
    spread = np.ptp(path_positions, axis=0)
    first, second = sorted(np.argsort(-spread, kind="stable")[:2])
    third = 3 - first - second
    low, high = _limits(ply_map, path_positions)
    size = high - low
    inch = (WIDTH_IN - MARGINS_IN[0]) / (size[first] + size[third])
    height_in = min(MAX_HEIGHT_IN, MARGINS_IN[1] + inch * (size[second] + size[third]))
    with pyplot().rc_context(STYLE):
        figure = pyplot().figure(figsize=(WIDTH_IN, height_in), layout="constrained")
        grid = figure.add_gridspec(2, 2, width_ratios=[size[first], size[third]],
                                   height_ratios=[size[second], size[third]])
        for cell, (right, up) in ((grid[0, 0], (first, second)), (grid[0, 1], (third, second)),
                                  (grid[1, 0], (first, third))):
            axes = figure.add_subplot(cell)
            _draw(axes, ply_map, path_positions, right, up)
            axes.set_xlim(low[right], high[right])
            axes.set_ylim(low[up], high[up])
            axes.set_aspect("equal", adjustable="box")
            axes.set_xlabel(f"{'xyz'[right]} ({unit})")
            axes.set_ylabel(f"{'xyz'[up]} ({unit})")
        corner = figure.add_subplot(grid[1, 1])
        corner.axis("off")
        corner.legend(*axes.get_legend_handles_labels(), loc="center", markerscale=3)
        figure.suptitle(title, fontsize=9)
        return write(figure, path)


def _limits(ply_map, path_positions):
    inner = path_positions
    if len(ply_map.points):
        cut = 50 * (1 - SHOWN_SHARE)
        inner = np.vstack([inner, np.percentile(ply_map.points, [cut, 100 - cut], axis=0)])
    low, high = inner.min(axis=0), inner.max(axis=0)
    # A flat map keeps some height.
    middle, half = (low + high) / 2, (high - low) / 2
    half = np.maximum(half, LEAST_SHARE * max(1e-9, float(np.max(half)))) * 1.05
    return middle - half, middle + half


def _draw(axes, ply_map, path_positions, right, up):
    points, keyframes = ply_map.points, ply_map.keyframes
    # Thousands of points as pixels within the SVG: as shapes they would make it slow.
    axes.plot(points[:, right], points[:, up], "o", color="#555555", markersize=0.7,
              markeredgewidth=0, rasterized=True, label=f"{len(points)} points")
    for index, segment in enumerate(ply_map.segments):
        axes.plot(segment[:, right], segment[:, up], color=COLOURS[2], linewidth=0.7,
                  label=f"{len(ply_map.segments)} lines" if index == 0 else None)
    axes.plot(path_positions[:, right], path_positions[:, up], color=COLOURS[0], linewidth=0.9,
              label="camera")
    axes.plot(keyframes[:, right], keyframes[:, up], "o", color=COLOURS[1], markersize=1.4,
              label=f"{len(keyframes)} keyframes")
