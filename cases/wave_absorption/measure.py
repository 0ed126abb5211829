# SPDX-License-Identifier: MIT
"""Waves that come back to the piston that makes them, and what an absorbing piston sends back.

Complex amplitudes of the fundamental at five probes over the last four periods, by least squares; from them the wave
that goes from the wavemaker and the one that comes back (Mansard and Funke 1980).
- `incident_error`: of the wave that leaves a piston which absorbs, before a wall that sends all of it back, over the one
  asked for; `incident_of_fixed_motion_error`: of a piston that does not absorb.
- `reflection_tuned`, `reflection_long_wave`: of a piston that only absorbs, wave that comes from it over the one that
  goes to it; `reflection_long_wave_error`: less what linear theory expects of the law, `expected_reflection`.
"""
import numpy as np

from spume_tools.results import MissingResult, standard
from spume_tools.waves import harmonics, incident_and_reflected, wavenumber

PERIODS = 4
DEPTH = GRAVITY = 1.0


def frequency(run):
    return 2 * np.pi / float(run.case["wavemaker"][0]["period"])


def travelling(run):
    """Complex amplitudes of the waves that go to the right and to the left, at x = 0."""
    w, t = frequency(run), run.probes["t"]
    if t[-1] < 12 * 2 * np.pi / w:
        raise MissingResult(f"{run.folder}: the run ends before waves have gone to and fro")
    rows = t > t[-1] - PERIODS * 2 * np.pi / w * (1 - 1e-9)
    probes = run.case["probe"]
    amplitudes = np.array([harmonics(t[rows], run.probes[one["name"]][rows], w)[1] for one in probes])
    x = np.array([one["position"][0] for one in probes])
    return incident_and_reflected(x, amplitudes, wavenumber(w, DEPTH, GRAVITY))[:2]


def decaying_wavenumbers(w, count):
    """k_j, the root of k h tan kh = -w^2 h / g between (j - 1/2) pi and j pi, by iteration."""
    y, whole = w * w * DEPTH / GRAVITY, np.pi * np.arange(1, count + 1)
    q = whole.copy()
    for _ in range(100):
        q = whole - np.arctan(y / q)
    return q / DEPTH


def expected_reflection(w, spacing):
    """|R| of the long-wave law by linear theory, for a wall that moves with v into the liquid, measures e at 1.5 spacings
    from itself and obeys 0.1 u' = -e - u, v = u - X / drift, X' = v: e is that of the wave that comes, of the same wave
    sent back, and of the waves and decaying modes that v makes."""
    k = wavenumber(w, DEPTH, GRAVITY)
    gauge, drift, smoothing, gain = 1.5 * spacing, 20 * np.pi / np.sqrt(np.tanh(1)), 0.1, 1.0
    travelling_part = 2 * (np.cosh(2 * k) - 1) / (np.sinh(2 * k) + 2 * k)
    kj = decaying_wavenumbers(w, 200)
    decaying = 4 * np.sin(kj)**2 / (2 * kj + np.sin(2 * kj))
    made = travelling_part * np.exp(-1j * k * gauge) - 1j * np.sum(decaying * np.exp(-kj * gauge))
    answer = gain / (1 + 1j * w * smoothing) * 1j * w * drift / (1 + 1j * w * drift)
    e = 2 * np.cos(k * gauge) / (1 + answer / w * made)
    return float(np.abs(1 - travelling_part * answer / w * e))


def measure(runs):
    measured = {}
    for name, run in runs.items():
        rightwards, leftwards = np.abs(travelling(run))
        if len(run.case["wavemaker"]) == 1:
            asked = float(run.case["wavemaker"][0]["height"]) / 2
            key = "incident_error" if run.case["wavemaker"][0]["absorption"] != "none" else "incident_of_fixed_motion_error"
            measured[key] = float(rightwards / asked - 1)
            continue
        law = run.case["wavemaker"][1]["absorption"].replace("-", "_")
        measured[f"reflection_{law}"] = reflected = float(leftwards / rightwards)
        if law == "long_wave":
            expected = expected_reflection(frequency(run), float(run.case["resolution"]["spacing"]))
            measured["reflection_long_wave_error"] = reflected - expected
    series = standard(runs).series
    return measured | {"mass_drift": float(np.max(np.abs(series["mass"] / series["mass"][0] - 1)))}
