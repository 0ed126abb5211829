# SPDX-License-Identifier: MIT
"""The sweeps of work_precision: cases with an exact or independent answer, their error, and what is varied."""
import sys
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools"))
from spume_stress_scenes import toml_text
from spume_verification import case_folder, load_measure


def quoted(value):
    if isinstance(value, bool):
        return "true" if value else "false"
    return f'"{value}"' if isinstance(value, str) else repr(value)


@dataclass
class Sweep:
    case: object  # name of a case of cases/, or the sections of one
    quantity: str
    error: object  # of Results
    resolutions: dict  # label: settings
    options: dict = field(default_factory=dict)
    until: float = None

    def folder(self, scratch):
        if isinstance(self.case, str):
            return case_folder(self.case)
        (scratch / "case.toml").write_text(toml_text(self.case), encoding="utf-8")
        return scratch

    def settings_of(self, option, value):
        return [f"{option}={quoted(value)}"]


def spacings(*values):
    return {f"1/{n}": [f"resolution.spacing={1 / n!r}"] for n in values}


def of_case(name, quantity):
    """The error that the case's own measure.py defines."""
    return lambda run: load_measure(case_folder(name)).errors(run)[quantity]


# What every les-sph run can trade for time. Each list leaves out the default.
PARTICLE_OPTIONS = {
    "time.courant": [0.1, 0.3, 0.4], "pressure.tolerance": [1e-3, 1e-4, 1e-8], "pressure.precision": ["double"],
    "pressure.preconditioner": ["jacobi"], "pressure.solver": ["cg"], "resolution.smoothing_ratio": [1.2, 1.5, 1.8],
    "resolution.kernel": ["quintic-spline"], "time.centred": [False], "fluid.mach": [0.0, 0.1],
    "shifting.velocity_correction": ["none", "second-order"], "shifting.coefficient": [0.1, 0.4]}


def wave_error(run):
    """Phase and amplitude after one period."""
    found = load_measure(case_folder("standing_wave")).errors(run)
    return max(found["phase_error"], found["amplitude_error"])


BELTRAMI_STEPS = {f"dt {dt:g}": [f"time.max_step={dt!r}"] for dt in (0.008, 0.004, 0.002, 0.001)}


def early_energy_error(run):
    """Of the mean energy up to t = 3, when the smallest eddies of 32^3 points are resolved, relative to the start."""
    return load_measure(case_folder("taylor_green_1600")).energy_error(run, 3) / 0.125


TERMINAL_RADIUS, TERMINAL_VISCOSITY, TERMINAL_RATIO = 0.02, 1e-3, 1000 / 1.2


def terminal_speed():
    """Balance of the drag law of King et al. (2022), eq. 2.9, with buoyancy, gravity 1; by bisection."""
    low, high = 0.0, 10.0
    for _ in range(200):
        w = (low + high) / 2
        re = 2 * TERMINAL_RADIUS * w / TERMINAL_VISCOSITY
        drag = 0.44 if re > 1000 else 24 / max(re, 1e-30) * (1 + 0.15 * re**0.687)
        low, high = (w, high) if 0.375 * drag * w * w / TERMINAL_RADIUS < 1 - 1 / TERMINAL_RATIO else (low, w)
    return (low + high) / 2


def slip_error(run):
    """Slip of one bubble over its terminal speed, mean of the second half of the run."""
    t, slip = run.series["t"], run.series["bubble_slip"]
    return abs(float(np.mean(slip[t > t[-1] / 2])) / terminal_speed() - 1)


RISING = {"method": "les-sph",
          "domain": {"lower": [0.0] * 3, "upper": [1.0] * 3, "x": "periodic", "y": "periodic", "z": "periodic"},
          "resolution": {"spacing": 0.1}, "fluid": {"reynolds": 1000.0, "froude": 1.0, "mach": 0.05},
          "forces": {"body": ["0", "0", "1"]}, "liquid": [{}],
          "bubbles": {"weber": 100.0, "density_ratio": TERMINAL_RATIO},
          "bubble_cloud": [{"centre": [0.6, 0.6, 0.3], "bubble_radius": TERMINAL_RADIUS}],
          "time": {"end": 0.6}}

SWEEPS = {
    "taylor_green_2d": Sweep("taylor_green_2d", "velocity error at t = 1",
                             of_case("taylor_green_2d", "velocity_error"), spacings(20, 40, 80), PARTICLE_OPTIONS, 1.0),
    "standing_wave": Sweep("standing_wave", "phase or amplitude error after a period", wave_error, spacings(24, 32, 48),
                           {"time.max_step": [0.025, 0.00625]} | {k: v for k, v in PARTICLE_OPTIONS.items() if k != "time.courant"},
                           2.506628275),
    "beltrami": Sweep("beltrami_exact", "velocity error at t = 0.5", of_case("beltrami_exact", "velocity_error"),
                      BELTRAMI_STEPS, {"spectral.integrator": ["ab2", "rk3"], "spectral.precision": ["single"],
                                       "spectral.dealiasing": ["two-thirds", "none"]}),
    "taylor_green_3d": Sweep("taylor_green_1600", "energy error up to t = 3", early_energy_error,
                             {f"{n}^3": [f"resolution.grid={n}", 'spectral.integrator="ab2"'] for n in (16, 24, 32, 48)},
                             {"spectral.integrator": ["rk3", "rk4"], "spectral.dealiasing": ["two-thirds", "none"],
                              "spectral.precision": ["single"], "time.courant": [0.2, 0.8]}, 3.0),
    "terminal_velocity": Sweep(RISING, "slip over terminal speed - 1", slip_error, spacings(8, 12, 16),
                               {"time.max_step": [0.04, 0.01, 0.003], "bubbles.integrator": ["substep"],
                                "bubbles.closure": ["two-fluid"], "time.courant": [0.1, 0.4],
                                "pressure.tolerance": [1e-4, 1e-8]}),
}
