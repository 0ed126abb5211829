# SPDX-License-Identifier: MIT
"""Surfaces between phases as files: read by Debian's VTK, with their times, and the same from a run that was resumed."""
import json
import subprocess
import unittest

import numpy as np
import paths
from test_tools import Scratch

CASE = """title = "a drop between walls"
method = "gfd"
[domain]
lower = [0, 0, 0]
upper = [1, 1, 1]
x = "periodic"
y = "periodic"
bottom = "no-slip"
top = "no-slip"
[resolution]
spacing = 0.0625
[[phase]]
name = "outside"
density = 1
viscosity = 0.01
[[phase]]
name = "drop"
density = 2
viscosity = 0.02
[interface]
surface_tension = 0.1
[[region]]
phase = "outside"
[[region]]
phase = "drop"
centre = [0.5, 0.5, 0.5]
radius = 0.3
[time]
end = 0.02
max_step = 0.001  # else steps at rest follow the end of the run
[output]
every = 0.005
interface = true
"""
PROGRAM = paths.ROOT / "build" / "release" / "spume"


class Interface(Scratch):
    def setUp(self):
        super().setUp()
        (self.path / "case.toml").write_text(CASE)

    def call(self, *arguments):
        done = subprocess.run([PROGRAM, *arguments, "--quiet"], capture_output=True, text=True, cwd=self.path)
        self.assertEqual(done.returncode, 0, done.stderr)

    def read(self, path):
        from vtkmodules.util.numpy_support import vtk_to_numpy
        from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

        reader = vtkXMLPolyDataReader()
        reader.SetFileName(str(path))
        reader.Update()
        surface = reader.GetOutput()
        cells = surface.GetPolys() if surface.GetNumberOfPolys() else surface.GetLines()
        corners = vtk_to_numpy(cells.GetConnectivityArray()).reshape(surface.GetNumberOfCells(), -1)
        points = vtk_to_numpy(surface.GetPoints().GetData()).astype(float)[corners]
        phase = vtk_to_numpy(surface.GetCellData().GetArray("phase"))
        time = surface.GetFieldData().GetArray("TimeValue").GetValue(0)
        return points, phase, time

    def test_debians_vtk_reads_triangles_with_time_and_phase(self):
        self.call("run", "case.toml", "-o", "run")
        files = json.loads((self.path / "run" / "interface.vtp.series").read_text())["files"]
        np.testing.assert_allclose([file["time"] for file in files], [0, 0.005, 0.01, 0.015, 0.02], rtol=1e-12)
        for file in files:
            points, phase, time = self.read(self.path / "run" / file["name"])
            self.assertEqual(time, file["time"])
            self.assertEqual(points.shape[1:], (3, 3))
            self.assertTrue((phase == 1).all())
            normals = np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0]) / 2
            # A ball of 4.8 spacings: the number of its particles is off by some per cent.
            self.assertAlmostEqual(np.linalg.norm(normals, axis=1).sum() / (4 * np.pi * 0.09), 1, delta=0.05)
            volume = np.einsum("ij,ij->i", points[:, 0] - 0.5, normals).sum() / 3
            self.assertAlmostEqual(volume / (4 / 3 * np.pi * 0.027), 1, delta=0.06)

    def test_lines_in_the_plane(self):
        text = CASE.replace("[0, 0, 0]", "[0, 0]").replace("[1, 1, 1]", "[1, 1]").replace('y = "periodic"\n', "")
        (self.path / "case.toml").write_text(text.replace("[0.5, 0.5, 0.5]", "[0.5, 0.5]"))
        self.call("run", "case.toml", "-o", "run", "--until", "0.005")
        points, phase, time = self.read(self.path / "run" / "interface" / "0001.vtp")
        self.assertEqual(points.shape[1:], (2, 3))
        self.assertAlmostEqual(np.linalg.norm(points[:, 1] - points[:, 0], axis=1).sum() / (2 * np.pi * 0.3), 1, delta=0.05)
        self.assertFalse(points[:, :, 2].any())
        self.assertEqual(time, 0.005)

    def test_a_resumed_run_has_the_same_files(self):
        self.call("run", "case.toml", "-o", "whole")
        self.call("run", "case.toml", "-o", "part", "--until", "0.01")
        self.call("resume", "part", "--until", "0.02")
        for name in ("interface.vtp.series", *(f"interface/000{k}.vtp" for k in range(5))):
            self.assertEqual((self.path / "part" / name).read_bytes(), (self.path / "whole" / name).read_bytes(), name)
        times = [file["time"] for file in json.loads((self.path / "part" / "interface.vtp.series").read_text())["files"]]
        self.assertEqual(len(times), len(list((self.path / "part" / "interface").iterdir())))

    def test_nothing_is_written_that_was_not_asked_for(self):
        (self.path / "case.toml").write_text(CASE.replace("interface = true", ""))
        self.call("run", "case.toml", "-o", "run", "--until", "0.005")
        self.assertFalse(list((self.path / "run").glob("interface*")))


if __name__ == "__main__":
    unittest.main()
