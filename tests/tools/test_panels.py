# SPDX-License-Identifier: MIT
"""How large panels are, and what stands beside the bars of the ledger."""
import unittest

import paths
from spume_tools.plots import planes, style
from spume_tools.plots.request import DrawnRun
from spume_tools.plots.series import cost_of
from synthetic import lattice, new_folder, write_case, write_snapshots
from test_tools import Scratch


class Panels(Scratch):
    def test_narrow_panels_are_as_tall_as_the_page(self):
        folder = new_folder(self.path, "run")
        write_case(folder, "A column", [0, 0], [0.2, 2.2], 0.025, left="free-slip", right="free-slip", bottom="free-slip")
        write_snapshots(folder / "fluid.vtkhdf", [0, 1, 2, 3], lambda t: lattice([0, 0], [0.2, 2.0], 0.025),
                        {"pressure": lambda p, t: p[:, 1]})
        run = DrawnRun(folder)
        plane, panels = planes.panels_of(run, "pressure", run.snapshots(), range(4))
        figure = planes.plane_figure(run, "pressure", plane, panels, style.Normalize(0, 2), "neither")
        figure.savefig(self.path / "drawn.png")
        for axis in figure.axes[:4]:
            self.assertGreater(axis.get_position().height * figure.get_figheight(), 0.9 * 7)
            self.assertGreater(axis.get_tightbbox(figure.canvas.get_renderer()).x0, 0)
        style.plt.close(figure)

    def test_the_cost_of_a_stage_is_in_the_unit_of_its_size(self):
        stage = lambda seconds, particles, pairs: {"seconds": seconds, "particles": particles, "pairs": pairs}
        for one, words in ((stage(1.0, 5, 4e8), "2.5 ns per pair"), (stage(1.0, 1e7, 0), "100 ns per point"),
                           (stage(0.36, 1e5, 0), "3.6 µs per point"), (stage(3, 100, 0), "30 ms per point"),
                           (stage(0.00275, 0, 0), "0.00275 s"), (stage(9.996e-7, 1, 0), "1 µs per point")):
            self.assertEqual(cost_of(one, "point"), words)


if __name__ == "__main__":
    unittest.main()
