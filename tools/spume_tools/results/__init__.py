# SPDX-License-Identifier: MIT
"""What a run left in its folder, as numpy arrays.

    from spume_tools.results import Results
    run = Results("runs/breaking_wave-1")
    run.series["t"], run.series["kinetic_energy"]     one row per step
    run.probes["front"]                               one row per step
    run.line("centre", -1)["velocity_x"]              one profile, here of the last time
    run.snapshots("fluid")[-1].position               (N, 3), with .time and .fields["velocity"] (N, 3)
    run.snapshots("fluid")[-1].field("velocity")      (nx, ny, nz, 3) where the flow lives on a grid
    run.case["resolution"]["spacing"]                 the resolved case file
    run.refresh().series                              with what a run that goes on has written since

Every reader raises MissingResult, with the path and what would have written it, when there is nothing to read, and
DamagedResult, one of its kind, when what is there is not what it should be.
"""
from .bubbles import bubble_radii, bubble_traces, density, hinze_radius, slope, surface_tension
from .errors import DamagedResult, MissingResult
from .norms import observed_order, relative_rms, standard
from .run import Results, read_case
from .snapshots import Fields, GridSnapshot, GridSnapshots, Snapshot, Snapshots
from .tables import Table, read_csv, read_reference

__all__ = ["DamagedResult", "Fields", "GridSnapshot", "GridSnapshots", "MissingResult", "Results", "Snapshot", "Snapshots",
           "Table", "bubble_radii", "bubble_traces", "density", "hinze_radius", "observed_order", "read_case", "read_csv",
           "read_reference", "relative_rms", "slope", "standard", "surface_tension"]
