# SPDX-License-Identifier: MIT
"""The bubble of Joubert et al., section 3.3: terminal velocity, range of the pressure and shape, and by how much the bubble is
faster with (12), mu-laplacian, than with the others. A quarter is computed, on the axis x = y = 0."""
from pathlib import Path

import numpy as np
from spume_tools.results import read_reference

DIFFUSIONS = ("mu-laplacian", "printed")
TABLE = read_reference(Path(__file__).parent / "reference" / "joubert.csv", ("pressure_range", "velocity_excess"),
                       {"diffusion": DIFFUSIONS})
TERMINAL = 5.0  # from then on velocities are means
CELL = 8
CONES = 12


def published(diffusion, quantity):
    return float(TABLE[quantity][list(TABLE["diffusion"]).index(diffusion)])


def diffusion(run):
    return run.case.get("momentum", {}).get("diffusion", "split")


def terminal_velocity(run):
    """Mean from TERMINAL on, and by how much the mean of the second half of that is larger, over it."""
    t, speed = np.asarray(run.series["t"]), np.asarray(run.series["velocity_bubble_z"])
    late, middle = t >= TERMINAL, (TERMINAL + t[-1]) / 2
    mean = float(speed[late].mean())
    return mean, float(speed[t >= middle].mean() - speed[late & (t < middle)].mean()) / mean


def pressure_range(run, snapshot):
    """Of the pressure that buoyancy leaves, p + rho g z of the liquid, within a diameter of the bubble's centre; of means over
    cells of about CELL particles, without which the range is that of the noise and grows with the number of particles."""
    position, pressure = snapshot.position, snapshot.field("pressure")
    liquid = run.case["phase"][0]
    reduced = pressure + float(liquid["density"]) / float(run.case["fluid"]["froude"]) ** 2 * position[:, 2]
    from_centre = position - [0, 0, position[snapshot.field("phase") == 1][:, 2].mean()]
    near = np.sum(from_centre**2, axis=1) < 1
    edge = np.cbrt(CELL) * float(run.case["resolution"]["spacing"])
    _, cell = np.unique(np.floor(from_centre[near] / edge), axis=0, return_inverse=True)
    count, total = np.bincount(cell.ravel()), np.bincount(cell.ravel(), reduced[near])
    return float(np.ptp(total[count >= CELL / 2] / count[count >= CELL / 2]))


def size(snapshot):
    """Width and height of the ellipsoid that has the second moments of the bubble, and the share of its particles farther
    than 1.5 radii from its centre, which it has left behind."""
    bubble = snapshot.position[snapshot.field("phase") == 1]
    z = bubble[:, 2] - bubble[:, 2].mean()
    across = (bubble[:, 0] ** 2 + bubble[:, 1] ** 2) / 2
    kept = across * 2 + z**2 < 1.5**2 / 4
    z = z[kept] - z[kept].mean()
    return float(2 * np.sqrt(5 * across[kept].mean())), float(2 * np.sqrt(5 * np.mean(z**2))), float(1 - kept.mean())


def measure(runs):
    measured = {}
    for name, run in runs.items():
        last = run.snapshots()[-1]
        velocity, growth = terminal_velocity(run)
        width, height, left = size(last)
        pressure = pressure_range(run, last)
        measured.update({f"{name}_velocity": velocity, f"{name}_growth": growth, f"{name}_width": width,
                         f"{name}_height": height, f"{name}_left_behind": left,
                         f"{name}_pressure_range": pressure})
        if diffusion(run) in DIFFUSIONS:
            measured[f"{name}_pressure_error"] = abs(pressure / published(diffusion(run), "pressure_range") - 1)
    for name in [name for name in runs if name.endswith("mu_laplacian")]:
        resolution = name.removesuffix("mu_laplacian")
        for other in ("printed", "split"):
            if resolution + other in runs:
                measured[f"{resolution}excess_over_{other}"] = (
                    measured[f"{name}_velocity"] / measured[f"{resolution}{other}_velocity"] - 1)
    return measured


def outline(run, snapshot):
    """Distance from the axis and height from the centre: in cones of equal solid angle about the centre the radii of the
    bubble that have the volume of its particles there."""
    bubble = snapshot.position[snapshot.field("phase") == 1]
    z = bubble[:, 2] - bubble[:, 2].mean()
    cosine = z / np.sqrt(bubble[:, 0] ** 2 + bubble[:, 1] ** 2 + z**2)
    count, edges = np.histogram(cosine, CONES, (-1, 1))
    volume = count * float(run.case["resolution"]["spacing"]) ** 3
    radius = np.cbrt(3 * volume / (np.pi / 2 * np.diff(edges)))  # a quarter of the bubble
    middle = (edges[1:] + edges[:-1]) / 2
    return radius * np.sqrt(1 - middle**2), radius * middle


def curves(runs):
    speeds = [(name, run.series["t"], run.series["velocity_bubble_z"], "-") for name, run in runs.items()]
    shapes = [(name, *outline(run, run.snapshots()[-1]), "o-") for name, run in runs.items()]
    return [{"file": "velocity", "x": "t", "y": "rise velocity", "curves": speeds},
            {"file": "shape", "x": "distance from the axis", "y": "height from the centre", "curves": shapes}]
