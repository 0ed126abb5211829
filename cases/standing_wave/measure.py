# SPDX-License-Identifier: MIT
"""Phase and amplitude of a viscous standing wave against the initial-value solution of Prosperetti (1976).

The amplitude a(t) of the surface is much smaller than the spacing can show, but its rate of change is carried by all
particles: the velocity is projected on the potential of a wave, m = (-sin kx, cos kx) exp(ky),

    da/dt = sum_i u_i . m(x_i) / sum_i m(x_i) . m(x_i),

which is exact to first order in the amplitude, for rotational flow too: m is a gradient, so that only the motion of the
surface counts. Its integral from the start, a(0) = 1, and the reference are taken at the same times and described by
exp(-gamma t)(C cos wt + S sin wt), fitted by least squares over the whole run; errors compare the two descriptions.
"""
from pathlib import Path

import numpy as np

from spume_tools.results import MissingResult, read_reference, standard
from spume_tools.waves import damped_oscillation

K = 2 * np.pi
PERIOD = 2 * np.pi / np.sqrt(K)
FOLDER = Path(__file__).parent / "reference"
REFERENCE = read_reference(FOLDER / "standing_wave_viscous_deep.csv", ("nu", "t", "a_over_a0"))


def viscosity(run):
    return 1 / float(run.case["fluid"]["reynolds"])


def amplitude_rate(run):
    """Times and da/dt of the snapshots, in units of a(0)."""
    times, rates = [], []
    for snapshot in run.snapshots():
        x, y = K * snapshot.position[:, 0], K * snapshot.position[:, 1]
        mode = np.exp(y)[:, None] * np.column_stack([-np.sin(x), np.cos(x)])
        rates.append(np.sum(snapshot.field("velocity")[:, :2] * mode) / np.sum(mode**2))
        times.append(snapshot.time)
    times, rates = np.array(times), np.array(rates) / float(run.case["constants"]["steepness"])
    # A run that ends a rounding after an output has a snapshot of its end besides.
    apart = np.concatenate([[True], np.diff(times) > 1e-3 * times[1]])
    times, rates = times[apart], rates[apart]
    if len(times) < 5 or np.ptp(np.diff(times)) > 1e-6 * times[-1]:
        raise MissingResult(f"{run.folder}: its snapshots are not equally spaced in time, or fewer than five")
    return times, rates


def integral(t, f):
    """Of f from t[0] to each of the equally spaced t, of fourth order."""
    parts = np.empty(len(t) - 1)
    parts[1:-1] = -f[:-3] + 13 * f[1:-2] + 13 * f[2:-1] - f[3:]
    ends = np.array([9, 19, -5, 1])
    parts[0], parts[-1] = ends @ f[:4], ends @ f[:-5:-1]
    return np.concatenate([[0], np.cumsum(parts)]) * (t[1] - t[0]) / 24


def amplitude(wave, t):
    c, s, gamma, _ = wave
    return np.hypot(c, s) * np.exp(-gamma * t)


def phase(wave, t):
    c, s, _, omega = wave
    return omega * t - np.arctan2(s, c)


def histories(run):
    """Times of the reference, a(t) over a(0) there: measured and exact."""
    t, rates = amplitude_rate(run)
    nu, end = viscosity(run), t[-1]
    rows = np.isclose(REFERENCE["nu"], nu) & (REFERENCE["t"] <= end * 1.0001)
    if rows.sum() < 5:
        raise MissingResult(f"{REFERENCE.path}: holds too few values for viscosity {nu:g} up to t = {end:g}; its viscosities"
                            f" are {', '.join(f'{value:g}' for value in np.unique(REFERENCE['nu']))}")
    at = REFERENCE["t"][rows]
    nearest = np.argmin(np.abs(t[:, None] - at), axis=0)
    if np.max(np.abs(t[nearest] - at)) > 1e-6 * end:
        raise MissingResult(f"{run.folder}: no snapshots at the times of the reference, every tenth of a period")
    return at, (1 + integral(t, rates))[nearest], REFERENCE["a_over_a0"][rows]


def errors(run):
    """Phase: difference accumulated by the end over the phase run through. Amplitude: largest relative difference.
    Period and decay are the errors of the two fitted rates. The last one takes no fit."""
    at, amplitudes, reference = histories(run)
    guess = 2 * viscosity(run) * K**2, np.sqrt(K)
    measured, exact = damped_oscillation(at, amplitudes, *guess), damped_oscillation(at, reference, *guess)
    t = np.linspace(0, at[-1], 200)
    lag = np.angle(np.exp(1j * (phase(measured, t[-1]) - phase(exact, t[-1]))))
    series = run.series
    return {
        "phase_error": abs(lag) / (exact[3] * t[-1]),
        "amplitude_error": float(np.max(np.abs(amplitude(measured, t) / amplitude(exact, t) - 1))),
        "period_error": abs(exact[3] / measured[3] - 1),
        "decay_rate_error": abs(measured[2] / exact[2] - 1),
        "largest_difference": float(np.max(np.abs(amplitudes - reference))),
        "mass_drift": float(np.max(np.abs(series["mass"] / series["mass"][0] - 1))),
    }


def measure(runs):
    return errors(standard(runs))


def curves(runs):
    run = standard(runs)
    t, rates = amplitude_rate(run)
    at, _, reference = histories(run)
    return [{"file": "amplitude_exact", "x": "t / period", "y": "a / a(0)",
             "curves": [("Spume", t / PERIOD, 1 + integral(t, rates), "-"),
                        ("Prosperetti (1976)", at / PERIOD, reference, "ko")]}]
