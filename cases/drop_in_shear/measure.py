# SPDX-License-Identifier: MIT
"""Deformation D = (L - B) / (L + B) of a drop in simple shear and the angle of its long axis to the flow, from the second
moments of its particles, against Taylor's with the correction for walls, reference/taylor_drop_in_shear.csv."""
from pathlib import Path

import numpy as np
from spume_tools.results import read_reference

TABLE = read_reference(Path(__file__).parent / "reference" / "taylor_drop_in_shear.csv",
                       ("l", "Ca", "D_cox", "tau_over_mu_a_sigma", "wall_factor_a_over_H_0.125"))
CAPILLARY = 0.05


def expected(run):
    """That of Taylor, that of Cox for a drop that turns while it is stretched, both with the factor of the walls."""
    ratio = float(run.case["phase"][1]["viscosity"]) / float(run.case["phase"][0]["viscosity"])
    row = np.flatnonzero(np.isclose(TABLE["l"], ratio) & np.isclose(TABLE["Ca"], CAPILLARY))[0]
    walls = TABLE["wall_factor_a_over_H_0.125"][row]
    return CAPILLARY * (19 * ratio + 16) / (16 * ratio + 16) * walls, TABLE["D_cox"][row] * walls


def shape(snapshot):
    """D and the angle in degrees. Of an ellipsoid the mean square along a semi-axis is a fifth of its square."""
    drop = snapshot.position[snapshot.field("phase") == 1]
    x, z = drop[:, 0] - drop[:, 0].mean(), drop[:, 2] - drop[:, 2].mean()
    squares, axes = np.linalg.eigh([[np.mean(x * x), np.mean(x * z)], [np.mean(x * z), np.mean(z * z)]])
    short, long = np.sqrt(squares)
    return float((long - short) / (long + short)), float(np.degrees(np.arctan2(axes[1, 1], axes[0, 1])) % 180)


def measure(runs):
    measured = {}
    for name, run in runs.items():
        deformation, angle = shape(run.snapshots()[-1])
        taylor, cox = expected(run)
        measured.update({f"{name}_deformation": deformation, f"{name}_angle": angle,
                         f"{name}_deformation_error": abs(deformation / taylor - 1),
                         f"{name}_cox_error": abs(deformation / cox - 1)})
    if "ratio_1" in runs and "ratio_1_coarse" in runs:
        measured["error_ratio"] = measured["ratio_1_deformation_error"] / measured["ratio_1_coarse_deformation_error"]
    return measured


def curves(runs):
    lines = []
    for name, run in runs.items():
        snapshots = run.snapshots()
        lines.append((name, [s.time for s in snapshots], [shape(s)[0] for s in snapshots], "o-"))
        lines.append((f"Taylor, walls: {name}", [0, snapshots[-1].time], [expected(run)[0]] * 2, "k--"))
    return [{"file": "deformation", "x": "time times the rate of shear", "y": "(L - B) / (L + B)", "curves": lines}]
