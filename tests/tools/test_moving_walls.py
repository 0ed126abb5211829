# SPDX-License-Identifier: MIT
"""Pictures of tanks whose sides move: where walls are drawn, and how far the frame reaches."""
import unittest

import paths
import numpy as np
from matplotlib.colors import to_rgb
from spume_tools.plots import planes, style, views
from spume_tools.plots.request import DrawnRun, Request
from spume_tools.plots.walls import bounds_at, farthest_bounds
from synthetic import lattice, new_folder, series_of, write_case, write_snapshots, write_table
from test_tools import Scratch

SPEED = 0.3


def write_moving_tank(folder, dimensions=2):
    """Liquid 0.5 deep between walls at 0.3 t and 1.3 + 0.3 t, with the pressure x; the series has every tenth of a second."""
    deep = {} if dimensions == 2 else {"front": "free-slip", "back": "free-slip"}
    still = ["0"] * (dimensions - 1)
    write_case(folder, "Tank that moves", [0] * dimensions, [1.3] + [1.0] * (dimensions - 1), 0.05, left="free-slip", right="free-slip",
               bottom="free-slip", **deep, **{f"wall_velocity.{side}": [str(SPEED), *still] for side in ("left", "right")})
    times = 0.1 * np.arange(21)
    write_table(folder / "series.csv", series_of(times, surface_particles=10, kinetic_energy=1, wall_left=SPEED * times,
                                                 wall_right=1.3 + SPEED * times))
    grid = lattice([0] * dimensions, [1.3] + [1.0] * (dimensions - 2) + [0.5], 0.05)
    write_snapshots(folder / "fluid.vtkhdf", [0, 1, 2], lambda t: grid + SPEED * t * np.eye(dimensions)[0],
                    {"pressure": lambda p, t: p[:, 0]})


class MovingWalls(Scratch):
    def test_sides_are_where_the_series_has_them(self):
        folder = new_folder(self.path, "run")
        write_moving_tank(folder)
        run = DrawnRun(folder)
        np.testing.assert_allclose(bounds_at(run, 1.55), [[0.465, 0], [1.765, 1]])
        np.testing.assert_allclose(farthest_bounds(run), [[0, 0], [1.9, 1]])

    def test_sides_of_runs_that_do_not_record_them_stay(self):
        folder = new_folder(self.path, "run")
        write_moving_tank(folder)
        write_table(folder / "series.csv", series_of([0, 2], kinetic_energy=1))
        np.testing.assert_allclose(bounds_at(DrawnRun(folder), 1), [[0, 0], [1.3, 1]])
        (folder / "series.csv").unlink()
        np.testing.assert_allclose(bounds_at(DrawnRun(folder), 1), [[0, 0], [1.3, 1]])

    def test_planes_show_all_of_the_liquid_between_walls_that_have_moved(self):
        folder = new_folder(self.path, "run")
        write_moving_tank(folder)
        run = DrawnRun(folder)
        plane, panels = planes.panels_of(run, "pressure", run.snapshots(), [0, 2])
        figure = planes.plane_figure(run, "pressure", plane, panels, style.Normalize(0, 2), "neither")
        first, last = figure.axes[:2]
        np.testing.assert_allclose(last.get_xlim(), (0, 1.9), atol=1e-9)
        drawn = np.isfinite(panels[1].values[:, panels[1].values.shape[1] // 2])
        self.assertTrue(drawn.all())
        np.testing.assert_allclose(panels[1].extent[:2], (0.6, 1.9), atol=0.002)  # a pixel
        thick = [(axis.spines["left"].get_linewidth() > 2, axis.spines["right"].get_linewidth() > 2) for axis in (first, last)]
        self.assertEqual(thick, [(True, False), (False, True)])
        behind = [[patch.get_bbox().intervalx for patch in axis.patches if patch.get_facecolor()[:3] == to_rgb(style.SOLID)]
                  for axis in (first, last)]
        np.testing.assert_allclose(behind, [[(1.3, 1.9)], [(0, 0.6)]], atol=1e-9)
        style.plt.close(figure)

    def test_the_view_shows_all_of_the_liquid_and_the_tank_where_it_is(self):
        folder = new_folder(self.path, "run")
        write_moving_tank(folder, 3)
        run = DrawnRun(folder, Request())
        snapshots = run.snapshots()
        stage = views.Stage(run, snapshots, [0, 2])
        np.testing.assert_allclose((stage.lower[0], stage.upper[0]), (0, 1.9), atol=1e-9)
        for step, ends in ((0, (0, 1.3)), (2, (0.6, 1.9))):
            low, high = stage.box_at(snapshots.times[step])
            np.testing.assert_allclose((low[0], high[0]), ends, atol=1e-9)
            liquid = views.liquid_of(stage, snapshots[step])
            np.testing.assert_allclose(liquid.GetBounds()[:2], ends, atol=1e-3)


if __name__ == "__main__":
    unittest.main()
