# SPDX-License-Identifier: MIT
"""What probes saw: their values over time, and profiles along lines."""
import matplotlib.pyplot as plt
import numpy as np

from .style import evenly, finish, shades, time_title, title_of


def asks_for_probes(case, lines):
    """Whether the case has a probe that is a line, or one that is not."""
    return any((probe.get("kind") == "line") == lines for probe in case.get("probe", []))


def quantities_of(probes):
    """Columns that hold a number anywhere, as (name of the probe, name of the column), by their quantity."""
    groups = {}
    for name in probes:
        if name == "t" or not np.isfinite(probes[name]).any():
            continue
        for suffix in ("_pressure", "_velocity_x", "_velocity_y", "_velocity_z", "_area"):
            if name.endswith(suffix):
                groups.setdefault(suffix[1:].replace("_", " "), []).append((name[: -len(suffix)], name))
                break
        else:
            groups.setdefault("elevation, wetted length, front", []).append((name, name))
    return groups


def plot_probes(run, out):
    """Every probe against time, one panel per quantity."""
    if not run.has("probes.csv") and not asks_for_probes(run.case, lines=False):
        return []
    probes = run.probes
    groups = quantities_of(probes)
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
        quantities = [q for q in ("velocity_x", "velocity_y", "velocity_z", "pressure") if q in run.lines]
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
