# SPDX-License-Identifier: MIT
"""The surface of the liquid: where the kernel sum of its particles is one half."""
import numpy as np

from .shares import beside_bodies
from .sums import SUPPORT, continued, kernel_sums, up_to_openings, with_images

FINENESS = 0.8  # distance of the points at which sums are taken, in spacings
MARGIN = 3.0    # how far beyond a side the surface is made, in spacings
SMOOTHING = 15, 0.08  # passes and pass band of the filter that takes the lattice out of the surface (Taubin 1995)


def liquid_surface(case, position, spacing, copies=1, bottom=None, bodies=None, bounds=None):
    """The closed surface of the liquid of a three-dimensional case as vtkPolyData with normals.

    Sides of the domain cut it flat. copies: how often a width that is periodic in y is repeated; bottom: a height that
    cuts it as well, for particles that reach below it; bodies(low, step, shape): the share of the kernel that they take;
    bounds: lower and upper corner of the domain, where these are not those of the case.
    """
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPlane, vtkPlaneCollection
    from vtkmodules.vtkFiltersCore import vtkFlyingEdges3D, vtkPolyDataNormals, vtkTriangleFilter, vtkWindowedSincPolyDataFilter
    from vtkmodules.vtkFiltersGeneral import vtkClipClosedSurface

    lower, upper = np.array(bounds or (case["domain"]["lower"], case["domain"]["upper"]), float)
    width = upper[1] - lower[1]
    # The surface is made beyond the sides and cut there, so that the filter does not round the edges.
    beyond = MARGIN * spacing
    place, _ = with_images(case, position, beyond + SUPPORT * spacing, bounds)
    if copies > 1:
        own = (place[:, 1] >= lower[1]) & (place[:, 1] < upper[1])
        place = np.concatenate([place[place[:, 1] < lower[1]], *(place[own] + [0, k * width, 0] for k in range(copies)),
                                place[place[:, 1] >= upper[1]] + [0, (copies - 1) * width, 0]])
        upper[1] += (copies - 1) * width
    if bottom is not None:
        lower[2] = bottom
    low, high = place.min(axis=0) - SUPPORT * spacing, place.max(axis=0) + SUPPORT * spacing
    cuts = vtkPlaneCollection()
    for axis in range(3):
        goes_on = continued(case, axis)
        for side, limits, keep, nearer in ((0, lower, low, max), (1, upper, high, min)):
            if not goes_on[side] and not (axis == 2 and side == 0 and bottom is not None):
                continue
            inward = 1 if side == 0 else -1
            keep[axis] = nearer(keep[axis], limits[axis] - inward * beyond)
            plane = vtkPlane()
            plane.SetOrigin(*np.where(np.arange(3) == axis, limits, 0.0))
            plane.SetNormal(*np.where(np.arange(3) == axis, inward, 0.0))
            cuts.AddItem(plane)
    cells = np.maximum(2, np.ceil((high - low) / (FINENESS * spacing)).astype(int))
    step = (high - low).max() / cells[np.argmax(high - low)]
    filled, = up_to_openings(case, range(3), (lower, upper), low, step, spacing, kernel_sums(place, spacing, low, step, cells + 1))
    share = None if bodies is None else bodies(low, step, cells + 1)
    if share is not None:
        filled = beside_bodies(filled, share)
    closed = np.pad(filled, 1)  # a layer of air closes the surface
    image = vtkImageData()
    image.SetDimensions(*closed.shape)
    image.SetSpacing(step, step, step)
    image.SetOrigin(*(low - step))
    image.GetPointData().SetScalars(numpy_to_vtk(closed.ravel(order="F"), deep=True))
    edges = vtkFlyingEdges3D()
    edges.SetInputData(image)
    edges.SetValue(0, 0.5)
    edges.ComputeNormalsOff()
    edges.ComputeGradientsOff()
    edges.ComputeScalarsOff()
    smooth = vtkWindowedSincPolyDataFilter()
    smooth.SetInputConnection(edges.GetOutputPort())
    smooth.SetNumberOfIterations(SMOOTHING[0])
    smooth.SetPassBand(SMOOTHING[1])
    smooth.NonManifoldSmoothingOn()
    smooth.NormalizeCoordinatesOn()
    cut = vtkClipClosedSurface()
    cut.SetInputConnection(smooth.GetOutputPort())
    cut.SetClippingPlanes(cuts)
    cut.SetTolerance(1e-6)
    triangles = vtkTriangleFilter()
    triangles.SetInputConnection(cut.GetOutputPort())
    normals = vtkPolyDataNormals()
    normals.SetInputConnection(triangles.GetOutputPort())
    normals.SetFeatureAngle(50)
    normals.SplittingOn()
    normals.ConsistencyOn()
    normals.Update()
    return normals.GetOutput()
