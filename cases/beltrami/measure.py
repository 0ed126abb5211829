# SPDX-License-Identifier: MIT
"""The tri-periodic Beltrami flow of Antuono (2020): u(x, t) = u(x, 0) exp(-3 nu k^2 t), K = exp(-6 nu k^2 t)/2."""
import numpy as np

from spume_tools.results import relative_rms, standard

WAVENUMBER = 2 * np.pi
AMPLITUDE = 4 * np.sqrt(2) / (3 * np.sqrt(3))


def beltrami(position, k=WAVENUMBER):
    """The velocity at t = 0, (N, 3); the components follow from the first by cyclic exchange of the coordinates."""
    def component(a, b, c):
        return AMPLITUDE * (np.sin(k * a - 5 * np.pi / 6) * np.cos(k * b - np.pi / 6) * np.sin(k * c)
                            - np.cos(k * c - 5 * np.pi / 6) * np.sin(k * a - np.pi / 6) * np.sin(k * b))

    x, y, z = position.T
    return np.column_stack([component(x, y, z), component(y, z, x), component(z, x, y)])


def rate(run):
    return 3 * WAVENUMBER**2 / float(run.case["fluid"]["reynolds"])


def errors(run):
    """Energy: largest relative error of K(t) over the run. Velocity: rms at the end over the initial rms, 1."""
    t, energy = run.series["t"], run.series["kinetic_energy"]
    last = run.snapshots()[-1]
    exact = np.exp(-rate(run) * last.time) * beltrami(last.position)
    return {
        "energy_error": float(np.max(np.abs(energy / (0.5 * np.exp(-2 * rate(run) * t)) - 1))),
        "velocity_error": relative_rms(last.field("velocity"), exact, 1.0),
    }


def measure(runs):
    return errors(standard(runs))


def curves(runs):
    run = standard(runs)
    t, energy = run.series["t"], run.series["kinetic_energy"]
    return [{"file": "kinetic_energy_exact", "x": "t", "y": "kinetic energy", "log": "y",
             "curves": [("Spume", t, energy, "-"), ("exact", t, 0.5 * np.exp(-2 * rate(run) * t), "k--")]}]
