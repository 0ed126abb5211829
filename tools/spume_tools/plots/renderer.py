# SPDX-License-Identifier: MIT
"""Renders surfaces, solids and bubbles off-screen with VTK, on machines with or without a display.

Debian's VTK draws through an X server alone, so one without a screen (Xvfb) is started for as long as pictures are drawn,
and the pictures are the same on every machine. Projections are parallel: lengths can be read off.
"""
import atexit
import os
import subprocess

import numpy as np

from ..results import MissingResult

BACKGROUND = (1.0, 1.0, 1.0)
SAMPLES = 2  # pixels are rendered this many times finer along each axis and averaged
_server = []


def start_display():
    """Starts the X server that VTK draws through, once in a process."""
    if _server:
        return
    read, write = os.pipe()
    command = ["Xvfb", "-displayfd", str(write), "-screen", "0", "64x64x24", "-nolisten", "tcp"]
    try:
        server = subprocess.Popen(command, pass_fds=[write], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    except OSError as error:
        raise MissingResult("pictures of the liquid need Xvfb; install Debian's package xvfb") from error
    finally:
        os.close(write)
    with os.fdopen(read) as numbers:
        number = numbers.readline().strip()
    if not number:
        server.wait()
        raise MissingResult(f"pictures of the liquid need Xvfb, which ended with exit code {server.returncode}")
    os.environ["DISPLAY"] = f":{number}"
    _server.append(server)
    atexit.register(stop_display)


def stop_display():
    while _server:
        server = _server.pop()
        server.terminate()
        server.wait()


class View:
    """A parallel projection: the camera looks along `forward`; `right` and `up` span the picture.

    azimuth turns the direction of view from +y towards -x, elevation lifts the camera above the horizon (degrees).
    """

    def __init__(self, azimuth=0.0, elevation=0.0):
        a, e = np.radians([azimuth, elevation])
        self.right = np.array([np.cos(a), -np.sin(a), 0.0])
        self.forward = np.array([np.sin(a) * np.cos(e), np.cos(a) * np.cos(e), -np.sin(e)])
        self.up = np.cross(self.right, self.forward)

    def project(self, points):
        """Coordinates (N, 2) in the picture of points (N, 3), in units of length."""
        points = np.atleast_2d(points)
        return np.column_stack([points @ self.right, points @ self.up])

    def frame(self, lower, upper):
        """Left, right, bottom and top of the smallest frame that holds a box."""
        corners = np.array([[(lower, upper)[i][0], (lower, upper)[j][1], (lower, upper)[k][2]]
                            for i in (0, 1) for j in (0, 1) for k in (0, 1)])
        flat = self.project(corners)
        return np.array([flat[:, 0].min(), flat[:, 0].max(), flat[:, 1].min(), flat[:, 1].max()])


def closed_surface(corners):
    """Triangles (N, 3, 3) as vtkPolyData that share their corners."""
    from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData

    place, index = np.unique(np.asarray(corners, float).reshape(-1, 3), axis=0, return_inverse=True)
    index = index.reshape(-1, 3)
    points, triangles, surface = vtkPoints(), vtkCellArray(), vtkPolyData()
    points.SetData(numpy_to_vtk(np.ascontiguousarray(place), deep=True))
    listed = np.column_stack([np.full(len(index), 3), index]).astype(np.int64).ravel()
    triangles.SetCells(len(index), numpy_to_vtkIdTypeArray(listed, deep=True))
    surface.SetPoints(points)
    surface.SetPolys(triangles)
    return surface


class Scene:
    """Things to be drawn, as VTK actors. Colours are (red, green, blue) from 0 to 1."""

    def __init__(self):
        import vtkmodules.vtkRenderingOpenGL2  # noqa: F401  (classes made from here on can draw)
        from vtkmodules.vtkRenderingCore import vtkRenderer

        start_display()
        self.renderer = vtkRenderer()
        self.renderer.SetBackground(*BACKGROUND)

    def add(self, mapper, colour=None, opacity=1.0, shine=0.0, ambient=0.0):
        from vtkmodules.vtkRenderingCore import vtkActor

        actor = vtkActor()
        actor.SetMapper(mapper)
        look = actor.GetProperty()
        if colour is not None:
            look.SetColor(*colour)
        look.SetOpacity(opacity)
        look.SetAmbient(ambient)
        look.SetDiffuse(1.0 - ambient)
        look.SetSpecular(shine)
        look.SetSpecularPower(40)
        self.renderer.AddActor(actor)
        return actor

    def add_surface(self, surface, colour, opacity=1.0, shine=0.35):
        """A triangulated surface with normals (vtkPolyData)."""
        from vtkmodules.vtkRenderingCore import vtkPolyDataMapper

        mapper = vtkPolyDataMapper()
        mapper.SetInputData(surface)
        mapper.ScalarVisibilityOff()
        return self.add(mapper, colour, opacity, shine, 0.12)

    def add_box(self, lower, upper, colour):
        from vtkmodules.vtkFiltersSources import vtkCubeSource
        from vtkmodules.vtkRenderingCore import vtkPolyDataMapper

        cube = vtkCubeSource()
        cube.SetBounds(*np.column_stack([lower, upper]).ravel())
        mapper = vtkPolyDataMapper()
        mapper.SetInputConnection(cube.GetOutputPort())
        return self.add(mapper, colour, ambient=0.25)

    def add_solid(self, corners, lower, upper, colour):
        """A closed surface of triangles (N, 3, 3), cut flat at the sides of a box."""
        from vtkmodules.vtkCommonDataModel import vtkPlane, vtkPlaneCollection
        from vtkmodules.vtkFiltersCore import vtkPolyDataNormals, vtkTriangleFilter
        from vtkmodules.vtkFiltersGeneral import vtkClipClosedSurface

        place = np.asarray(corners, float).reshape(-1, 3)
        sides = vtkPlaneCollection()
        for axis in range(3):
            for limits, inward in ((lower, 1.0), (upper, -1.0)):
                if (inward * (place[:, axis] - limits[axis])).min() >= 0:
                    continue  # the solid does not pass this side
                plane = vtkPlane()
                plane.SetOrigin(*np.where(np.arange(3) == axis, limits, 0.0))
                plane.SetNormal(*np.where(np.arange(3) == axis, inward, 0.0))
                sides.AddItem(plane)
        cut = vtkClipClosedSurface()
        cut.SetInputData(closed_surface(corners))
        cut.SetClippingPlanes(sides)
        cut.SetTolerance(1e-6)
        whole = vtkTriangleFilter()
        whole.SetInputConnection(cut.GetOutputPort())
        normals = vtkPolyDataNormals()
        normals.SetInputConnection(whole.GetOutputPort())
        normals.SetFeatureAngle(30)
        normals.SplittingOn()
        normals.Update()
        return self.add_surface(normals.GetOutput(), colour, shine=0.1)

    def add_lines(self, pairs, colour, width=1.2):
        """Straight lines between pairs of points (N, 2, 3)."""
        from vtkmodules.vtkCommonCore import vtkPoints
        from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
        from vtkmodules.vtkRenderingCore import vtkPolyDataMapper

        points, lines = vtkPoints(), vtkCellArray()
        for pair in pairs:
            lines.InsertNextCell(2)
            for point in pair:
                lines.InsertCellPoint(points.InsertNextPoint(*point))
        data = vtkPolyData()
        data.SetPoints(points)
        data.SetLines(lines)
        mapper = vtkPolyDataMapper()
        mapper.SetInputData(data)
        actor = self.add(mapper, colour, ambient=1.0)
        actor.GetProperty().SetLineWidth(width * SAMPLES)
        return actor

    def add_spheres(self, position, radius, colours):
        """Spheres at positions (N, 3), with radii (N,) and colours (N, 3)."""
        from vtkmodules.util.numpy_support import numpy_to_vtk
        from vtkmodules.vtkCommonCore import vtkPoints
        from vtkmodules.vtkCommonDataModel import vtkPolyData
        from vtkmodules.vtkFiltersSources import vtkSphereSource
        from vtkmodules.vtkRenderingCore import vtkGlyph3DMapper

        points = vtkPoints()
        points.SetData(numpy_to_vtk(np.ascontiguousarray(position, float), deep=True))
        data = vtkPolyData()
        data.SetPoints(points)
        for name, values in (("diameter", 2 * np.asarray(radius, float)),
                             ("colour", np.asarray(255 * np.asarray(colours)[:, :3], np.uint8))):
            array = numpy_to_vtk(np.ascontiguousarray(values), deep=True)
            array.SetName(name)
            data.GetPointData().AddArray(array)
        sphere = vtkSphereSource()
        sphere.SetThetaResolution(14)
        sphere.SetPhiResolution(10)
        mapper = vtkGlyph3DMapper()
        mapper.SetInputData(data)
        mapper.SetSourceConnection(sphere.GetOutputPort())
        mapper.SetScaleModeToScaleByMagnitude()
        mapper.SetScaleArray("diameter")
        mapper.ScalarVisibilityOn()
        mapper.SetScalarModeToUsePointFieldData()
        mapper.SelectColorArray("colour")
        mapper.SetColorModeToDirectScalars()
        return self.add(mapper, shine=0.3, ambient=0.2)

    def render(self, view, frame, pixels, occlusion=0.0):
        """An image (height, width, 3) of bytes, `pixels` wide, of the frame (left, right, bottom, top) of a view.

        occlusion: the distance within which surfaces shade each other; 0: none.
        """
        from vtkmodules.util.numpy_support import vtk_to_numpy
        from vtkmodules.vtkRenderingCore import vtkLight, vtkRenderWindow, vtkWindowToImageFilter
        from vtkmodules.vtkRenderingOpenGL2 import vtkRenderStepsPass, vtkSSAOPass

        left, right, bottom, top = frame
        height = max(1, round(pixels * (top - bottom) / (right - left)))
        window = vtkRenderWindow()
        window.SetOffScreenRendering(1)
        window.SetSize(pixels * SAMPLES, height * SAMPLES)
        window.SetMultiSamples(0)
        window.SetAlphaBitPlanes(1)
        renderer = self.renderer
        renderer.SetUseDepthPeeling(1)
        renderer.SetMaximumNumberOfPeels(8)
        # A sun from the upper left in front of the scene, and a weak light from the camera.
        renderer.RemoveAllLights()
        renderer.AutomaticLightCreationOff()
        for direction, strength in ((-0.5 * view.right + 0.65 * view.up - 0.8 * view.forward, 0.8),
                                    (-view.forward, 0.35)):
            light = vtkLight()
            light.SetLightTypeToSceneLight()
            light.SetPosition(*direction)
            light.SetFocalPoint(0, 0, 0)
            light.SetIntensity(strength)
            renderer.AddLight(light)
        camera = renderer.GetActiveCamera()
        camera.ParallelProjectionOn()
        focus = 0.5 * (left + right) * view.right + 0.5 * (bottom + top) * view.up
        camera.SetFocalPoint(*focus)
        camera.SetPosition(*(focus - view.forward))
        camera.SetViewUp(*view.up)
        camera.SetParallelScale(0.5 * (top - bottom))
        renderer.ResetCameraClippingRange()
        if occlusion > 0:
            steps = vtkRenderStepsPass()
            shade = vtkSSAOPass()
            shade.SetRadius(occlusion)
            shade.SetBias(0.02 * occlusion)
            shade.SetKernelSize(32)
            shade.BlurOn()
            shade.SetDelegatePass(steps)
            renderer.SetPass(shade)
        window.AddRenderer(renderer)
        window.Render()
        grab = vtkWindowToImageFilter()
        grab.SetInput(window)
        grab.ReadFrontBufferOff()
        grab.Update()
        image = grab.GetOutput()
        size = image.GetDimensions()
        rgb = vtk_to_numpy(image.GetPointData().GetScalars()).reshape(size[1], size[0], 3)[::-1]
        window.RemoveRenderer(renderer)
        window.Finalize()
        fine = rgb[: height * SAMPLES, : pixels * SAMPLES].reshape(height, SAMPLES, pixels, SAMPLES, 3)
        return np.round(fine.mean(axis=(1, 3))).astype(np.uint8)
