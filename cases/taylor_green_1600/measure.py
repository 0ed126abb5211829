# SPDX-License-Identifier: MIT
"""The Taylor-Green vortex at Re = 1600 against a spectral simulation on 512^3 points (van Rees et al.)."""
from pathlib import Path

import numpy as np

from spume_tools.results import read_reference, standard

FOLDER = Path(__file__).parent / "reference"
REFERENCE = read_reference(FOLDER / "tgv_re1600_spectral512.csv", ("t", "E", "eps"))
SPECTRUM = read_reference(FOLDER / "tgv_re1600_spectrum_t9.csv", ("k", "E"))
EARLY_ENERGY = 0.124953117517  # E(0.1), the reference's source with all its digits


def at_reference_times(run, name, until):
    """Values of a column at the reference's times up to `until`; both write a row every 0.05."""
    t = run.series["t"]
    times = REFERENCE["t"][REFERENCE["t"] <= min(until, t[-1]) + 1e-9]
    return times, np.interp(times, t, run.series[name])


def energy_error(run, until):
    times, energy = at_reference_times(run, "mean_energy", until)
    return float(np.max(np.abs(energy - REFERENCE["E"][: len(times)])))


def peak(t, dissipation):
    """Largest dissipation and its time, by a parabola through the highest row and its neighbours."""
    i = int(np.clip(np.argmax(dissipation), 1, len(t) - 2))
    a, b, c = np.polyfit(t[i - 1: i + 2] - t[i], dissipation[i - 1: i + 2], 2)
    return c - b * b / (4 * a), t[i] - b / (2 * a)


def errors(run):
    times, dissipation = at_reference_times(run, "mean_dissipation", 10)
    reference = REFERENCE["eps"][: len(times)]
    result = {"dissipation_error": float(np.max(np.abs(dissipation / reference - 1)))}
    if times[-1] > 9.5:
        highest, when = peak(times, dissipation)
        expected, moment = peak(REFERENCE["t"], REFERENCE["eps"])
        result["peak_error"] = float(highest / expected - 1)
        result["peak_time_error"] = float(when - moment)
    return result


def measure(runs):
    measured = {}
    if "n32" in runs:
        series = runs["n32"].series
        measured["energy_error_n32"] = float(abs(np.interp(0.1, series["t"], series["mean_energy"]) - EARLY_ENERGY))
    if "n64" in runs:
        measured["energy_error_n64"] = energy_error(runs["n64"], 3)
    for name, run in runs.items():
        if run.series["t"][-1] > 5:
            measured |= {f"{quantity}_{name}": value for quantity, value in errors(run).items()}
    return measured


def curves(runs):
    long = {name: run for name, run in runs.items() if run.series["t"][-1] > 1} or {"run": standard(runs)}
    end = max(run.series["t"][-1] for run in long.values())
    rows = REFERENCE["t"] <= end
    figures = []
    for column, reference, file in (("mean_energy", "E", "energy_reference"),
                                    ("mean_dissipation", "eps", "dissipation_reference")):
        lines = [(name, run.series["t"], run.series[column], "-") for name, run in long.items()]
        lines.append(("512^3 (van Rees)", REFERENCE["t"][rows], REFERENCE[reference][rows], "k--"))
        figures.append({"file": file, "x": "t", "y": column.replace("_", " "), "curves": lines})
    spectra = []
    for name, run in long.items():
        if not run.has("spectrum.csv"):
            continue
        spectrum = run.spectrum
        times = np.unique(spectrum["t"])
        nearest = times[np.argmin(np.abs(times - 9))]
        if abs(nearest - 9) < 0.2:
            # The first shell is empty by symmetry, to rounding.
            at = (spectrum["t"] == nearest) & (spectrum["energy"] > 1e-20 * spectrum["energy"].max())
            spectra.append((f"{name}, t = {nearest:.3g}", spectrum["wavenumber"][at], spectrum["energy"][at], "-"))
    if spectra:
        spectra.append(("512^3, digitised", SPECTRUM["k"], SPECTRUM["E"], "ko"))
        figures.append({"file": "spectrum_reference", "x": "wavenumber", "y": "energy", "log": "xy", "curves": spectra})
    return figures
