# SPDX-License-Identifier: MIT
"""Height, loss and reflection of regular waves along a flume; height and speed of a solitary wave.

Regular waves are measured by the mean of the last four periods, the free harmonic by that of the second half of the run.
A height is that from crest to trough of the mean
period, averaged over probes that span half a wavelength, so that a reflected wave does not count.
- `height_error`: of the waves a wavelength from the wavemaker, over the height asked for.
- `loss`: by which the waves at ten wavelengths farther are lower.
- `reflection`: amplitude of the wave that comes back over that of the one that goes, of the fundamental, by least squares
  over the five far probes (Mansard and Funke 1980).
- `free_harmonic`: amplitude of a second harmonic that travels with its own speed, near the wavemaker, over half the height.
  Single periods scatter by 0.01 about it, a thirtieth of a spacing.
Loss and reflection are left out of a run that ends before the waves have settled at the far probes.

Of a solitary wave, between the probes nearest to 5 and to 25 depths from the wavemaker:
- `solitary_height_error`: of the crest at the first, over the height asked for.
- `solitary_loss`: by which it is lower at the last.
- `solitary_speed_error`: of its speed between them, over that of the exact wave of its mean height there.
"""
from pathlib import Path

import numpy as np

from spume_tools.results import MissingResult, read_reference, standard
from spume_tools.waves import harmonics, incident_and_reflected, mean_height, wavenumber

PERIODS = 4
DEPTH = GRAVITY = 1.0
EXACT = read_reference(Path(__file__).parent / "reference" / "solitary.csv", ("e", "speed_exact"))


def probes(run, name):
    """Places and names of the probes whose names begin so, from the wavemaker onwards."""
    found = sorted((probe["position"][0], probe["name"]) for probe in run.case["probe"] if probe["name"].startswith(name))
    return np.array([x for x, _ in found]), [name for _, name in found]


def last_periods(run, share=0.0):
    """Times of the last periods, at least those of this share of the run, the rows that they are, and the angular
    frequency."""
    period = float(run.case["wavemaker"][0]["period"])
    t = run.probes["t"]
    count = max(PERIODS, int(share * (t[-1] - t[0]) / period * (1 + 1e-9)))
    rows = t > t[-1] - count * period * (1 - 1e-9)
    if t[-1] < (PERIODS + 1) * period:
        raise MissingResult(f"{run.folder}: the run is shorter than {PERIODS + 1} periods of {period:.4g}")
    return t[rows], rows, 2 * np.pi / period


def height(run, name):
    """Mean over the probes, each of which counts for the way to its neighbours."""
    t, rows, w = last_periods(run)
    x, names = probes(run, name)
    heights = [mean_height(t, run.probes[one][rows], w) for one in names]
    weights = np.gradient(x) * np.where((x == x[0]) | (x == x[-1]), 0.5, 1)
    return float(np.average(heights, weights=weights))


def group_speed(w):
    kh = wavenumber(w, DEPTH, GRAVITY) * DEPTH
    return w / (kh / DEPTH) / 2 * (1 + 2 * kh / np.sinh(2 * kh))


def regular(run):
    t, rows, w = last_periods(run)
    asked = float(run.case["wavemaker"][0]["height"])
    near = height(run, "near")
    x, names = probes(run, "near")
    k, free = wavenumber(w, DEPTH, GRAVITY), wavenumber(2 * w, DEPTH, GRAVITY)
    late, settled, _ = last_periods(run, share=0.5)
    second = np.array([harmonics(late, run.probes[one][settled], w)[2] for one in names])
    parts = np.linalg.lstsq(np.exp(-1j * np.outer(x, [2 * k, free])), second, rcond=None)[0]
    measured = {"height_error": near / asked - 1, "free_harmonic": float(2 * np.abs(parts[1]) / asked)}
    x, names = probes(run, "far")
    # The front of the waves is as long as several of them and has passed by eight periods after its middle.
    if t[0] < x[-1] / group_speed(w) + 8 * 2 * np.pi / w:
        return measured
    amplitudes = np.array([harmonics(t, run.probes[one][rows], w)[1] for one in names])
    incident, reflected, _ = incident_and_reflected(x, amplitudes, k)
    return measured | {"loss": 1 - height(run, "far") / near, "reflection": float(np.abs(reflected / incident))}


def exact_speed(relative_height):
    """c / sqrt(gh) of the exact solitary wave, between the rows of the reference."""
    return float(np.interp(relative_height, np.concatenate([[0], EXACT["e"]]), np.concatenate([[1], EXACT["speed_exact"]])))


def crest(t, elevation):
    """Time and height of the highest crest: of the parabola through seven rows about it, as rows scatter."""
    top = int(np.argmax(elevation))
    rows = slice(max(top - 3, 0), top + 4)
    if len(t[rows]) < 7:
        raise MissingResult("the crest of the solitary wave has not passed the last probe")
    a, b, c = np.polyfit(t[rows] - t[top], elevation[rows], 2)
    return t[top] - b / (2 * a), c - b * b / (4 * a)


def solitary(run):
    x, names = probes(run, "")
    first, last = int(np.argmin(np.abs(x - 5))), int(np.argmin(np.abs(x - 25)))
    t, asked = run.probes["t"], float(run.case["wavemaker"][0]["height"])
    (t0, h0), (t1, h1) = (crest(t, run.probes[names[k]] - DEPTH) for k in (first, last))
    speed = (x[last] - x[first]) / (t1 - t0)
    return {"solitary_height_error": float(h0 / asked - 1),
            "solitary_loss": float(1 - h1 / h0),
            "solitary_speed_error": float(speed / exact_speed((h0 + h1) / 2) - 1)}


def measure(runs):
    measured = {}
    for run in runs.values():
        measured |= solitary(run) if run.case["wavemaker"][0]["waves"] == "solitary" else regular(run)
    series = standard(runs).series
    return measured | {"mass_drift": float(np.max(np.abs(series["mass"] / series["mass"][0] - 1)))}


def curves(runs):
    run = standard(runs)
    t, period = run.probes["t"], float(run.case["wavemaker"][0].get("period", 1))
    return [{"file": "elevations", "x": "t / period", "y": "elevation / depth",
             "curves": [(label, t / period, run.probes[name] - DEPTH, style)
                        for label, name, style in (("1 wavelength", "near_1", "-"), ("10.75", "far_2", "-"))]}]
