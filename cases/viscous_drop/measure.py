# SPDX-License-Identifier: MIT
"""Terminal velocity of a drop on the axis of a closed tube in creeping flow, against reference/hadamard_rybczynski.csv (kind
tube, K_own), for the radius that the volume of the drop's particles has. A quarter of the drop is computed, on the axis x = y = 0."""
from pathlib import Path

import numpy as np
from spume_tools.results import read_reference

PATH = Path(__file__).parent / "reference" / "hadamard_rybczynski.csv"
END = 0.1  # share of the run, at its end, over which velocities are means


def table(ratio):
    """Radius over that of the tube, terminal velocity over that of a rigid sphere in unbounded liquid."""
    read = read_reference(PATH, ("s_or_a_over_L", "U_over_UStokes"), {"kind": ("tube", "cubic")})
    own = [k for k, (kind, of) in enumerate(zip(read["kind"], read["l"]))
           if kind == "tube" and of != "rigid" and np.isclose(float(of), ratio)]
    return read["s_or_a_over_L"][own], read["U_over_UStokes"][own]


def viscosities(run):
    return [float(phase["viscosity"]) for phase in run.case["phase"]]


def tube(run):
    """Radius and length."""
    return float(run.case["body"][0]["radius"]), float(run.case["domain"]["upper"][2]) - float(run.case["domain"]["lower"][2])


def radius(run):
    """Of the ball that has the drop's share of the tube at the end: the liquids fill it."""
    drop, outside = (float(np.asarray(run.series[f"volume_{name}"])[-1]) for name in ("drop", "outside"))
    across, length = tube(run)
    return float(np.cbrt(3 / 4 * drop / (drop + outside) * across**2 * length))


def exact(run):
    """Between the radii of the table its logarithm is a parabola, through the three that are nearest."""
    outside, drop = viscosities(run)
    a = radius(run)
    s = a / tube(run)[0]
    known, over_stokes = table(drop / outside)
    near = np.argsort(np.abs(known - s))[:3]
    over = np.exp(np.polyval(np.polyfit(known[near], np.log(over_stokes[near]), 2), s))
    jump = float(run.case["phase"][1]["density"]) - float(run.case["phase"][0]["density"])
    return float(over) * 2 / 9 * jump * float(run.case["fluid"]["gravity"]) * a**2 / outside


def other_stress(ratio):
    """By how much a drop in unbounded liquid is faster where the stress is mu grad u, that of mu-laplacian, in place of 2 mu T.
    Both flows are u_r = cos(theta) (A / r + B / r^3) outside and cos(theta) (c + d r^2) inside, with a drag of 4 pi mu A; what
    is continuous at the sphere, mu d u_theta / dr without and with (d u_r / d theta - u_theta) / r, gives
    A / U = (3 + 12 l) / (4 + 8 l) and, after Hadamard and Rybczynski, (2 + 3 l) / (2 + 2 l)."""
    return (2 + 3 * ratio) / (2 + 2 * ratio) * (4 + 8 * ratio) / (3 + 12 * ratio) - 1


def mean_at_end(run, values):
    t = np.asarray(run.series["t"])
    values = np.broadcast_to(values, t.shape)
    return float(values[t >= (1 - END) * t[-1]].mean())


def shape(run):
    """Largest difference of the semi-axis along z from those across, over these, from second moments."""
    worst = 0.0
    for snapshot in run.snapshots():
        drop = snapshot.position[snapshot.field("phase") == 1]
        across = (np.mean(drop[:, 0] ** 2) + np.mean(drop[:, 1] ** 2)) / 2
        worst = max(worst, abs(float(np.sqrt(np.var(drop[:, 2]) / across)) - 1))
    return worst


def measure(runs):
    measured = {}
    for name, run in runs.items():
        t, speed, height = (np.asarray(run.series[key]) for key in ("t", "velocity_drop_z", "centre_drop_z"))
        late = t >= (1 - END) * t[-1]
        velocity = -mean_at_end(run, speed)
        excess = velocity / exact(run) - 1
        measured.update({
            f"{name}_velocity": velocity, f"{name}_excess": excess, f"{name}_error": abs(excess),
            # Of the way of the drop's particles, which the shift holds back.
            f"{name}_way_excess": float((height[late][0] - height[-1]) / (t[-1] - t[late][0]) / exact(run) - 1),
            f"{name}_change": abs(float(speed[-1] / speed[late][0] - 1)),
            f"{name}_out_of_round": shape(run),
            f"{name}_reynolds": float(run.case["phase"][0]["density"]) * 2 * radius(run) * velocity / viscosities(run)[0]})
    return measured


def curves(runs):
    lines = []
    for name, run in runs.items():
        t = np.asarray(run.series["t"])
        lines.append((name, t, -np.asarray(run.series["velocity_drop_z"]) / exact(run), "-"))
    end = max(float(run.series["t"][-1]) for run in runs.values())
    lines.append(("Hadamard, Rybczynski, in a tube", [0, end], [1, 1], "k--"))
    return [{"file": "velocity", "x": "t", "y": "velocity of the drop over the exact one", "curves": lines}]
