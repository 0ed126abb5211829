# SPDX-License-Identifier: MIT
"""Normalised root mean squares of the errors of discrete Laplacians of Franke's function, Joubert et al. (27), over the
particles of the unit square."""
from pathlib import Path

import numpy as np
from spume_tools.results import read_reference

REFERENCE = Path(__file__).parent / "reference" / "franke_laplacian_rmse_regular.csv"
FORMS = ("gfd", "sph")
# The sum of SPH at 161 a side is a lattice's only to 1e-4 spacings, less than single precision of the positions.
LARGEST_OF_TABLE = {"gfd": 161, "sph": 81}


def laplacian(x, y):
    def bump(c, a, p, q):
        s, t = 9 * x - p, 9 * y - q
        return c * np.exp(-a * (s**2 + t**2)) * 81 * (4 * a**2 * (s**2 + t**2) - 4 * a)
    s = 9 * x + 1
    second = 0.75 * np.exp(-s**2 / 49 - (9 * y + 1) / 10) * ((18 * s / 49)**2 - 162 / 49 + 0.81)
    return bump(0.75, 0.25, 2, 2) + second + bump(0.5, 0.25, 7, 3) - bump(0.2, 1, 4, 7)


def error(run):
    first = next(iter(run.snapshots()))
    spacing = float(run.case["resolution"]["spacing"])
    x, y = first.position[:, 0], first.position[:, 1]
    inside = np.all((first.position[:, :2] > -0.4 * spacing) & (first.position[:, :2] < 1 + 0.4 * spacing), axis=1)
    exact = laplacian(x[inside], y[inside])
    return float(np.sqrt(np.sum((first.field("diffusion")[inside, 0] - exact)**2) / np.sum(exact**2)))


def measure(runs):
    errors = {name: error(run) for name, run in runs.items()}
    measured = {f"{name}_error": value for name, value in errors.items()}
    table = read_reference(REFERENCE, ("n", "rmse_gfd", "rmse_sph"))
    for form in FORMS:
        known = {int(n): value for n, value in zip(table["n"], table[f"rmse_{form}"]) if n <= LARGEST_OF_TABLE[form]}
        differences = [abs(errors[f"{form}_{n}"] / value - 1) for n, value in known.items() if f"{form}_{n}" in errors]
        if differences:
            measured[f"{form}_against_table"] = max(differences)
        for end in ("", "_jittered"):
            pair = [errors.get(f"{form}_{n}{end}") for n in (81, 161)]
            if None not in pair:
                measured[f"{form}{end}_order"] = float(np.log2(pair[0] / pair[1]))
    if "gfd_161_jittered" in errors:
        measured["gfd_jittered_floor"] = errors["gfd_161_jittered"]
    return measured


def curves(runs):
    """Errors over the spacing by form and arrangement, whatever the runs are called, beside the reference."""
    points = {}
    for run in runs.values():
        form = "sph" if run.case["momentum"]["diffusion"] == "hu-adams" else "gfd"
        jittered = float(run.case["initial"]["jitter"]) > 0
        points.setdefault((form, jittered), []).append((float(run.case["resolution"]["spacing"]), error(run)))
    lines = [(f"{form}, {'jittered' if jittered else 'lattice'}", *map(np.array, zip(*sorted(found))),
              "o-" if form == "gfd" else "s--") for (form, jittered), found in sorted(points.items())]
    table = read_reference(REFERENCE, ("n", "rmse_gfd", "rmse_sph"))
    for form in FORMS:
        lines.append((f"reference, {form}, lattice", 1 / (table["n"] - 1), table[f"rmse_{form}"], "k:" if form == "gfd" else "k-."))
    return [{"file": "errors", "x": "spacing", "y": "normalised RMSE", "curves": lines, "log": "xy"}]
