# SPDX-License-Identifier: MIT
"""What all pictures share: style, colours, titles, panels over time, and which times are shown."""
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import LogNorm, Normalize

from .request import request_of

plt.rcParams.update({"figure.dpi": 130, "savefig.dpi": 130, "font.size": 9, "axes.grid": False, "axes.titlesize": 9,
                     "figure.titlesize": 10, "axes.spines.top": False, "axes.spines.right": False, "legend.edgecolor": "none", "legend.framealpha": 0.8,
                     "savefig.format": "png", "svg.fonttype": "none", "pdf.fonttype": 42})

# Fields drawn in planes, in this order, with a perceptual map each.
FIELDS = {"speed": "viridis", "pressure": "cividis", "dissipation": "inferno", "vorticity": "RdBu_r",
          "enstrophy": "inferno"}
SIGNED = {"vorticity", "velocity_x", "velocity_y", "velocity_z", "vorticity_x", "vorticity_y", "vorticity_z"}
TITLE_ROOM = 0.28  # inches
SMALLEST_TITLE = 6  # points
SOLID = "#b9b4ab"
EDGE = "#55524d"


def fit_title(figure):
    """A title that is wider than its figure is set smaller, and cut at a word where that is not enough."""
    title = figure._suptitle
    if title is None:
        return
    room = 0.98 * figure.bbox.width
    width = lambda: title.get_window_extent(figure.canvas.get_renderer()).width
    if width() > room:
        title.set_fontsize(max(SMALLEST_TITLE, 0.95 * title.get_fontsize() * room / width()))  # steps of a letter are whole pixels
    words = title.get_text().split(" ")
    while width() > room and len(words) > 1:
        words.pop()
        title.set_text(" ".join(words) + " ...")


def keep_ticks(figure, axes):
    """Lays a figure out and keeps the ticks that this gives: their number would follow the layout, and the room that
    the layout keeps for their labels the ticks before it, so that labels ended beyond the edge."""
    figure.draw_without_rendering()
    for one in (one for axis in axes for one in (axis.xaxis, axis.yaxis)):
        low, high = sorted(one.get_view_interval())
        rounding = 1e-9 * (high - low)
        one.set_ticks([tick for tick in one.get_majorticklocs() if low - rounding <= tick <= high + rounding])


def finish(figure, path, title=None):
    """Writes a figure in the chosen format and returns the name of the file."""
    fixed = figure.get_constrained_layout() or getattr(figure, "exact", False)
    room = TITLE_ROOM / figure.get_figheight() if title else 0
    if title:
        figure.suptitle(title, **({} if fixed else {"y": 1 - 0.3 * room, "va": "top"}))
    if not fixed:
        figure.tight_layout()
    fit_title(figure)
    path = path.with_suffix("." + plt.rcParams["savefig.format"])
    figure.savefig(path)
    plt.close(figure)
    return path


def title_of(run):
    return run.case.get("title") if run.has("case.toml") else None


def time_title(time, si):
    """Above a panel; as long as the time, so that panels stay aligned."""
    return f"t = {time:.4g}" + (" s" if si else "")


def length_label(name, si):
    return f"{name} [m]" if si else name


def evenly(count, most=6):
    """Indices of at most `most` of `count` things, evenly spaced from first to last."""
    return np.unique(np.linspace(0, count - 1, min(most, count)).round().astype(int))


def chosen_steps(run, snapshots, most=6):
    """Indices of the snapshots nearest to the times asked for; without these, evenly spaced from first to last."""
    times = request_of(run).times
    if times:
        return np.unique([int(np.argmin(np.abs(snapshots.times - time))) for time in times])
    return evenly(len(snapshots), most)


def shades(items):
    """Pairs of an item and its colour, dark to light in their order."""
    return zip(items, plt.cm.viridis(np.linspace(0, 0.9, len(items))))


