# SPDX-License-Identifier: MIT
"""Pictures of bubbles: their history, sizes and traces."""
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import LineCollection

from .style import evenly, finish, length_label, shades, title_of


def has_bubbles(run):
    return "bubbles" in run.case


def plot_bubble_history(run, out):
    """Counts, volumes and rates over time."""
    if not has_bubbles(run):
        return []
    series = run.series
    t = series["t"]
    figure, axes = plt.subplots(1, 3, figsize=(13, 3.9))
    for name, label in (("bubbles_above_hinze", "above the Hinze radius"), ("bubbles_below_hinze", "below it"),
                        ("bubbles", "all")):
        if name in series:
            axes[0].plot(t, series[name], label=label)
    axes[0].set(xlabel=series.label("t"), ylabel="bubbles")
    for name, label in (("bubble_volume", "alive"), ("injected_volume", "injected"), ("entrained_volume", "entrained"),
                        ("burst_volume", "burst")):
        if np.nanmax(series[name], initial=0) > 0:
            axes[1].plot(t, series[name], label=label)
    axes[1].set(xlabel=series.label("t"), ylabel="volume of gas" + (" [m³]" if run.si else ""))
    # Rates from the cumulative columns over 50 equal spans: those of single steps are noise.
    span = np.linspace(t[0], t[-1], 51)
    middle = 0.5 * (span[1:] + span[:-1])
    for name, label in (("breakups", "breakup"), ("entrained_bubbles", "entrainment"), ("bursts", "bursting")):
        rate = np.diff(np.interp(span, t, series[name])) / np.diff(span)
        if rate.max() > 0:
            axes[2].plot(middle, rate, label=label)
    axes[2].set(xlabel=series.label("t"), ylabel="events per time" + (" [1/s]" if run.si else ""))
    for axis in axes:
        if axis.get_legend_handles_labels()[0]:
            axis.legend(fontsize=8)
    return [finish(figure, out / "bubbles.png", title_of(run))]


def plot_bubble_sizes(run, out):
    """Size distributions at up to five times, with the slopes of Deane & Stokes (2002)."""
    if not has_bubbles(run) or not run.has("bubble_sizes.csv"):
        return []
    sizes = run.table("bubble_sizes")
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
    axis.set(xlabel="radius / Hinze radius", ylabel="probability density")
    axis.legend(fontsize=7)
    return [finish(figure, out / "bubble_sizes.png", title_of(run))]


def plot_bubble_traces(run, out):
    """Traces on distance from the axis of the domain and height, coloured by radius."""
    if not has_bubbles(run) or not run.has("bubble_traces.csv"):
        return []
    lower, upper = run.bounds()
    middle = 0.5 * (lower + upper)[:2]
    table = run.table("bubble_traces")
    lines, radius = [], []
    distance = np.hypot(table["x"] - middle[0], table["y"] - middle[1])
    for i in np.unique(table["id"])[:2000]:
        rows = table["id"] == i
        lines.append(np.column_stack([distance[rows], table["z"][rows]]))
        radius.append(np.mean(table["radius"][rows]))
    if not lines:
        return []
    radius = np.array(radius)
    several = radius.max() > 1.05 * radius.min()
    figure, axis = plt.subplots(figsize=(5.6, 5.6))
    # Many lines in one place are told apart by what shines through.
    look = {"array": radius, "cmap": "viridis"} if several else {"colors": "C0"}
    collection = LineCollection(lines, linewidths=0.5, alpha=min(1.0, 150 / len(lines)), **look)
    axis.add_collection(collection)
    axis.autoscale()
    axis.set(xlabel=length_label("distance from the axis", run.si), ylabel=length_label("z", run.si))
    if several:
        bar = figure.colorbar(collection, label=length_label("radius", run.si))
        bar.solids.set_alpha(1)
    else:
        axis.set_title(f"radius {radius[0]:.4g}" + (" m" if run.si else ""))
    return [finish(figure, out / "bubble_traces.png", title_of(run))]


PICTURES = (plot_bubble_history, plot_bubble_sizes, plot_bubble_traces)
