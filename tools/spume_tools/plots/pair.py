# SPDX-License-Identifier: MIT
"""Two runs beside each other: what their series, probes, lines and spectra have in common, and fields at equal times."""
import matplotlib.pyplot as plt
import numpy as np

from ..results import MissingResult
from ..results.units import field_label
from .bodies import extent_with_bodies
from .planes import draw_panel, drawn_fields, frame_of, panels_of
from .probes import file_stem, quantities_along
from .request import request_of
from .style import evenly, extension, field_norm, finish, keep_ticks, length_label, panel_size

COLOURS = ("C0", "C1")
IGNORED = {"step", "t", "retries"}


def names_of(first, second):
    """Short names of two runs: those of their folders, with as much of the path as tells them apart."""
    a, b = (run.folder.resolve() for run in (first, second))
    for count in range(1, 1 + max(len(a.parts), len(b.parts))):
        pair = ["/".join(path.parts[-count:]) for path in (a, b)]
        if pair[0] != pair[1]:
            return pair
    return ["first", "second"]


def over_time(first, second, tables, path, title, ignored=()):
    """One panel for each column that both tables have and that changes in one of them."""
    names = [name for name in tables[0] if name in tables[1] and name not in ignored and name != "t"
             and any(np.isfinite(table[name]).any() and np.nanmax(table[name]) > np.nanmin(table[name]) for table in tables)]
    if not names:
        return []
    columns = min(3, len(names))
    rows = -(-len(names) // columns)
    figure, axes = plt.subplots(rows, columns, figsize=(4.2 * columns, 2.7 * rows + 0.3), squeeze=False)
    for axis in axes.flat[len(names):]:
        axis.remove()
    for axis, name in zip(axes.flat, names):
        for table, label, colour, style in zip(tables, names_of(first, second), COLOURS, ("-", "--")):
            axis.plot(table["t"], table[name], style, color=colour, linewidth=1, label=label)
        axis.set(xlabel=tables[0].label("t"), ylabel=tables[0].label(name))
    axes.flat[0].legend(fontsize=8)
    return [finish(figure, path, title)]


def heading(first, second):
    titles = [run.case.get("title") for run in (first, second)]
    names = " and ".join(names_of(first, second))
    return f"{titles[0]}: {names}" if titles[0] == titles[1] else names


def plot_series(first, second, out):
    """Every quantity of both series over time."""
    return over_time(first, second, (first.series, second.series), out / "series.png", heading(first, second), IGNORED)


def plot_probes(first, second, out):
    """Every probe of both runs over time."""
    if not (first.has("probes.csv") and second.has("probes.csv")):
        return []
    return over_time(first, second, (first.probes, second.probes), out / "probes.png", heading(first, second))


def plot_lines(first, second, out):
    """Profiles along lines of both runs, each at the last time that both have."""
    if not (first.has("lines.csv") and second.has("lines.csv")):
        return []
    files = []
    for name in first.line_names():
        if name not in second.line_names():
            continue
        last = min(run.line_times(name)[-1] for run in (first, second))
        quantities = [q for q in quantities_along(first.lines) if q in second.lines]
        figure, axes = plt.subplots(1, len(quantities), figsize=(3.8 * len(quantities), 3.8), squeeze=False)
        for run, label, colour, style in zip((first, second), names_of(first, second), COLOURS, ("-", "--")):
            times = run.line_times(name)
            index = int(np.argmin(np.abs(times - last)))
            profile = run.line(name, index)
            for axis, quantity in zip(axes.flat, quantities):
                axis.plot(profile["s"], profile[quantity], style, color=colour, label=f"{label}, t = {times[index]:.4g}")
                axis.set(xlabel=f"distance along {name}", ylabel=first.lines.label(quantity))
        axes.flat[0].legend(fontsize=8)
        files.append(finish(figure, out / f"line_{file_stem(name)}.png", heading(first, second)))
    return files


def plot_spectra(first, second, out):
    """Energy spectra, each at the last time that both have."""
    if not (first.has("spectrum.csv") and second.has("spectrum.csv")):
        return []
    last = min(run.spectrum["t"].max() for run in (first, second))
    figure, axis = plt.subplots(figsize=(5.4, 4.4))
    for run, label, colour, style in zip((first, second), names_of(first, second), COLOURS, ("-", "--")):
        spectrum = run.spectrum
        times = np.unique(spectrum["t"])
        time = times[np.argmin(np.abs(times - last))]
        rows = (spectrum["t"] == time) & (spectrum["wavenumber"] > 0) & (spectrum["energy"] > 0)
        axis.loglog(spectrum["wavenumber"][rows], spectrum["energy"][rows], style, color=colour, label=f"{label}, t = {time:.4g}")
    axis.set(xlabel=first.spectrum.label("wavenumber"), ylabel=first.spectrum.label("energy"))
    axis.legend(fontsize=8)
    return [finish(figure, out / "spectrum.png", heading(first, second))]


def plot_fields(first, second, out):
    """Fields in a plane at up to three times that both runs reach, one run above the other, in the same colours."""
    snapshots = [run.snapshots() for run in (first, second)]
    if first.dimensions != second.dimensions:
        raise MissingResult("one run is two-dimensional and the other three-dimensional")
    reached = min(s.times[-1] for s in snapshots)
    common = snapshots[0].times[snapshots[0].times <= reached + 1e-9]
    times = request_of(first).times or common[evenly(len(common), 3)]
    steps = [[int(np.argmin(np.abs(s.times - time))) for time in times] for s in snapshots]
    files = []
    for name in drawn_fields(first, snapshots[0]):
        if name not in drawn_fields(second, snapshots[1]):
            continue
        drawn = [panels_of(run, name, s, k) for run, s, k in zip((first, second), snapshots, steps)]
        samples = [panel.values for _, panels in drawn for panel in panels]
        norm = field_norm(name, samples, request_of(first).ranges.get(name))
        frames = [extent_with_bodies(run, plane, [panel.time for panel in panels], frame_of(panels))
                  for run, (plane, panels) in zip((first, second), drawn)]
        sizes = [(f[1] - f[0], f[3] - f[2]) for f in frames]
        size = panel_size(2, len(times), max(w for w, _ in sizes), max(h for _, h in sizes))
        figure, axes = plt.subplots(2, len(times), squeeze=False, constrained_layout=True,
                                    gridspec_kw={"height_ratios": [h for _, h in sizes]},
                                    figsize=(len(times) * sizes[0][0] * size + 1.6, sum(h for _, h in sizes) * size + 1.8))
        for row, run, (plane, panels), frame, label in zip(axes, (first, second), drawn, frames, names_of(first, second)):
            for axis, panel in zip(row, panels):
                image = draw_panel(axis, run, plane, panel, frame, name, norm)
                axis.set_xlabel(length_label("xyz"[plane.axes[0]], run.si))
            row[0].set_ylabel(f"{label}\n{length_label('xyz'[plane.axes[1]], run.si)}")
        figure.colorbar(image, ax=list(axes.flat), label=field_label(name, first.si), extend=extension(norm, samples), aspect=30)
        keep_ticks(figure, axes.flat)
        files.append(finish(figure, out / f"{name}.png", heading(first, second)))
    return files


PICTURES = (plot_series, plot_probes, plot_lines, plot_spectra, plot_fields)
