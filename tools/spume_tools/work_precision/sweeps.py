# SPDX-License-Identifier: MIT
"""The sweeps of work_precision: cases with an exact or independent answer, their error, and what is varied."""
from dataclasses import dataclass, field

import numpy as np

from ..case_file import toml_text, toml_value
from ..results import relative_rms
from ..verify.cases import case_folder, load_measure


@dataclass
class Sweep:
    case: object  # name of a case of cases/, or the sections of one
    quantity: str
    error: object  # of Results
    resolutions: dict  # label: settings
    options: dict = field(default_factory=dict)
    until: float = None
    default: str = "default"  # what the picture calls a run without options

    def folder(self, scratch):
        if isinstance(self.case, str):
            return case_folder(self.case)
        (scratch / "case.toml").write_text(toml_text(self.case), encoding="utf-8")
        return scratch

    def settings_of(self, option, value):
        return [f"{option}={toml_value(value)}"]


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
    "shifting.velocity_correction": ["none", "second-order"], "shifting.coefficient": [0.1, 0.2],
    "turbulence.model": ["mixed-scale", "smagorinsky", "dynamic-lagrangian"]}


# Only the step errs, and the case's own integrator is not the default.
BELTRAMI_STEPS = {f"dt {dt:g}": [f"time.max_step={dt!r}", 'spectral.integrator="ab2"']
                  for dt in (0.008, 0.004, 0.002, 0.001)}


POISEUILLE = ['domain.wall_velocity.top=["0", "0"]', 'forces.body=["0.8", "0"]']


def vortex_error(run):
    """Velocity at the end, for a fluid of groups and for a phase."""
    module = load_measure(case_folder("taylor_green_2d"))
    last, given = run.snapshots()[-1], run.case.get("fluid", {}).get("reynolds")
    reynolds = float(given) if given else run.case["phase"][0]["density"] / run.case["phase"][0]["viscosity"]
    exact = module.exact_velocity(last.position, last.time, reynolds)
    return relative_rms(last.field("velocity")[:, :2], exact, 1.0)


def early_energy_error(run):
    """Of the mean energy up to t = 3, when the smallest eddies of 32^3 points are resolved, relative to the start."""
    reference = load_measure(case_folder("taylor_green_1600")).REFERENCE
    t, energy = run.series["t"], run.series["mean_energy"]  # rows at times of the reference
    return float(np.max(np.abs(energy - np.interp(t, reference["t"], reference["E"])))) / 0.125


TRACER_PERIODS, TRACER_VISCOSITY, TRACER_MEAN = 2, 0.02, (0.3, 0.2, 0.9)
TRACERS = {"method": "spectral",
           "domain": {"lower": [0.0] * 3, "upper": [1.0] * 3, "x": "periodic", "y": "periodic", "z": "periodic"},
           "resolution": {"grid": 32}, "fluid": {"reynolds": 1 / TRACER_VISCOSITY},
           "initial": {"kind": "expressions",
                       "velocity": [f"{TRACER_MEAN[0]} + cos({2 * TRACER_PERIODS}*pi*z)",
                                    f"{TRACER_MEAN[1]} - sin({2 * TRACER_PERIODS}*pi*z)", str(TRACER_MEAN[2])]},
           "particles": {"count": 100000, "diameter": 1e-3, "beta": 1.0, "response_time": 1e-3, "overlap_samples": 0},
           "output": {"every": 0.5, "series_every": 0.5}, "time": {"end": 0.5}}


def tracer_error(run):
    """Of the places of tracers in a wave that is carried along z and decays: each stays at its phase k z_0, where the
    velocity is known. Root mean square, over a wavelength."""
    snapshots = run.snapshots("bubbles")
    first, last = snapshots[0], snapshots[-1]
    start, end = (shot.position[np.argsort(shot.fields["id"])] for shot in (first, last))
    k, t = 2 * np.pi * TRACER_PERIODS, run.series["t"][-1]
    rate = TRACER_VISCOSITY * k**2
    wave = np.column_stack([np.cos(k * start[:, 2]), -np.sin(k * start[:, 2]), np.zeros(len(start))])
    moved = end - start - np.array(TRACER_MEAN) * t - wave * (1 - np.exp(-rate * t)) / rate
    return float(np.sqrt(np.mean(np.sum((moved - np.round(moved)) ** 2, axis=1)))) * TRACER_PERIODS


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
    # Methods on the same flow.
    "methods_taylor_green": Sweep("taylor_green_2d", "velocity error at t = 1", vortex_error, spacings(20, 40, 80),
                                  {"method": ["wcsph"]}, 1.0, "method = les-sph"),
    "methods_poiseuille": Sweep("couette_poiseuille", "velocity error, rms over the peak", of_case("couette_poiseuille", "error"),
                                {label: settings + POISEUILLE for label, settings in spacings(20, 40, 80).items()},
                                {"method": ["wcsph"]}, 1.0, "method = les-sph"),
    # Without the case's own step, which is shorter than what the options allow; from where the wave is higher than half
    # a spacing on: below, its columns hold one particle more or not, and the amplitude errs by 6 to 8 %.
    "standing_wave": Sweep("standing_wave", "amplitude over a period, largest difference from the exact",
                           of_case("standing_wave", "largest_difference"),
                           {label: settings + ["time.max_step=1.0"] for label, settings in spacings(48, 64, 96).items()},
                           PARTICLE_OPTIONS | {"time.courant": [0.1, 0.2, 0.4]}, 2.5066282747),
    "beltrami": Sweep("beltrami_exact", "velocity error at t = 0.5", of_case("beltrami_exact", "velocity_error"),
                      BELTRAMI_STEPS, {"spectral.integrator": ["rk3", "rk4"], "spectral.precision": ["single"],
                                       "spectral.dealiasing": ["two-thirds", "none"]}),
    "taylor_green_3d": Sweep("taylor_green_1600", "energy error up to t = 3", early_energy_error,
                             {f"{n}^3": [f"resolution.grid={n}", 'spectral.integrator="ab2"', "time.courant=0.2",
                                         "output.series_every=0.5"] for n in (16, 24, 32, 48)},
                             {"spectral.integrator": ["rk3", "rk4"], "spectral.dealiasing": ["two-thirds", "none"],
                              "spectral.precision": ["single"], "time.courant": [0.05, 0.1, 0.4]}, 3.0),
    "tracers": Sweep(TRACERS, "place of tracers at t = 0.5, over a wavelength", tracer_error,
                     {f"{n}^3": [f"resolution.grid={n}"] for n in (8, 16, 32)},
                     {"particles.spline_order": [2, 6], "particles.records": ["double"], "spectral.integrator": ["rk4"],
                      "spectral.precision": ["single"], "time.courant": [0.05, 0.1, 0.4],
                      "particles.sort_every": [1, 32]}),
    "terminal_velocity": Sweep(RISING, "slip over terminal speed - 1", slip_error, spacings(8, 12, 16),
                               {"time.max_step": [0.04, 0.01, 0.003], "bubbles.integrator": ["substep"],
                                "bubbles.momentum_form": ["two-fluid"], "time.courant": [0.1, 0.4],
                                "pressure.tolerance": [1e-4, 1e-8]}),
}
