# SPDX-License-Identifier: MIT
"""u = -exp(-8 pi^2 nu t) cos(2 pi x) sin(2 pi y), v = exp(-8 pi^2 nu t) sin(2 pi x) cos(2 pi y), K = exp(-16 pi^2 nu t)/4:
the slope of ln K over the run. `early`: until t = 0.05, while the particles still form the lattice they began on."""
import numpy as np

EARLY = 0.05


def exact_rate(run):
    return 16 * np.pi**2 * float(run.case["phase"][0]["viscosity"]) / float(run.case["phase"][0]["density"])


def rate_error(run, end):
    t, energy = run.series["t"], run.series["kinetic_energy"]
    chosen = t <= end
    rate = -np.polyfit(t[chosen], np.log(energy[chosen]), 1)[0]
    return abs(rate / exact_rate(run) - 1)


def measure(runs):
    measured = {}
    for name, run in runs.items():
        suffix = "" if name == "standard" else f"_{name}"
        measured[f"decay_rate_error{suffix}"] = rate_error(run, np.inf)
        measured[f"early_decay_rate_error{suffix}"] = rate_error(run, EARLY)
    return measured


def curves(runs):
    t = np.linspace(0, max(run.series["t"][-1] for run in runs.values()), 200)
    lines = [(name, run.series["t"], run.series["kinetic_energy"], "-") for name, run in runs.items()]
    lines.append(("exact", t, 0.25 * np.exp(-exact_rate(next(iter(runs.values()))) * t), "k--"))
    return [{"file": "kinetic_energy_exact", "x": "t", "y": "kinetic energy", "log": "y", "curves": lines}]
