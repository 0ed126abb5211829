# SPDX-License-Identifier: MIT
"""Statistics of stirred turbulence: the energy balance and moments in the statistically steady state."""
import numpy as np

from spume_tools.results import standard


def steady(run):
    """Rows of the second half of the run, at least from t = 10 where it is that long."""
    t = run.series["t"]
    return t >= max(min(10, 0.5 * t[-1]), 0.25 * t[-1])


def errors(run):
    series, rows = run.series, steady(run)
    injection = float(run.case["forcing"]["injection"])
    return {
        # Rows are equally spaced, so that the mean of the rows' residuals is that of the whole time.
        "balance_residual": float(np.mean(np.abs(series["balance_residual"][1:]))),
        "skewness": float(np.mean(series["gradient_skewness"][rows])),
        "flatness": float(np.mean(series["gradient_flatness"][rows])),
        "kmax_eta": float(np.mean(series["kmax_eta"][rows])),
        "reynolds_lambda": float(np.mean(series["reynolds_lambda"][rows])),
        "dissipation_over_injection": float(np.mean(series["mean_dissipation"][rows]) / injection),
    }


def measure(runs):
    return errors(standard(runs))


def curves(runs):
    run = standard(runs)
    series = run.series
    figures = [{"file": "balance", "x": "t", "y": "rate of energy",
                "curves": [("dissipation", series["t"], series["mean_dissipation"], "-"),
                           ("injection", series["t"], series["mean_injection"], "k--")]},
               {"file": "moments", "x": "t", "y": "du/dx",
                "curves": [("skewness", series["t"], series["gradient_skewness"], "-"),
                           ("-0.5", series["t"], np.full_like(series["t"], -0.5), "k--")]}]
    if run.has("spectrum.csv"):
        spectrum = run.spectrum
        rows = spectrum["t"] >= series["t"][steady(run)][0]
        k = np.unique(spectrum["wavenumber"][rows])
        energy = np.array([np.mean(spectrum["energy"][rows & (spectrum["wavenumber"] == each)]) for each in k])
        eta = np.mean(series["kolmogorov_scale"][steady(run)])
        dissipation = np.mean(series["mean_dissipation"][steady(run)])
        good = (k > 0) & (energy > 0)
        figures.append({"file": "spectrum_compensated", "x": "k eta", "y": "E(k) k^(5/3) / epsilon^(2/3)", "log": "xy",
                        "curves": [("mean spectrum", k[good] * eta,
                                    energy[good] * k[good] ** (5 / 3) / dissipation ** (2 / 3), "-"),
                                   ("1.6", np.array([0.02, 0.2]), np.array([1.6, 1.6]), "k--")]})
    return figures
