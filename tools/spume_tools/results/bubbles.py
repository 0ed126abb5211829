# SPDX-License-Identifier: MIT
"""Bubbles of a run: sizes relative to the Hinze radius, slopes of the size distribution, traces."""
import numpy as np

from .errors import MissingResult


def surface_tension(run):
    """Over the density of the liquid, 1/We in groups; MissingResult when the case gives none."""
    return _scale(run, "surface_tension_over_density")


def hinze_radius(run):
    """As the run used it; MissingResult when the case gives neither the radius nor a surface tension."""
    return _scale(run, "hinze_radius")


def _scale(run, name):
    value = run.derived(name)
    if value is None:
        raise MissingResult(f"{run.folder / 'summary.json'}: holds no derived.{name}; it is there for runs with bubbles "
                            "and surface tension")
    return float(value)


def bubble_radii(run, first, last=np.inf):
    """Radii over the Hinze radius of all bubbles in the snapshots from time `first` to `last`."""
    snapshots = run.snapshots("bubbles")
    chosen = [snapshots[k].field("radius") for k, t in enumerate(snapshots.times) if first <= t <= last]
    return np.concatenate(chosen) / hinze_radius(run) if chosen else np.empty(0)


def density(values, per_decade=10):
    """Centres, densities (integral one) and counts of the bins that hold something."""
    low, high = np.floor(np.log10(values.min()) * per_decade), np.ceil(np.log10(values.max()) * per_decade)
    edges = 10 ** (np.arange(low, high + 1.5) / per_decade)
    count, edges = np.histogram(values, edges)
    keep = count > 0
    return (np.sqrt(edges[1:] * edges[:-1])[keep], (count / np.diff(edges) / count.sum())[keep], count[keep])


def slope(values, low, high, least=20):
    """Exponent of the density between two radii: least squares on bins that hold at least `least`, weighted by the
    square root of their counts; nan where fewer than three do."""
    centre, value, count = density(values)
    keep = (centre >= low) & (centre <= high) & (count >= least)
    if keep.sum() < 3:
        return float("nan")
    return float(np.polyfit(np.log(centre[keep]), np.log(value[keep]), 1, w=np.sqrt(count[keep]))[0])


def bubble_traces(run):
    """Traces by identifier: tables of t, x, y, z, radius, slip in order of time."""
    table = run.table("bubble_traces")
    return {int(i): {name: table[name][table["id"] == i] for name in table} for i in np.unique(table["id"])}
