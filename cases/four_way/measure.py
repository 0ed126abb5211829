# SPDX-License-Identifier: MIT
"""Energy spectrum of turbulence with four-way coupled bubbles over that without."""
import numpy as np


def mean_spectrum(run):
    """Wavenumbers times eta and the mean spectrum of the second half of the run."""
    spectrum = run.spectrum
    rows = spectrum["t"] >= 0.5 * spectrum["t"].max()
    k = np.unique(spectrum["wavenumber"])
    energy = np.array([np.mean(spectrum["energy"][rows & (spectrum["wavenumber"] == each)]) for each in k])
    nu, injection = 1 / float(run.case["fluid"]["reynolds"]), float(run.case["forcing"]["injection"])
    largest = int(np.atleast_1d(run.case["resolution"]["grid"])[0]) / 2
    good = (k > 0) & (k < largest)
    return k[good] * (nu**3 / injection) ** 0.25, energy[good]


def ratio(runs):
    x, coupled = mean_spectrum(runs["coupled"])
    return x, coupled / mean_spectrum(runs["single"])[1]


def measure(runs):
    x, over = ratio(runs)
    return {"large_scales": float(np.mean(over[:2])),
            "intermediate_scales": float(np.mean(over[(x > 0.2) & (x < 0.7)])),
            "smallest_scales": float(np.mean(over[x > 0.9 * x[-1]]))}


def curves(runs):
    if "coupled" not in runs:
        return []
    x, over = ratio(runs)
    lines = [(name, *mean_spectrum(runs[name]), style) for name, style in (("single", "k--"), ("coupled", "-"))]
    return [{"file": "spectra", "x": "k eta", "y": "E(k)", "log": "xy", "curves": lines},
            {"file": "spectrum_ratio", "x": "k eta", "y": "E(k) with bubbles / without", "log": "xy",
             "curves": [("four-way", x, over, "-"), ("1", x, np.ones_like(x), "k:")]},
            {"file": "attenuation", "x": "k eta", "y": "E(k) with bubbles / without",
             "curves": [("four-way", x[x < 1.5], over[x < 1.5], "-"), ("1", x[x < 1.5], np.ones(sum(x < 1.5)), "k:")]}]
