# SPDX-License-Identifier: MIT
"""The long wave that goes with a group of waves, against theory of second order.

Elevations at the probes without what oscillates faster than half the frequency of the peak, beside the wave bound to the
group: the sum over all pairs of components of D(w_i, w_j) a_i a_j, with D of Hasselmann (1962).
- `long_wave_error`: rms of the difference over the times of the group, over the largest depression of theory, the mean
  over the probes; `long_wave_error_first_order`: of the piston of first order, which makes a free long wave beside it.
- `crest_error`: of the highest crest at the focus, over the linear amplitude and what theory of second order adds to it.
"""
import numpy as np

from spume_tools.results import MissingResult, standard
from spume_tools.waves import wavenumber

DEPTH = GRAVITY = 1.0
BANDS = (0.5, 3.0)  # of the frequency of the peak, as the wavemaker's


def jonswap(f, gamma):
    width = np.where(f <= 1, 0.07, 0.09)
    return f**-5 * np.exp(-1.25 * f**-4) * gamma**np.exp(-(f - 1)**2 / (2 * width**2))


class Group:
    """The components a cos(w t - k x + phase) that a case asks for."""

    def __init__(self, case):
        maker = case["wavemaker"][0]
        count = int(maker["components"])
        f = BANDS[0] + (BANDS[1] - BANDS[0]) * (np.arange(count) + 0.5) / count
        self.peak = 2 * np.pi / float(maker["period"])
        self.place, self.time = float(maker["focus_place"]), float(maker["focus_time"])
        self.amplitude = jonswap(f, float(maker["gamma"]))
        self.amplitude *= float(maker["amplitude"]) / self.amplitude.sum()
        self.w = f * self.peak
        self.k = np.array([wavenumber(w, DEPTH, GRAVITY) for w in self.w])

    def _waves(self, x, t):
        """Complex components at times t; their sum has the linear elevation as its real part."""
        return self.amplitude * np.exp(1j * (np.outer(t - self.time, self.w) - self.k * (x - self.place)))

    def linear(self, x, t):
        return self._waves(x, t).sum(axis=1).real

    def interactions(self):
        """D of the differences, and of the sums, as matrices over pairs."""
        g, h = GRAVITY, DEPTH
        found = []
        for sign in (-1, 1):
            w1, w2, k1, k2 = self.w[:, None], sign * self.w[None, :], self.k[:, None], sign * self.k[None, :]
            w, k = w1 + w2, k1 + k2
            with np.errstate(divide="ignore", invalid="ignore"):
                c = w * (w1**2 * w2**2 / g**2 - k1 * k2) - 0.5 * (w1 * k2**2 / np.cosh(k2 * h)**2 +
                                                                 w2 * k1**2 / np.cosh(k1 * h)**2)
                d = (-g * k1 * k2 / (2 * w1 * w2) + (w1**2 + w1 * w2 + w2**2) / (2 * g)
                     + c * g * w / (w1 * w2 * (g * k * np.tanh(k * h) - w**2)))
            found.append(d)
        np.fill_diagonal(found[0], 0)  # a mean level, which the flume shares out
        return found

    def bound(self, x, t):
        """Elevations of the differences and of the sums at second order."""
        waves = self._waves(x, t)
        low, high = self.interactions()
        return (0.5 * np.einsum("ti,ij,tj->t", waves, low, waves.conj()).real,
                0.5 * np.einsum("ti,ij,tj->t", waves, high, waves).real)


def long_part(t, signal, cut):
    """What is slower than `cut`, of a record that is at rest at its start: by cosines of its length and its mirror image,
    faded out over a fifth of `cut`."""
    even = np.arange(t[0], t[-1], np.diff(t).mean())
    record = np.interp(even, t, signal)
    spectrum = np.fft.rfft(np.concatenate([record, record[::-1]]))
    w = 2 * np.pi * np.fft.rfftfreq(2 * len(record), even[1] - even[0])
    spectrum *= np.clip((1.1 * cut - w) / (0.2 * cut), 0, 1)
    return np.interp(t, even, np.fft.irfft(spectrum, 2 * len(record))[:len(record)])


def compared(run, name, x):
    """Times, and the slow elevation at a probe, measured and by theory."""
    group = Group(run.case)
    t = run.probes["t"]
    if t[-1] < group.time + 20:
        raise MissingResult(f"{run.folder}: the run ends before the group has passed")
    bound = group.bound(x, t)[0]
    theory = long_part(t, group.linear(x, t) + bound, 0.5 * group.peak)
    measured = run.probes[name] - np.mean(run.probes[name][t < 5])
    return t, long_part(t, measured, 0.5 * group.peak), theory


def long_wave_error(run):
    errors = []
    for probe in run.case["probe"]:
        t, measured, theory = compared(run, probe["name"], probe["position"][0])
        group = Group(run.case)
        passing = np.abs(t - group.time - (probe["position"][0] - group.place)) < 15
        errors.append(np.sqrt(np.mean((measured - theory)[passing]**2)) / -theory.min())
    return float(np.mean(errors))


def measure(runs):
    measured = {}
    for run in runs.values():
        order = "_first_order" if int(run.case["wavemaker"][0]["order"]) == 1 else ""
        measured["long_wave_error" + order] = long_wave_error(run)
    run = standard(runs)
    group = Group(run.case)
    low, high = group.bound(group.place, np.array([group.time]))
    crest = group.amplitude.sum() + low[0] + high[0]
    measured["crest_error"] = float((run.probes["focus"].max() - DEPTH) / crest - 1)
    series = run.series
    return measured | {"mass_drift": float(np.max(np.abs(series["mass"] / series["mass"][0] - 1)))}


def curves(runs):
    lines = []
    for name, run in runs.items():
        t, measured, theory = compared(run, "behind", 13)
        lines.append(("second order" if name == "standard" else name.replace("_", " "), t, measured, "-"))
    return [{"file": "long_wave", "x": "t", "y": "slow elevation at x = 13, in depths",
             "curves": [*lines, ("theory", t, theory, "--")]}]
