# SPDX-License-Identifier: MIT
"""What all pictures share: style, colours, panels over time, and which times are shown."""
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import LinearSegmentedColormap, LogNorm, Normalize

plt.rcParams.update({"figure.dpi": 130, "savefig.dpi": 130, "font.size": 9, "axes.grid": False,
                     "axes.spines.top": False, "axes.spines.right": False, "legend.frameon": False})

# Fields drawn as slices, in this order, with a perceptual map each.
FIELDS = {"speed": "viridis", "pressure": "cividis", "dissipation": "inferno", "vorticity": "RdBu_r",
          "enstrophy": "inferno"}
WATER = LinearSegmentedColormap.from_list("water", ["#06304d", "#0b5c7a", "#1f93a3", "#7fd0c8", "#f4fbf7"])


def finish(figure, path):
    if not figure.get_constrained_layout():
        figure.tight_layout()
    figure.savefig(path)
    plt.close(figure)
    return path


def evenly(count, most=6):
    """Indices of at most `most` of `count` things, evenly spaced from first to last."""
    return np.unique(np.linspace(0, count - 1, min(most, count)).round().astype(int))


def chosen_steps(run, snapshots, most=6):
    """Indices of the snapshots nearest to run.picture_times; without these, evenly spaced from first to last."""
    if run.picture_times:
        return np.unique([int(np.argmin(np.abs(snapshots.times - time))) for time in run.picture_times])
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
    figure, axes = plt.subplots(rows, columns, figsize=(4.2 * columns, 2.8 * rows), squeeze=False)
    for axis in axes.flat[len(panels):]:
        axis.remove()
    for axis, (name, values) in zip(axes.flat, panels):
        axis.plot(table["t"], values, linewidth=0.9)
        label = table.label(name)  # units in words are long
        axis.set(xlabel=table.label("t"), ylabel=label if len(label) < 34 else name.replace("_", " "))
        positive = values[np.isfinite(values) & (values > 0)]
        if len(positive) and np.nanmin(values) >= 0 and positive.max() > 300 * np.median(positive):
            axis.set_yscale("log")
        if decorate is not None:
            decorate(axis, name)
    return figure


def panel_grid(count, width, height):
    """Rows and columns of panels of the given aspect that fill about a 3:2 page."""
    shapes = [(-(-count // columns), columns) for columns in range(1, count + 1)]
    return min(shapes, key=lambda s: abs(np.log((s[1] * width) / (s[0] * height) / 1.5)) + 0.1 * (s[0] * s[1] - count))


def field_norm(name, samples):
    """Colour limits shared by all panels: robust percentiles, so that one stray particle does not hide the rest."""
    values = np.concatenate([s[np.isfinite(s)] for s in samples])
    if not len(values):
        return Normalize(0, 1)
    low, high = np.percentile(values, [0.5, 99.5])
    if name in ("dissipation", "enstrophy") and high > 0:
        return LogNorm(max(high * 1e-4, 1e-300), high)
    if name == "speed":
        low = 0.0
    if name == "vorticity":
        high = max(abs(low), abs(high))
        low = -high
    return Normalize(low, high if high > low else low + 1)


def plane_panels(times, low, high, draw, labels, colour_label, path):
    """Panels of one plane at several times, with one colour bar: draw(axis, index) returns what the bar is for.

    low, high: corners of the frame; labels: of its two axes.
    """
    width, height = high - low
    rows, columns = panel_grid(len(times), width, height)
    size = min(9.0 / columns / width, 7.0 / rows / height)
    figure, axes = plt.subplots(rows, columns, squeeze=False, sharex=True, sharey=True, constrained_layout=True,
                                figsize=(columns * width * size + 1.5, rows * (height * size + 0.35) + 0.5))
    for axis in axes.flat[len(times):]:
        axis.remove()
    for index, (axis, time) in enumerate(zip(axes.flat, times)):
        drawn = draw(axis, index)
        axis.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal", title=f"t = {time:.4g}")
    for axis in axes[-1, :]:
        axis.set_xlabel(labels[0])
    for axis in axes[:, 0]:
        axis.set_ylabel(labels[1])
    figure.colorbar(drawn, ax=[a for a in axes.flat if a.figure], label=colour_label, shrink=0.85, extend="max")
    return finish(figure, path)
