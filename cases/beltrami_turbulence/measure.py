# SPDX-License-Identifier: MIT
"""The energy put in by the ramped force, and when each closure lets the flow turn turbulent.

Without viscosity the response is exact: the nonlinear term of a Beltrami flow is a gradient, so u = -(integral of the
force) and K(1) = 0.142022. Later the flow first dies away and then turns turbulent: the time of the transition is that
of the fastest loss of energy after the slowest one.
"""
from pathlib import Path

import numpy as np

from spume_tools.results import read_reference, standard

FOLDER = Path(__file__).parent / "reference"
REFERENCE = read_reference(FOLDER / "beltrami_ramp_forcing.csv", ("t", "K"))
CLOSURES = ("mixed-scale", "smagorinsky", "dynamic-shepard", "dynamic-lagrangian")


def ramp_energy_error(run):
    return abs(float(np.interp(1.0, run.series["t"], run.series["kinetic_energy"])) / REFERENCE["K"][-1] - 1)


def transition_time(run):
    """Time after the force has ceased at which -dK/dt, averaged over a fifth of a time unit, is largest once it has been
    smallest: a closure that is too viscous takes most from the laminar flow at once. What it takes at the end, when
    little is left, is told from that by -d ln K/dt. The end of the run when the loss still grows there."""
    t, energy = run.series["t"], run.series["kinetic_energy"]
    centres = np.arange(1.15, t[-1] - 0.1, 0.02)
    if not len(centres):
        return float("nan")
    before, after = np.interp(centres - 0.1, t, energy), np.interp(centres + 0.1, t, energy)
    loss, relative = before - after, np.log(before / after)
    laminar = int(np.argmin(loss[:np.argmax(relative) + 1]))
    return float(centres[laminar + np.argmax(loss[laminar:])])


def errors(run):
    return {"ramp_energy_error": ramp_energy_error(run)}


def measure(runs):
    measured = errors(standard(runs))
    ended = [name for name in CLOSURES if name in runs and np.isfinite(runs[name].series["kinetic_energy"][-1])
             and runs[name].series["t"][-1] > 1]
    measured["closures_at_end"] = float(len(ended))
    times = {name: transition_time(runs[name]) for name in ended}
    for name, time in times.items():
        measured[f"transition_time_{name}"] = time
    if {"mixed-scale", "smagorinsky"} <= times.keys():
        measured["transition_mixed_scale_after_smagorinsky"] = times["mixed-scale"] - times["smagorinsky"]
    return measured


def curves(runs):
    lines = [(name, run.series["t"], run.series["kinetic_energy"], "-") for name, run in runs.items()]
    lines.append(("exact without viscosity", REFERENCE["t"], REFERENCE["K"], "k--"))
    figures = [{"file": "kinetic_energy_closures", "x": "t", "y": "kinetic energy", "curves": lines}]
    spectra = []
    for name, run in runs.items():
        if not run.has("spectrum.csv"):
            continue
        spectrum = run.spectrum
        rows = (spectrum["t"] == spectrum["t"].max()) & (spectrum["wavenumber"] > 0) & (spectrum["energy"] > 0)
        k, energy = spectrum["wavenumber"][rows], spectrum["energy"][rows]
        if len(k):
            spectra.append((f"{name}, t = {spectrum['t'].max():.3g}", k, energy / np.trapz(energy, k), "-"))
    if spectra:
        _, k, energy, _ = spectra[0]
        peak = int(np.argmax(energy))
        spectra.append(("slope -5/3", k[peak:], energy[peak] * (k[peak:] / k[peak]) ** (-5 / 3), "k--"))
        figures.append({"file": "spectrum_closures", "x": "wavenumber", "y": "energy / total", "log": "xy",
                        "curves": spectra})
    return figures
