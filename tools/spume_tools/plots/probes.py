# SPDX-License-Identifier: MIT
"""What probes saw: their values over time, and profiles along lines."""
import matplotlib.pyplot as plt
import numpy as np

from .style import evenly, finish, shades, time_title, title_of


QUANTITIES = ("_pressure", "_velocity_x", "_velocity_y", "_velocity_z", "_area")


def quantities_along(lines):
    """Columns of profiles that are quantities: not the time, the name or the place."""
    return [name for name in lines if name not in ("t", "name", "s", "x", "y", "z")]


def asks_for_probes(case, lines):
    """Whether the case has a probe that is a line, or one that is not."""
    return any((probe.get("kind") == "line") == lines for probe in case.get("probe", []))


def quantities_of(probes, names=()):
    """Columns that hold a number anywhere, as (name of the probe, name of the column), by their quantity.

    names: of the probes of the case; a column is that of a probe, or begins with it. Without a name that fits, the last
    part of the column that is a known quantity is taken for it.
    """
    groups = {}
    for column in probes:
        if column == "t" or not np.isfinite(probes[column]).any():
            continue
        owner = max((name for name in names if column == name or column.startswith(name + "_")), key=len, default=None)
        if owner is None:
            suffix = next((suffix for suffix in QUANTITIES if column.endswith(suffix)), "")
            owner = column[: len(column) - len(suffix)]
        quantity = column[len(owner) + 1:].replace("_", " ") or "elevation, wetted length, front"
        groups.setdefault(quantity, []).append((owner, column))
    return groups


def plot_probes(run, out):
    """Every probe against time, one panel per quantity."""
    if not run.has("probes.csv") and not asks_for_probes(run.case, lines=False):
        return []
    probes = run.probes
    names = [probe.get("name", "") for probe in run.case.get("probe", [])] if run.has("case.toml") else []
    groups = quantities_of(probes, names)
    if not groups:
        return []
    figure, axes = plt.subplots(len(groups), 1, figsize=(6.8, 2.4 * len(groups) + 0.3), squeeze=False, sharex=True)
    for axis, (quantity, members) in zip(axes.flat, groups.items()):
        for label, name in members:
            axis.plot(probes["t"], probes[name], linewidth=1, label=label)
        unit = probes.unit(members[0][1])
        axis.set(ylabel=quantity + (f" [{unit}]" if unit else ""))
        axis.legend(fontsize=8, loc="center left", bbox_to_anchor=(1.0, 0.5))
    axes.flat[-1].set_xlabel(probes.label("t"))
    return [finish(figure, out / "probes.png", title_of(run))]


def file_stem(name):
    """The name of a probe as part of a file name."""
    return "".join(c if c.isalnum() or c in "-_." else "_" for c in name)


def plot_lines(run, out):
    """Profiles along every line probe at up to six times."""
    if not run.has("lines.csv") and not asks_for_probes(run.case, lines=True):
        return []
    files = []
    for name in run.line_names():
        times = run.line_times(name)
        quantities = quantities_along(run.lines)
        figure, axes = plt.subplots(1, len(quantities), figsize=(3.8 * len(quantities), 3.6), squeeze=False)
        for index, colour in shades(evenly(len(times))):
            profile = run.line(name, index)
            for axis, quantity in zip(axes.flat, quantities):
                axis.plot(profile["s"], profile[quantity], color=colour, label=time_title(times[index], run.si))
                axis.set(xlabel=run.lines.label("s").replace("s", f"distance along {name}", 1), ylabel=run.lines.label(quantity))
        axes.flat[0].legend(fontsize=8)
        files.append(finish(figure, out / f"line_{file_stem(name)}.png", title_of(run)))
    return files


PICTURES = (plot_probes, plot_lines)
