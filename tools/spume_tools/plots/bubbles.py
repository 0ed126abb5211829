# SPDX-License-Identifier: MIT
"""Pictures of bubbles: their history, sizes, places and traces."""
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import EllipseCollection, LineCollection
from matplotlib.colors import LogNorm

from ..results import MissingResult, hinze_radius, read_csv
from .planes import draw_particles
from .style import chosen_steps, evenly, field_norm, finish, shades


def has_bubbles(run):
    return "bubbles" in run.case


def plot_bubble_history(run, out):
    """Counts, volumes and rates over time."""
    if not has_bubbles(run):
        return []
    series = run.series
    t = series["t"]
    figure, axes = plt.subplots(1, 3, figsize=(13, 3.6))
    for name, label in (("bubbles_above_hinze", "above the Hinze radius"), ("bubbles_below_hinze", "below it"),
                        ("bubbles", "all")):
        if name in series:
            axes[0].plot(t, series[name], label=label)
    axes[0].set(xlabel=series.label("t"), ylabel="bubbles")
    for name, label in (("bubble_volume", "alive"), ("injected_volume", "injected"), ("entrained_volume", "entrained"),
                        ("burst_volume", "burst")):
        if np.nanmax(series[name], initial=0) > 0:
            axes[1].plot(t, series[name], label=label)
    axes[1].set(xlabel=series.label("t"), ylabel="volume of gas")
    # Rates from the cumulative columns over 50 equal spans: those of single steps are noise.
    span = np.linspace(t[0], t[-1], 51)
    middle = 0.5 * (span[1:] + span[:-1])
    for name, label in (("breakups", "breakup"), ("entrained_bubbles", "entrainment"), ("bursts", "bursting")):
        rate = np.diff(np.interp(span, t, series[name])) / np.diff(span)
        if rate.max() > 0:
            axes[2].plot(middle, rate, label=label)
    axes[2].set(xlabel=series.label("t"), ylabel="bubbles per time")
    for axis in axes:
        if axis.get_legend_handles_labels()[0]:
            axis.legend(fontsize=8)
    return [finish(figure, out / "bubbles.png")]


def plot_bubble_sizes(run, out):
    """Size distributions at up to five times, with the slopes of Deane & Stokes (2002)."""
    if not has_bubbles(run) or not run.has("bubble_sizes.csv"):
        return []
    sizes = read_csv(run.folder / "bubble_sizes.csv")
    times = [t for t in np.unique(sizes["t"]) if sizes["count"][sizes["t"] == t].sum() >= 100]
    if not times or len(np.unique(sizes["radius_over_hinze"])) < 4:
        return []
    figure, axis = plt.subplots(figsize=(5.6, 4.2))
    for time, colour in shades([times[k] for k in evenly(len(times), 5)]):
        rows = sizes["t"] == time
        axis.loglog(sizes["radius_over_hinze"][rows], sizes["density"][rows], "o-", markersize=3, linewidth=0.9,
                    color=colour, label=f"t = {time:.3g}, {int(sizes['count'][rows].sum())} bubbles")
    at_hinze = np.interp(0, np.log(sizes["radius_over_hinze"][rows]), sizes["density"][rows])
    below, above = np.array([0.1, 1]), np.array([1, 8])
    axis.loglog(below, at_hinze * below**-1.5, "k--", linewidth=1, label="slopes -3/2 and -10/3")
    axis.loglog(above, at_hinze * above ** (-10 / 3), "k--", linewidth=1)
    axis.set(xlabel="radius / Hinze radius", ylabel="density")
    axis.legend(fontsize=7)
    return [finish(figure, out / "bubble_sizes.png")]


def length_of_colours(run):
    """What radii are divided by where colours tell of them, and the words for it: the Hinze radius where there is one."""
    try:
        return hinze_radius(run), "radius / Hinze radius"
    except MissingResult:
        return 1.0, "radius"


