# SPDX-License-Identifier: MIT
"""What two runs differ in: options, cost, verdicts, and the columns of their tables."""
from dataclasses import dataclass

import numpy as np

from ..results import MissingResult

# Of a run as a whole, by key of summary.json: name, and how its value is written.
COST = (("method", "method", str), ("particles", "particles", "{:.0f}".format), ("steps", "steps", "{:.0f}".format),
        ("time", "end", "{:.6g}".format), ("threads", "threads", "{:.0f}".format),
        ("wall_seconds", "wall seconds", "{:.4g}".format),
        ("particle_steps_per_second", "particle-steps per second", "{:.4g}".format),
        ("peak_array_bytes_per_particle", "bytes per particle", "{:.0f}".format), ("commit", "commit", str))


def flattened(value, path=""):
    """The keys of a case as they are given to --set, with their values: {"liquid.0.where": ...}."""
    if isinstance(value, dict):
        return {k: v for key, inner in value.items() for k, v in flattened(inner, f"{path}.{key}" if path else key).items()}
    if isinstance(value, list) and value and all(isinstance(entry, dict) for entry in value):
        return {k: v for i, inner in enumerate(value) for k, v in flattened(inner, f"{path}.{i}").items()}
    return {path: value}


def differing_options(first, second):
    """(key, value, value) of every key that the resolved cases do not share, in the order of the first; None: not there."""
    a, b = flattened(first.case), flattened(second.case)
    return [(key, a.get(key), b.get(key)) for key in [*a, *(key for key in b if key not in a)] if a.get(key) != b.get(key)]


def costs(first, second):
    """(name, text, text) of what both summaries tell of the runs as a whole, core-seconds among them."""
    rows = []
    for key, name, write in COST:
        values = [run.summary.get(key) for run in (first, second)]
        if any(value is not None for value in values):
            rows.append((name, *("-" if value is None else write(value) for value in values)))
    spent = [[run.summary.get(key) for key in ("wall_seconds", "threads")] for run in (first, second)]
    if all(None not in pair for pair in spent):
        rows.append(("core-seconds", *(f"{wall * threads:.4g}" for wall, threads in spent)))
    return rows


def verdicts(first, second):
    """(quantity, word, word): what each run says of itself."""
    said = [{v["quantity"]: v["verdict"] for v in run.summary.get("verdicts", [])} for run in (first, second)]
    return [(name, said[0].get(name, "-"), said[1].get(name, "-")) for name in [*said[0], *(n for n in said[1] if n not in said[0])]]


@dataclass(frozen=True)
class Difference:
    """Of one column that both tables have, over the times that both cover."""

    name: str
    unit: str | None
    first: float  # at the last time of both
    second: float
    largest: float  # |second - first| anywhere in the times of the first
    at: float       # when
    scale: float    # largest size of the first


def compared(tables, ignored):
    """The differences of two tables by column, and the time up to which both go. The second is interpolated in time."""
    first, second = tables
    if not len(first) or not len(second):
        raise MissingResult(f"{(first if not len(first) else second).path}: holds no row")
    start, end = max(t["t"][0] for t in tables), min(t["t"][-1] for t in tables)
    if not start <= end:
        raise MissingResult(f"{first.path} and {second.path} have no time in common")
    # The last row of the run that ends first is no row of the other.
    times = np.unique(np.append(first["t"][(first["t"] >= start) & (first["t"] <= end)], end))
    found = []
    for name in first:
        if name == "t" or name in ignored or name not in second or first[name].dtype.kind != "f" or second[name].dtype.kind != "f":
            continue
        a, b = (np.interp(times, table["t"], table[name]) for table in tables)
        known = np.isfinite(a) & np.isfinite(b)
        if not known.any():
            continue
        apart = np.where(known, np.abs(b - a), -1)
        worst = int(np.argmax(apart))
        found.append(Difference(name, first.unit(name), float(a[known][-1]), float(b[known][-1]), float(apart[worst]),
                                float(times[worst]), float(np.abs(a[known]).max())))
    return found, end
