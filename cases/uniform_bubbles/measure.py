# SPDX-License-Identifier: MIT
"""Energy spectra of a flow coupled to uniform bubbles and of the single-phase flow that it must act as."""
import numpy as np


def last_spectrum(run, most=np.inf):
    """Wavenumbers and energies of the last time, up to `most` and half of the largest wavenumber, without the mean."""
    spectrum = run.spectrum
    rows = spectrum["t"] == spectrum["t"][-1]
    k, energy = spectrum["wavenumber"][rows], spectrum["energy"][rows]
    largest = int(np.atleast_1d(run.case["resolution"]["grid"])[0]) / 2
    good = (k > 0) & (k <= min(0.5 * largest, most))
    return k[good], energy[good]


def spectrum_error(run, reference, most=np.inf):
    return float(np.max(np.abs(last_spectrum(run, most)[1] / last_spectrum(reference, most)[1] - 1)))


def measure(runs):
    error = spectrum_error(runs["coupled"], runs["enhanced"])
    out = {"spectrum_error": error,
           # What is to be told apart: the effect of the bubbles on the same spectrum.
           "effect_of_bubbles": spectrum_error(runs["coupled"], runs["plain"])}
    if "coupled_half_step" in runs:
        out["ratio_half_step"] = spectrum_error(runs["coupled_half_step"], runs["enhanced"]) / error
    if "coupled_fine_grid" in runs:
        most = last_spectrum(runs["coupled_coarse_grid"])[0][-1]
        coarse, fine = (spectrum_error(runs[f"coupled_{grid}_grid"], runs[f"enhanced_{grid}_grid"], most)
                        for grid in ("coarse", "fine"))
        out |= {"error_coarse_grid": coarse, "ratio_fine_grid": fine / coarse}
    return out


def curves(runs):
    if not {"plain", "coupled", "enhanced"} <= runs.keys():
        return []
    plain = last_spectrum(runs["plain"])
    lines = [(name.replace("_", " "), *ratio) for name, ratio in
             ((name, (last_spectrum(run)[0], last_spectrum(run)[1] / plain[1], style))
              for name, run, style in (("coupled", runs["coupled"], "-"), ("enhanced", runs["enhanced"], "k--")))]
    return [{"file": "spectra", "x": "k", "y": "E(k) / E(k) without bubbles", "curves": lines}]