def bubble_circles(axis, x, y, radius, cmap, norm, unit, least):
    """Bubbles as circles of their size, none smaller than `least` across, coloured by radius over `unit`."""
    order = np.argsort(radius)
    diameter = np.maximum(2 * radius[order], least)
    circles = EllipseCollection(diameter, diameter, np.zeros(len(order)), units="xy",
                                offsets=np.column_stack([x[order], y[order]]), transOffset=axis.transData, cmap=cmap,
                                norm=norm, linewidths=0.1, edgecolors="k")
    circles.set_array(radius[order] / unit)
    axis.add_collection(circles)
    return circles


def plot_bubble_views(run, out):
    """Up to five times from the side, over the liquid coloured by speed or dissipation, and from beneath."""
    if not has_bubbles(run) or not run.has("bubbles.vtkhdf"):
        return []
    bubbles, fluid = run.snapshots("bubbles"), run.snapshots()
    steps = chosen_steps(run, bubbles, most=5)
    unit, words = length_of_colours(run)
    lower, upper = run.bounds()
    shots = [bubbles[int(k)] for k in steps]
    radius = np.concatenate([shot.field("radius") for shot in shots]) / unit
    # Bubbles of one size get a scale about it, not one of their last digits.
    most = radius.max()
    least = max(radius.min(), 0.01 * most)
    margin = 1.001 if most > 1.5 * least else 2
    norm = LogNorm(least / margin, most * margin)
    name = "dissipation" if "dissipation" in fluid.names else "speed"
    liquids = [fluid.nearest(shot.time) for shot in shots]
    liquid_norm = field_norm(name, [liquid.field(name) for liquid in liquids])
    low = max(lower[2], min(shot.position[:, 2].min() for shot in shots) - 0.1)
    high = min(upper[2], max(np.percentile(liquid.position[:, 2], 99.98) for liquid in liquids) + 0.02)
    width, height, depth = upper[0] - lower[0], high - low, upper[1] - lower[1]
    scale = 5.5 / width
    figure, axes = plt.subplots(len(shots), 2, squeeze=False, constrained_layout=True,
                                figsize=(12.5, len(shots) * (scale * max(height, depth) + 0.45) + 0.4))
    for (side, beneath), shot, liquid in zip(axes, shots, liquids):
        near = np.abs(liquid.position[:, 1] - 0.5 * (lower[1] + upper[1])) <= 1.5 * run.spacing
        draw_particles(side, liquid.position[near, 0], liquid.position[near, 2], liquid.field(name)[near],
                       1.3 * run.spacing, "Blues", liquid_norm)
        for axis, k in ((side, 2), (beneath, 1)):
            circles = bubble_circles(axis, shot.position[:, 0], shot.position[:, k], shot.field("radius"), "inferno",
                                     norm, unit, 0.002 * width)
            axis.set(aspect="equal", xlim=(lower[0], upper[0]))
        side.set(ylim=(low, high), ylabel="z", title=f"t = {shot.time:.3g}, from the side")
        beneath.set(ylim=(lower[1], upper[1]), ylabel="y", title=f"{len(shot)} bubbles, from beneath")
    figure.colorbar(circles, ax=list(axes.flat), label=words, shrink=0.6)
    return [finish(figure, out / "bubble_views.png")]


def plot_bubble_traces(run, out):
    """Traces on distance from the axis of the domain and height, coloured by radius."""
    if not has_bubbles(run) or not run.has("bubble_traces.csv"):
        return []
    lower, upper = run.bounds()
    middle = 0.5 * (lower + upper)[:2]
    table = read_csv(run.folder / "bubble_traces.csv")
    lines, radius = [], []
    distance = np.hypot(table["x"] - middle[0], table["y"] - middle[1])
    for i in np.unique(table["id"])[:2000]:
        rows = table["id"] == i
        lines.append(np.column_stack([distance[rows], table["z"][rows]]))
        radius.append(np.mean(table["radius"][rows]))
    figure, axis = plt.subplots(figsize=(5.2, 5.6))
    collection = LineCollection(lines, array=np.array(radius), cmap="viridis", linewidths=0.6)
    axis.add_collection(collection)
    axis.autoscale()
    axis.set(xlabel="distance from the axis", ylabel="z")
    figure.colorbar(collection, label="radius")
    return [finish(figure, out / "bubble_traces.png")]


PICTURES = (plot_bubble_history, plot_bubble_sizes, plot_bubble_views, plot_bubble_traces)
