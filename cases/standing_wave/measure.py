# SPDX-License-Identifier: MIT
"""Phase and amplitude of a viscous standing wave against the initial-value solution of Prosperetti (1976).

The amplitude a(t) of the surface is much smaller than the spacing can show, but its rate of change is carried by all
particles: to first order the velocity is da/dt m(x, y), m = (-sin kx, cos kx) exp(ky), so that

    da/dt = sum_i u_i . m(x_i) / sum_i m(x_i) . m(x_i).

Both this signal and the reference (differentiated) are described by exp(-gamma t)(C cos wt + S sin wt), fitted by
least squares over the whole run; errors compare the two descriptions.
"""
from pathlib import Path

import numpy as np

from spume_results import MissingResult, read_reference, standard

K = 2 * np.pi
PERIOD = 2 * np.pi / np.sqrt(K)
FOLDER = Path(__file__).parent / "reference"
REFERENCE = read_reference(FOLDER / "standing_wave_viscous_deep.csv", ("nu", "t", "a_over_a0"))


def viscosity(run):
    return 1 / float(run.case["fluid"]["reynolds"])


def amplitude_rate(run):
    """Times and da/dt of the snapshots after the start, at which the liquid is at rest."""
    times, rates = [], []
    for snapshot in run.snapshots():
        x, y = K * snapshot.position[:, 0], K * snapshot.position[:, 1]
        mode = np.exp(y)[:, None] * np.column_stack([-np.sin(x), np.cos(x)])
        rates.append(np.sum(snapshot.field("velocity")[:, :2] * mode) / np.sum(mode**2))
        times.append(snapshot.time)
    return np.array(times), np.array(rates)


def fit(t, signal, gamma, omega):
    """(C, S, gamma, omega) of exp(-gamma t)(C cos wt + S sin wt) by Gauss-Newton from the given rates."""
    def basis(gamma, omega):
        return np.exp(-gamma * t)[:, None] * np.column_stack([np.cos(omega * t), np.sin(omega * t)])

    c, s = np.linalg.lstsq(basis(gamma, omega), signal, rcond=None)[0]
    for _ in range(30):
        cosine, sine = basis(gamma, omega).T
        model = c * cosine + s * sine
        jacobian = np.column_stack([cosine, sine, -t * model, t * (s * cosine - c * sine)])
        step = np.linalg.lstsq(jacobian, signal - model, rcond=None)[0]
        c, s, gamma, omega = np.array([c, s, gamma, omega]) + step
    return c, s, gamma, omega


def differentiated(c, s, gamma, omega):
    return omega * s - gamma * c, -omega * c - gamma * s, gamma, omega


def amplitude(wave, t):
    c, s, gamma, _ = wave
    return np.hypot(c, s) * np.exp(-gamma * t)


def phase(wave, t):
    c, s, _, omega = wave
    return omega * t - np.arctan2(s, c)


def waves(run):
    """Fits of da/dt over the initial amplitude: measured and exact."""
    t, rates = amplitude_rate(run)
    nu, end = viscosity(run), t[-1]
    rows = np.isclose(REFERENCE["nu"], nu) & (REFERENCE["t"] <= end * 1.0001)
    if rows.sum() < 5:
        raise MissingResult(f"{REFERENCE.path}: holds too few values for viscosity {nu:g} up to t = {end:g}; its viscosities"
                            f" are {', '.join(f'{value:g}' for value in np.unique(REFERENCE['nu']))}")
    guess = 2 * nu * K**2, np.sqrt(K)
    exact = differentiated(*fit(REFERENCE["t"][rows], REFERENCE["a_over_a0"][rows], *guess))
    return fit(t, rates / float(run.case["constants"]["steepness"]), *guess), exact


def errors(run):
    """Phase: difference accumulated by the end over the phase run through. Amplitude: largest relative difference.
    Period and decay are the errors of the two fitted rates."""
    measured, exact = waves(run)
    t = np.linspace(0, run.snapshots().times[-1], 200)
    lag = np.angle(np.exp(1j * (phase(measured, t[-1]) - phase(exact, t[-1]))))
    series = run.series
    return {
        "phase_error": abs(lag) / (exact[3] * t[-1]),
        "amplitude_error": float(np.max(np.abs(amplitude(measured, t) / amplitude(exact, t) - 1))),
        "period_error": abs(exact[3] / measured[3] - 1),
        "decay_rate_error": abs(measured[2] / exact[2] - 1),
        "mass_drift": float(np.max(np.abs(series["mass"] / series["mass"][0] - 1))),
    }


def measure(runs):
    return errors(standard(runs))


def curves(runs):
    run = standard(runs)
    t, rates = amplitude_rate(run)
    _, exact = waves(run)
    fine = np.linspace(0, t[-1], 400)
    c, s, gamma, omega = exact
    model = np.exp(-gamma * fine) * (c * np.cos(omega * fine) + s * np.sin(omega * fine))
    return [{"file": "amplitude_exact", "x": "t / period", "y": "da/dt / a(0)",
             "curves": [("Spume", t / PERIOD, rates / float(run.case["constants"]["steepness"]), "."),
                        ("Prosperetti (1976)", fine / PERIOD, model, "k--")]}]
