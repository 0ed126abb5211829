# SPDX-License-Identifier: MIT
"""Energy spectra of a flow coupled to uniform bubbles and of the single-phase flow that it must act as."""
import numpy as np


def last_spectrum(run):
    """Wavenumbers and energies of the last time, up to half of the largest wavenumber, without the mean."""
    spectrum = run.spectrum
    rows = spectrum["t"] == spectrum["t"][-1]
    k, energy = spectrum["wavenumber"][rows], spectrum["energy"][rows]
    largest = int(np.atleast_1d(run.case["resolution"]["grid"])[0]) / 2
    good = (k > 0) & (k <= 0.5 * largest)
    return k[good], energy[good]


def spectrum_error(run, reference):
    return float(np.max(np.abs(last_spectrum(run)[1] / last_spectrum(reference)[1] - 1)))


def measure(runs):
    error = spectrum_error(runs["coupled"], runs["enhanced"])
    out = {"spectrum_error": error,
           # What is to be told apart: the effect of the bubbles on the same spectrum.
           "effect_of_bubbles": spectrum_error(runs["coupled"], runs["plain"])}
    if "coupled_coarse_step" in runs:
        out["spectrum_error_over_coarse_step"] = error / spectrum_error(runs["coupled_coarse_step"], runs["enhanced"])
    return out


def curves(runs):
    if not {"plain", "coupled", "enhanced"} <= runs.keys():
        return []
    plain = last_spectrum(runs["plain"])
    lines = [(name.replace("_", " "), *ratio) for name, ratio in
             ((name, (last_spectrum(run)[0], last_spectrum(run)[1] / plain[1], style))
              for name, run, style in (("coupled", runs["coupled"], "-"), ("enhanced", runs["enhanced"], "k--")))]
    return [{"file": "spectra", "x": "k", "y": "E(k) / E(k) without bubbles", "curves": lines}]
