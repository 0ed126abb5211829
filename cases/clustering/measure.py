# SPDX-License-Identifier: MIT
"""Kaplan-Yorke dimension of particles in turbulence from the growth of their tangent directions."""
import numpy as np


def kaplan_yorke(exponents):
    """J + (lambda_1 + ... + lambda_J) / |lambda_{J+1}| with the largest J whose sum is not negative."""
    total = 0.0
    for j, exponent in enumerate(exponents):
        if total + exponent < 0:
            return j + total / abs(exponent)
        total += exponent
    return float(len(exponents))


def exponents(run):
    """Rates of growth over the second half of the run, strongest first."""
    t = run.series["t"]
    first = int(np.searchsorted(t, 0.5 * t[-1]))
    return [float((run.series[f"stretching_{k}"][-1] - run.series[f"stretching_{k}"][first]) / (t[-1] - t[first]))
            for k in range(1, 7)]


def measure(runs):
    out = {}
    names = {"light": "light_dimension", "heavy": "heavy_dimension", "tracers": "tracer_dimension"}
    for name, run in runs.items():
        rates = exponents(run)
        out[names.get(name, name)] = kaplan_yorke(rates)
        kolmogorov_time = np.sqrt(1 / (float(run.case["fluid"]["reynolds"]) * run.series["mean_dissipation"][-1]))
        out[f"{name}_largest_exponent_kolmogorov"] = rates[0] * kolmogorov_time
        out[f"{name}_correlation_dimension"] = float(np.mean(run.series["correlation_dimension"][-8:]))
    return out


def curves(runs):
    lines = []
    for name, run in runs.items():
        t = run.series["t"]
        good = t >= 0.25 * t[-1]
        lines.append((name, t[good], run.series["kaplan_yorke_dimension"][good], "-"))
    return [{"file": "dimension", "x": "t", "y": "Kaplan-Yorke dimension since the start", "curves": lines}]
