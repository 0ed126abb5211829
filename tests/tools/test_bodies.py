# SPDX-License-Identifier: MIT
"""Bodies in what `spume check` says and in bodies.vtp. Needs build/release/spume."""
import subprocess
import unittest

import paths
import numpy as np
from test_tools import Scratch

CASE = """method = "les-sph"
[domain]
lower = [0, 0, 0]
upper = [1, 1, 1]
bottom = "free-slip"
left = "free-slip"
right = "free-slip"
front = "free-slip"
back = "free-slip"
[resolution]
spacing = 0.1
[fluid]
density = 1000
gravity = 9.81
sound_speed = 40
[time]
end = 0.001
[[body]]
name = "drop"
shape = "ball"
radius = 0.3
position = [0.5, 0.5, 0.5]
wall = "none"
[[body]]
name = "wedge"
mesh = "wedge.obj"
scale = 0.001
inside = false
wall = "none"
[[liquid]]
body = "drop"
"""
# In mm: a tetrahedron of volume 1/6 of a cube of 200 mm.
WEDGE = "v 0 0 0\nv 200 0 0\nv 0 200 0\nv 0 0 200\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
PROGRAM = paths.ROOT / "build" / "release" / "spume"


class Bodies(Scratch):
    def setUp(self):
        super().setUp()
        (self.path / "case.toml").write_text(CASE)
        (self.path / "wedge.obj").write_text(WEDGE)

    def call(self, *arguments):
        return subprocess.run([PROGRAM, *arguments], capture_output=True, text=True, cwd=self.path)

    def test_check_lists_every_body_and_what_it_covers(self):
        done = self.call("check", "case.toml")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("  drop  ball, a shape to fill\n    bounds [0.2, 0.8] x [0.2, 0.8] x [0.2, 0.8], volume 0.1131\n", done.stdout)
        # A layer of a spacing in which shares fall from 1 to 0 adds 1 / 36 to the ball of three spacings.
        self.assertRegex(done.stdout, r"drop.*\n.*\n    room in the domain for about 11[3-9](\.\d)? particles")
        self.assertIn("  wedge  mesh with the solid outside, a shape to fill\n    bounds [0, 0.2] x [0, 0.2] x [0, 0.2], "
                      "volume 0.001333\n", done.stdout)

    def test_debians_vtk_reads_the_surfaces(self):
        from vtkmodules.util.numpy_support import vtk_to_numpy
        from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

        done = self.call("run", "case.toml", "-o", "run", "--quiet")
        self.assertEqual(done.returncode, 0, done.stderr)
        reader = vtkXMLPolyDataReader()
        reader.SetFileName(str(self.path / "run" / "bodies.vtp"))
        reader.Update()
        surface = reader.GetOutput()
        cells = surface.GetCellData()
        read = {name: vtk_to_numpy(cells.GetArray(name)) for name in ("body", "wall", "inside", "subtract")}
        corners = vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3)
        points = vtk_to_numpy(surface.GetPoints().GetData()).astype(float)[corners]
        self.assertEqual(len(corners), len(read["body"]))
        volumes = np.einsum("ij,ij->i", points[:, 0], np.cross(points[:, 1], points[:, 2])) / 6
        # 24 facets around, the least that a ball gets, and 12 down take 2 pi^2 / 3 and pi^2 over 24^2 of it: 16.4.
        self.assertAlmostEqual(volumes[read["body"] == 0].sum() / (4 / 3 * np.pi * 0.027), 1, delta=20 / 24 ** 2)
        # Turned over: the solid is outside.
        self.assertEqual((read["body"] == 1).sum(), 4)
        self.assertAlmostEqual(volumes[read["body"] == 1].sum(), -0.2 ** 3 / 6, delta=1e-8)
        np.testing.assert_array_equal(read["inside"], 1 - read["body"])
        self.assertFalse(read["wall"].any() or read["subtract"].any())


if __name__ == "__main__":
    unittest.main()
