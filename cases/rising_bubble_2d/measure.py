# SPDX-License-Identifier: MIT
"""The bubble of Hysing et al. (2009), case 1, against the finest computation of their group 3 (reference/).

Circularity: perimeter of the circle of equal area over the perimeter of the interface. The interface is a closed curve
r(theta) about the centre of the bubble, a Fourier series of MODES modes that is fitted so that particles of the two
phases lie on their sides of it: least squares of the distances of the particles within a band from the curve, which in
the mean of a lattice are uniform on both sides. A circle on a lattice has a circularity of 1 within 0.001.

Rise velocity: that of the centre of mass, by cubics through its heights over WINDOW. The mean velocity of the particles
lacks what the shift, which moves particles without being part of their velocity, carries the bubble.
"""
from pathlib import Path

import numpy as np
from spume_tools.results import read_reference

REFERENCE = Path(__file__).parent / "reference"
MODES = 8
BAND = 1.5  # spacings
WINDOW = 0.2  # a fifth of the time to the largest velocity; its error there is below 1e-4 of that


def reference():
    """t, circularity, y of the centre of mass, rise velocity."""
    names = ("t", "circularity", "y_com", "rise_velocity")
    read = read_reference(REFERENCE / "hysing2009_case1_g3l4.csv", names)
    return np.column_stack([read[name] for name in names])


def table():
    """Extrema of the same computation, from all of its time steps."""
    return {"rise_velocity": 0.2416576, "rise_time": 0.9238585, "circularity": 0.9012524, "y_com": 1.081753}


def basis(angle, modes):
    order = np.arange(1, modes + 1)
    return np.hstack([np.ones((len(angle), 1)), np.cos(angle[:, None] * order), np.sin(angle[:, None] * order)])


def fitted_interface(position, inside, spacing):
    """Coefficients of r(theta) about the centre of the inner particles, and that centre."""
    centre = position[inside].mean(axis=0)
    away = position - centre
    radius, angle = np.hypot(away[:, 0], away[:, 1]), np.arctan2(away[:, 1], away[:, 0])
    size = np.sqrt(inside.sum() * spacing**2 / np.pi)
    coefficients = np.concatenate([[size], np.zeros(2 * MODES)])
    for _ in range(30):
        curve = basis(angle, MODES) @ coefficients
        near = np.abs(radius - curve) < BAND * spacing
        # The share of inner particles across the band falls from 1 to 0 at the curve: its integral tells where it is.
        excess = np.where(inside, 1.0, 0.0) - np.where(radius < curve, 1.0, 0.0)
        change, *_ = np.linalg.lstsq(basis(angle[near], MODES), 2 * BAND * spacing * excess[near], rcond=None)
        coefficients = coefficients + change
        if np.max(np.abs(change)) < 1e-5 * size:
            break
    return coefficients, centre


def circularity(position, inside, spacing):
    coefficients, _ = fitted_interface(position, inside, spacing)
    angle = np.linspace(0, 2 * np.pi, 2001)
    r = basis(angle, MODES) @ coefficients
    x, y = r * np.cos(angle), r * np.sin(angle)
    area = 0.5 * np.abs(np.sum(x[:-1] * y[1:] - x[1:] * y[:-1]))
    return 2 * np.sqrt(np.pi * area) / np.sum(np.hypot(np.diff(x), np.diff(y)))


def centre_velocity(t, height):
    """Times, a hundredth apart, and the velocity of the centre."""
    times = np.arange(t[0] + WINDOW / 2, t[-1] - WINDOW / 2, 0.01)
    velocity = []
    for middle in times:
        near = np.abs(t - middle) < WINDOW / 2
        velocity.append(np.polyfit(t[near] - middle, height[near], 3)[-2])
    return times, np.array(velocity)


def errors(run):
    known, extrema, series = reference(), table(), run.series
    t, height, of_particles = (np.asarray(series[key]) for key in ("t", "centre_bubble_y", "velocity_bubble_y"))
    times, speed = centre_velocity(t, height)
    spacing = float(run.case["resolution"]["spacing"])
    shapes = [(s.time, circularity(s.position[:, :2], s.field("phase") == 1, spacing)) for s in run.snapshots()]
    differences = [abs(value - np.interp(time, known[:, 0], known[:, 1])) for time, value in shapes]
    # Methods that solve for the pressure alone watch the volume; others keep it by their densities.
    area = np.asarray(series["volume_bubble"]) if "volume_bubble" in series else None
    drift = {} if area is None else {"area_drift": float(np.max(np.abs(area / area[0] - 1)))}
    return {
        "y_com": float(height[-1]),
        "y_com_error": abs(float(height[-1] - np.interp(t[-1], known[:, 0], known[:, 2]))),
        "rise_velocity": float(speed.max()),
        "rise_velocity_error": abs(float(speed.max()) / extrema["rise_velocity"] - 1),
        "mean_of_particles_error": abs(float(of_particles.max()) / extrema["rise_velocity"] - 1),
        "rise_time_error": abs(float(times[speed.argmax()]) / extrema["rise_time"] - 1),
        "circularity": float(min(value for _, value in shapes)),
        "circularity_error": float(max(differences)),
        **drift,
    }


def measure(runs):
    """Of the run "bubble" without its name before them."""
    return {key if name == "bubble" else f"{name}_{key}": value
            for name, run in runs.items() for key, value in errors(run).items()}


def curves(runs):
    known = reference()
    rise, speed = [], []
    for name, run in runs.items():
        rise.append((f"Spume, {name}", run.series["t"], run.series["centre_bubble_y"], "-"))
        times, velocity = centre_velocity(np.asarray(run.series["t"]), np.asarray(run.series["centre_bubble_y"]))
        speed.append((f"Spume, {name}", times, velocity, "-"))
    rise.append(("Hysing et al., group 3", known[:, 0], known[:, 2], "k--"))
    speed.append(("Hysing et al., group 3", known[:, 0], known[:, 3], "k--"))
    return [{"file": "height", "x": "t", "y": "y of the centre of mass", "curves": rise},
            {"file": "rise_velocity", "x": "t", "y": "rise velocity", "curves": speed}]
