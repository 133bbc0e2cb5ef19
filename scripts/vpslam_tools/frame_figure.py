"""A frame with its line clusters and tracked points (the paper's figure 4), from preview.jpg."""

from vpslam_tools.errors import UserError
from vpslam_tools.figure_style import STYLE, WIDTH_IN, pyplot, write

# As frontend/preview_painter.cpp paints them. Red, green and blue differ in lightness, too.
CLUSTERS = [("#ff3c3c", "first direction"), ("#3cdc3c", "second direction"),
            ("#3c6eff", "third direction"), ("#aaaaaa", "no direction")]
POINT = "#00ff00"


def frame_figure(preview, path, title=""):
    """Writes `path`.png and `path`.svg; returns the two paths."""
    plt = pyplot()
    try:
        image = plt.imread(preview)
    except (OSError, SyntaxError, ValueError) as error:  # as Pillow says that it is no picture
        raise UserError(f"{preview}: is no picture that can be read ({error}); repeat the run with "
                        "--preview") from None
    height, width = image.shape[:2]
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(figsize=(0.7 * WIDTH_IN, 0.7 * WIDTH_IN * height / width + 0.5),
                                    layout="constrained")
        axes.imshow(image, cmap="gray")
        axes.set_axis_off()
        lines = [plt.Line2D([], [], color=colour, linewidth=2, label=label)
                 for colour, label in CLUSTERS]
        points = plt.Line2D([], [], color=POINT, marker="s", fillstyle="none", linestyle="none",
                            markersize=5, label="tracked points")
        axes.legend(handles=lines + [points], loc="upper center", bbox_to_anchor=(0.5, 0), ncols=3)
        figure.suptitle(title, fontsize=9)
        return write(figure, path)
