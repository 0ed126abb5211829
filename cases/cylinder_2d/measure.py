# SPDX-License-Identifier: MIT
"""Flow past a cylinder in a channel after Schaefer and Turek (1996), against reference/schaefer_turek_1996.csv.

2D-1, steady: coefficients of drag and lift and the pressure difference between front and back of the cylinder, averaged
over the last third of a run. 2D-2, runs whose name begins with "vortices": Strouhal number and largest drag of the
oscillation that fits the second half of a run, a fundamental of lift and drag and its first four harmonics: forces
scatter from step to step by more than the drag oscillates."""
from pathlib import Path

import numpy as np
from spume_tools.results import read_reference

TABLE = read_reference(Path(__file__).parent / "reference" / "schaefer_turek_1996.csv", (),
                       {"case": ("2D-1", "2D-2")})
REFERENCE = {case: {quantity: float(value) for own, quantity, value in
                    zip(TABLE["case"], TABLE["quantity"], TABLE["value"]) if own == case and value not in ("", "nan")}
             for case in ("2D-1", "2D-2")}
DIAMETER = 0.1
MEAN_SPEED = {"2D-1": 0.2, "2D-2": 1.0}
HARMONICS = 4


def case_of(name):
    return "2D-2" if name.startswith("vortices") else "2D-1"


def coefficients(run, case):
    """Times, drag and lift."""
    forces = run.table("bodies")
    scale = 2 / (MEAN_SPEED[case]**2 * DIAMETER)
    drag, lift = (scale * (forces[f"pressure_force_{axis}"] + forces[f"viscous_force_{axis}"]) for axis in "xy")
    return forces["t"], drag, lift


def harmonics(t, frequency, count):
    """Columns 1, cos and sin of the first `count` multiples of a frequency."""
    phase = 2 * np.pi * frequency * t
    return np.column_stack([np.ones_like(t)] + [f(n * phase) for n in range(1, count + 1) for f in (np.cos, np.sin)])


def misfit(t, values, frequency):
    basis = harmonics(t, frequency, 1)
    return float(np.sum((values - basis @ np.linalg.lstsq(basis, values, rcond=None)[0])**2))


def shedding(run):
    """Strouhal number, largest drag and largest lift of the oscillation in the second half of a run."""
    t, drag, lift = coefficients(run, "2D-2")
    late = t > t[-1] / 2
    t, drag, lift = t[late], drag[late], lift[late]
    scale = MEAN_SPEED["2D-2"] / DIAMETER
    # Among the Strouhal numbers of bluff bodies, then finer around the best.
    frequencies, step = np.linspace(0.15, 0.5, 351) * scale, 0.001 * scale
    for _ in range(3):
        best = min(frequencies, key=lambda f: misfit(t, lift, f))
        frequencies, step = np.linspace(best - step, best + step, 41), step / 20
    one = np.linspace(0, 1 / best, 400)
    largest = []
    for values in (drag, lift):
        fit = np.linalg.lstsq(harmonics(t, best, HARMONICS), values, rcond=None)[0]
        largest.append(float(np.max(harmonics(one, best, HARMONICS) @ fit)))
    return best / scale, *largest


def measure(runs):
    values = {}
    for name, run in runs.items():
        case = case_of(name)
        reference = REFERENCE[case]
        if case == "2D-2":
            strouhal, drag, lift = shedding(run)
            values |= {f"{name}_strouhal": strouhal, f"{name}_strouhal_error": abs(strouhal / reference["St"] - 1),
                       f"{name}_largest_drag": drag,
                       f"{name}_largest_drag_error": abs(drag / reference["C_D max"] - 1),
                       f"{name}_largest_lift": lift}
            continue
        t, drag, lift = coefficients(run, case)
        steady = t > 2 / 3 * t[-1]
        probes = run.probes
        late = probes["t"] > 2 / 3 * probes["t"][-1]
        difference = np.mean((probes["front_pressure"] - probes["back_pressure"])[late])
        values |= {f"{name}_drag": float(np.mean(drag[steady])),
                   f"{name}_drag_error": float(abs(np.mean(drag[steady]) / reference["C_D"] - 1)),
                   f"{name}_lift": float(np.mean(lift[steady])),
                   f"{name}_pressure_difference": float(difference),
                   f"{name}_pressure_error": float(abs(difference / reference["dp"] - 1))}
    if {"across_10", "across_40"} <= runs.keys():
        values["pressure_error_ratio"] = values["across_40_pressure_error"] / values["across_10_pressure_error"]
    return values


def curves(runs):
    figures = []
    for case, file in (("2D-1", "drag"), ("2D-2", "shedding")):
        lines, last = [], 0.0
        for name, run in runs.items():
            if case_of(name) != case:
                continue
            t, drag, lift = coefficients(run, case)
            last = max(last, t[-1])
            lines.append((name if case == "2D-1" else f"{name}, drag", t[1:], drag[1:], "-"))
            if case == "2D-2":
                lines.append((f"{name}, lift", t[1:], lift[1:], "-"))
        if not lines:
            continue
        values = {"2D-1": {"drag": "C_D"}, "2D-2": {"largest drag": "C_D max"}}[case]
        for label, quantity in values.items():
            lines.append((f"Schaefer and Turek (1996), {label}", np.array([0, last]),
                          np.full(2, REFERENCE[case][quantity]), "k--"))
        figures.append({"file": file, "x": "t", "y": "drag coefficient" if case == "2D-1" else "coefficient",
                        "curves": lines})
    return figures
