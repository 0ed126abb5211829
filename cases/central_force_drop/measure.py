# SPDX-License-Identifier: MIT
"""A drop of radius 1 under the force -B^2 r (Monaghan and Rafiee 2013). Velocities linear in space, u = (sigma x, -sigma y),
and a pressure that is quadratic solve Euler's equations exactly for an ellipse of semi-axes a and 1/a:

    da/dt = sigma a,    dsigma/dt = (sigma^2 + B^2) (1/a^2 - a^2) / (1/a^2 + a^2).
"""
import numpy as np

from spume_tools.results import standard

FORCE = 1.0  # B^2, that of case.toml


def rate(state):
    a, sigma = state
    x2, y2 = a**2, a**-2
    return np.array([sigma * a, (sigma**2 + FORCE) * (y2 - x2) / (y2 + x2)])


def exact(times, strain, largest_step=1e-3):
    """Semi-axis along x and strain rate at the increasing `times`, the first of them 0, by the classical Runge-Kutta
    method: at steps of 1e-3 its error is below 1e-10."""
    state, states = np.array([1.0, strain]), []
    now = 0.0
    for t in times:
        steps = max(1, int(np.ceil((t - now) / largest_step)))
        h = (t - now) / steps
        for _ in range(steps):
            k1 = rate(state)
            k2 = rate(state + h / 2 * k1)
            k3 = rate(state + h / 2 * k2)
            k4 = rate(state + h * k3)
            state = state + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        states.append(state)
        now = t
    return np.array(states).T


def strain_of(run):
    return float(run.case["constants"]["strain"])


def semi_axes(run):
    """Times, and both semi-axes over that of the start: square roots of the second moments of the particles."""
    times, axes = [], []
    for snapshot in run.snapshots():
        times.append(snapshot.time)
        axes.append(np.sqrt(np.mean(snapshot.position[:, :2] ** 2, axis=0)))
    axes = np.array(axes)
    return np.array(times), axes / axes[0]


def errors(run):
    """Energy: largest change of kinetic energy less work over the largest kinetic energy. Semi-axis: largest difference in
    either, over the radius. Area: largest relative change of the product of both."""
    series = run.series
    energy = series["kinetic_energy"] - series["work"]
    times, axes = semi_axes(run)
    a, _ = exact(times, strain_of(run))
    return {
        "energy_error": float(np.max(np.abs(energy - energy[0])) / np.max(series["kinetic_energy"])),
        "semi_axis_error": float(np.max(np.abs(axes - np.column_stack([a, 1 / a])))),
        "area_error": float(np.max(np.abs(axes[:, 0] * axes[:, 1] - 1))),
        "mass_drift": float(np.max(np.abs(series["mass"] / series["mass"][0] - 1))),
    }


def measure(runs):
    measured = errors(standard(runs))
    for name, run in runs.items():
        if len(runs) > 1:
            measured |= {f"{quantity}_{name}": value for quantity, value in errors(run).items() if quantity != "mass_drift"}
    return measured


def curves(runs):
    run = standard(runs)
    times, axes = semi_axes(run)
    fine = np.linspace(0, times[-1], 400)
    a, _ = exact(fine, strain_of(run))
    return [{"file": "semi_axes_exact", "x": "t", "y": "semi-axis / radius",
             "curves": [("Spume, x", times, axes[:, 0], "o"), ("Spume, y", times, axes[:, 1], "s"),
                        ("exact, x", fine, a, "-"), ("exact, y", fine, 1 / a, "--")]}]