def panels_over_time(table, panels, decorate=None):
    """A figure with one panel per (label, values), at most three in a row; None when none of them holds a number.

    decorate(axis, label) adds to a panel. Positive values that are mostly small get a logarithmic axis.
    """
    panels = [(name, values) for name, values in panels if np.isfinite(values).any()]
    if not panels:
        return None
    columns = min(3, len(panels))
    rows = -(-len(panels) // columns)
    figure, axes = plt.subplots(rows, columns, figsize=(4.2 * columns, 2.8 * rows + 0.3), squeeze=False)
    for axis in axes.flat[len(panels):]:
        axis.remove()
    for axis, (name, values) in zip(axes.flat, panels):
        axis.plot(table["t"], values, linewidth=0.9)
        axis.set(xlabel=table.label("t"), ylabel=table.label(name))
        positive = values[np.isfinite(values) & (values > 0)]
        if len(positive) and np.nanmin(values) >= 0 and positive.max() > 300 * np.median(positive):
            axis.set_yscale("log")
        if decorate is not None:
            decorate(axis, name)
    return figure


def panel_grid(count, width, height):
    """Rows and columns of panels of the given aspect that fill about a 3:2 page."""
    shapes = [(-(-count // columns), columns) for columns in range(1, count + 1)]
    return min(shapes, key=lambda s: abs(np.log((s[1] * width) / (s[0] * height) / 1.5)) + 0.3 * (s[0] * s[1] - count))


def panel_size(rows, columns, width, height, page=(10.0, 7.0)):
    """Inches per unit of length, so that panels of width x height fill the page, whatever their shape."""
    return min(page[0] / columns / width, page[1] / rows / height)


def picture_axes(rows, widths, heights, size, title_room=0.3, below=0.0, right=0.1, title=None):
    """A figure with rows of pictures that fill their axes exactly, and these axes.

    widths: of the pictures of a row, heights: of the rows, in units of length; size: inches per unit; below: inches kept free under each,
    right: beside the last one; title_room: above each.
    """
    gap, head = 0.12, 0.35 if title else 0.05
    wide = sum(widths) * size + gap * len(widths) + right
    bands = np.asarray(heights) * size + title_room + below
    tall = np.sum(bands) + head
    figure = plt.figure(figsize=(wide, tall))
    figure.exact = True  # where its axes are is not to be changed
    axes = np.empty((rows, len(widths)), object)
    for row in range(rows):
        left = 0.5 * gap
        for column, width in enumerate(widths):
            bottom = tall - head - np.sum(bands[: row + 1]) + below
            axes[row, column] = figure.add_axes((left / wide, bottom / tall, width * size / wide, heights[row] * size / tall))
            axes[row, column].set_axis_off()
            left += width * size + gap
    if title:
        figure.suptitle(title, y=1 - 0.12 / tall, va="top")
    return figure, axes


def field_norm(name, samples, limits=None):
    """Colour limits shared by all panels: as asked for, or robust percentiles, so that one stray particle does not hide
    the rest."""
    if limits is not None:
        return Normalize(*limits)
    values = np.concatenate([np.ravel(s)[np.isfinite(np.ravel(s))] for s in samples])
    if not len(values):
        return Normalize(0, 1)
    low, high = np.percentile(values, [0.2, 99.8])
    if name in ("dissipation", "enstrophy") and high > 0:
        return LogNorm(max(high * 1e-4, 1e-300), high)
    if name == "speed":
        low = 0.0
    if name in SIGNED:
        high = max(abs(low), abs(high))
        low = -high
    if not high - low > 1e-12 * max(abs(low), abs(high)):  # one value: a scale about it, not one of its last digits
        high = low + 1
    return Normalize(low, high)


def extension(norm, samples):
    """The ends of a colour bar that values lie beyond, for its `extend`."""
    values = np.concatenate([np.ravel(s)[np.isfinite(np.ravel(s))] for s in samples])
    below, above = len(values) and values.min() < norm.vmin, len(values) and values.max() > norm.vmax
    return {(True, True): "both", (True, False): "min", (False, True): "max"}.get((bool(below), bool(above)), "neither")
