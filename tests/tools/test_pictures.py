# SPDX-License-Identifier: MIT
"""Fields in planes, the rendered liquid, and the options of `spume plot`."""
import json
import shutil
import subprocess
import unittest
from pathlib import Path
from unittest import mock

import paths
import numpy as np
from PIL import Image
from spume_tools.plots import bubble_views, planes, style, views
from spume_tools.plots.liquid import liquid_surface
from spume_tools.plots.renderer import Scene, View, closed_surface
from spume_tools.plots.request import DrawnRun, Request
from spume_tools.plots.sums import kernel_sums
from spume_tools.results import MissingResult, Results
from synthetic import lattice, new_folder, series_of, write_case, write_grid_snapshots, write_snapshots, write_table
from test_tools import Scratch, call

TANK = {"left": "free-slip", "right": "free-slip", "front": "free-slip", "back": "free-slip", "bottom": "free-slip"}


def pixels_of(file):
    """Red, green and blue of the pixels of an image, (height, width, 3)."""
    with Image.open(file) as image:
        return np.asarray(image.convert("RGB")).astype(int)


def write_tank(folder, spacing=0.1, height=1.0, si=True, solid=None, **domain):
    """Still water one half deep in a tank of 2 x 1, with the speed z and the pressure 0.5 - z."""
    write_case(folder, "Some tank", [0, 0, 0], [2, 1, height], spacing, **(domain or TANK))
    with (folder / "case.toml").open("a") as file:
        file.write("[fluid]\ndensity = 1000\ngravity = 9.81\n" if si else "[fluid]\nreynolds = 100\n")
        if solid:
            file.write(f"[[solid]]\nlower = {solid[0]}\nupper = {solid[1]}\n")
    grid = lattice([0, 0, 0], [2, 1, 0.5], spacing)
    if solid:
        grid = grid[~np.all((grid > solid[0]) & (grid < solid[1]), axis=1)]
    write_table(folder / "series.csv", series_of([0, 0.5, 1], kinetic_energy=[1, 2, 3], surface_particles=10), {"t": "time"})
    write_snapshots(folder / "fluid.vtkhdf", [0, 0.5, 1], lambda t: grid,
                    {"velocity": lambda p, t: p * [0, 0, 1], "pressure": lambda p, t: 0.5 - p[:, 2]})


def write_bodies(folder, *solids, taken_away=()):
    """bodies.vtp with walls that stand still: triangles (N, 3, 3) each. taken_away: the numbers of those that are."""
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

    surface = closed_surface(np.concatenate(solids))
    numbers = np.repeat(np.arange(len(solids)), [len(solid) for solid in solids])
    for name, values in (("body", numbers.astype(np.int32)), ("subtract", np.isin(numbers, taken_away).astype(np.int8)),
                         *((name, np.ones(len(numbers), np.int8)) for name in ("wall", "inside"))):
        array = numpy_to_vtk(values, deep=True)
        array.SetName(name)
        surface.GetCellData().AddArray(array)
    writer = vtkXMLPolyDataWriter()
    writer.SetFileName(str(folder / "bodies.vtp"))
    writer.SetInputData(surface)
    writer.Write()


def block(lower, upper):
    """The twelve triangles of a box, outwards."""
    corner = lambda i: np.where([i & 1, i & 2, i & 4], upper, lower)
    faces = [(0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6)]
    return np.array([[corner(a), corner(b), corner(c)] for w, x, y, z in faces for a, b, c in ((w, x, y), (w, y, z))], float)


class Planes(Scratch):
    def test_kernel_sums_of_a_lattice_are_one(self):
        # Over a lattice with a support of two spacings the sum differs from its integral by up to 4 % in three dimensions
        # and 3 % in two: at its points, between them and in the middle of its cells.
        for d in (2, 3):
            points = lattice([0] * d, [1] * d, 0.1)
            total, = kernel_sums(points, 0.1, np.full(d, 0.5), 0.05, (2,) * d)
            np.testing.assert_allclose(total, 1, atol=0.04)

    def test_a_plane_between_two_layers_is_filled(self):
        folder = new_folder(self.path, "run")
        write_tank(folder)
        for coordinate in (0.5, 0.45, 0.52):  # on no layer, on one, between
            run = DrawnRun(folder, Request(plane=(1, coordinate)))
            plane, (panel,) = planes.panels_of(run, "pressure", run.snapshots(), [0])
            x = np.linspace(*panel.extent[:2], panel.values.shape[0])
            z = np.linspace(*panel.extent[2:], panel.values.shape[1])
            wet = panel.values[:, z < 0.49]
            self.assertTrue(np.isfinite(wet).all(), coordinate)
            self.assertTrue(np.isnan(panel.values[:, z > 0.53]).all())
            # Linear between walls and surface, where the particles are even on both sides, up to the unevenness of the sums.
            inner = (z > 0.2) & (z < 0.3)
            np.testing.assert_allclose(panel.values[:, inner], np.broadcast_to(0.5 - z[inner], (len(x), inner.sum())), atol=0.01)

    def test_a_plane_of_a_grid_is_exact_on_its_layers_and_linear_between(self):
        folder = new_folder(self.path, "run")
        write_case(folder, "Some box", [0, 0, 0], [0.8, 0.8, 0.8], 0.1, x="periodic", y="periodic", z="periodic")
        text = (folder / "case.toml").read_text().replace("spacing = 0.1", "grid = 8")
        (folder / "case.toml").write_text(text)
        write_grid_snapshots(folder / "fluid.vtkhdf", [0.0], (8, 8, 8), 0.1, {"pressure": lambda x, y, z, t: x + 10 * y})
        for coordinate in (0.3, 0.35):
            run = DrawnRun(folder, Request(plane=(1, coordinate)))
            _, (panel,) = planes.panels_of(run, "pressure", run.snapshots(), [0])
            every = (panel.values.shape[0] - 1) // 8
            np.testing.assert_allclose(panel.values[::every, 0][:8], 0.1 * np.arange(8) + 10 * coordinate, atol=1e-5)
            self.assertAlmostEqual(panel.values[-1, 0], panel.values[0, 0])  # periodic

    def test_interfaces_are_where_half_of_the_particles_are_of_a_phase(self):
        folder = new_folder(self.path, "run")
        write_case(folder, "Two layers", [0, 0], [1, 1], 0.05, x="periodic")
        grid = lattice([0, 0], [1, 1], 0.05)
        write_snapshots(folder / "fluid.vtkhdf", [0.0], lambda t: grid,
                        {"pressure": lambda p, t: p[:, 1], "phase": lambda p, t: 1.0 * (p[:, 1] > 0.3)})
        run = DrawnRun(folder)
        _, (panel,) = planes.panels_of(run, "pressure", run.snapshots(), [0])
        (above,) = panel.phases
        y = np.linspace(*panel.extent[2:], above.shape[1])
        crossing = [np.interp(0.5, column, y) for column in above]
        np.testing.assert_allclose(crossing, 0.3, atol=0.01)  # a fifth of a spacing: the sums are on half spacings

    def test_there_is_no_interface_in_the_air(self):
        folder = new_folder(self.path, "run")
        write_case(folder, "Oil on water", [0, 0], [1, 1], 0.05, x="periodic", bottom="free-slip")
        layers, jet = lattice([0, 0], [1, 0.5], 0.05), lattice([0.4, 0.5], [0.6, 0.9], 0.05)
        write_snapshots(folder / "fluid.vtkhdf", [0.0], lambda t: np.concatenate([layers, jet]),
                        {"pressure": lambda p, t: p[:, 1], "phase": lambda p, t: 1.0 * (p[:, 1] > 0.25)})
        run = DrawnRun(folder)
        plane, (panel,) = planes.panels_of(run, "pressure", run.snapshots(), [0])
        (oil,) = panel.phases
        y = np.linspace(*panel.extent[2:], oil.shape[1])
        self.assertTrue((y > 0.8).any())
        self.assertFalse((oil[:, y > 0.35] < 0.5).any())

    def test_liquid_is_drawn_up_to_a_body_and_not_along_its_dry_face(self):
        # Faces are half a spacing from the nearest particles: where they end, half of the kernel sum is missing.
        folder = new_folder(self.path, "run")
        low, high = np.array([1.2, -0.1, -0.1]), np.array([1.6, 1.1, 0.9])
        write_tank(folder, solid=(list(low), list(high)))
        case = (folder / "case.toml").read_text()
        (folder / "case.toml").write_text(case[: case.index("[[solid]]")])  # the body takes its place
        write_bodies(folder, block(low, high))
        run = DrawnRun(folder, Request(plane=(1, 0.5)))
        plane, (panel,) = planes.panels_of(run, "pressure", run.snapshots(), [0])
        left, right, bottom, top = panel.extent
        columns, rows = panel.values.shape
        x, z = (low + (np.arange(n) + 0.5) / n * (high - low) for n, low, high in ((columns, left, right), (rows, bottom, top)))
        drawn = np.isfinite(panel.values)
        wet = z < 0.4
        step = x[1] - x[0]
        for beside in ((x > 1.0) & (x < 1.2 - step), (x > 1.6 + step) & (x < 1.8)):
            self.assertTrue(drawn[np.ix_(beside, wet)].all())
        within = 0.25 * run.spacing
        self.assertFalse(drawn[np.ix_((x > 1.2 + within) & (x < 1.6 - within), wet)].any())
        self.assertFalse(drawn[:, z > 0.6].any())
        # Without the share of the body a slit is left.
        with mock.patch.object(planes, "share_in_plane", lambda *_: None):
            _, (bare,) = planes.panels_of(run, "pressure", run.snapshots(), [0])
        self.assertFalse(np.isfinite(bare.values)[np.ix_((x > 1.2 - 0.3 * run.spacing) & (x < 1.2), wet)].all())

    def test_liquid_in_what_is_taken_away_from_a_body_is_drawn(self):
        folder = new_folder(self.path, "run")
        write_tank(folder)
        for taken_away, drawn in (((1,), True), ((), False)):
            write_bodies(folder, block([0.4, -0.1, -0.1], [1.6, 1.1, 0.9]), block([0.8, 0.2, 0.1], [1.2, 0.8, 0.4]),
                         taken_away=taken_away)
            run = DrawnRun(folder, Request(plane=(1, 0.5)))
            _, (panel,) = planes.panels_of(run, "pressure", run.snapshots(), [0])
            columns, rows = panel.values.shape
            middle = panel.values[int(columns * 0.5), int(rows * 0.25)]
            self.assertEqual(np.isfinite(middle), drawn)

    def test_channels_are_filled_up_to_their_openings(self):
        # The first particles stand up to a spacing from an opening, and more where one has just left.
        spacing = 0.05
        grid = lattice([0, 0], [1, 0.5], spacing)
        ends = np.minimum(grid[:, 0], 1 - grid[:, 0]) < 0.6 * spacing
        stays = ~ends | (np.floor(grid[:, 1] / spacing) % 4 == 0)
        for openings, filled in (('[[inflow]]\nside = "left"\n[[outflow]]\nside = "right"\n', True), ("", False)):
            folder = new_folder(self.path, f"run_{filled}")
            write_case(folder, "A channel", [0, 0], [1, 0.5], spacing, bottom="no-slip", top="no-slip")
            with (folder / "case.toml").open("a") as file:
                file.write(openings)
            write_snapshots(folder / "fluid.vtkhdf", [0], lambda t: grid[stays], {"pressure": lambda p, t: p[:, 1]})
            run = DrawnRun(folder)
            _, (panel,) = planes.panels_of(run, "pressure", run.snapshots(), [0])
            self.assertEqual(np.isfinite(panel.values).all(), filled)
            self.assertEqual(panel.share.min() > 0.5, filled)
            if filled:
                np.testing.assert_allclose(panel.extent, (0, 1, 0, 0.5), atol=0.002)  # a pixel
                np.testing.assert_allclose(panel.values[0], panel.values[80], atol=0.01)

    def test_planes_reach_the_sides_of_domains_of_any_width(self):
        for width in (1.01, 1.02, 1.03, 1.04):
            folder = new_folder(self.path, f"run_{width}")
            write_case(folder, "A channel", [0, 0], [width, 0.5], 0.05, x="periodic", bottom="no-slip", top="no-slip")
            write_snapshots(folder / "fluid.vtkhdf", [0], lambda t: lattice([0, 0], [width, 0.5], 0.05), {"pressure": lambda p, t: p[:, 1]})
            run = DrawnRun(folder)
            plane, (panel,) = planes.panels_of(run, "pressure", run.snapshots(), [0])
            self.assertGreaterEqual(panel.extent[1], width)

    def test_labels_are_within_the_picture_where_the_layout_changes_the_ticks(self):
        folder = new_folder(self.path, "run")
        write_case(folder, "A flume", [0, 0], [0.5, 0.2], 0.005, left="free-slip", bottom="free-slip")
        write_snapshots(folder / "fluid.vtkhdf", [0, 1, 2, 3], lambda t: lattice([0, 0], [0.5, 0.12], 0.005),
                        {"pressure": lambda p, t: 1000 * p[:, 1]})
        run = DrawnRun(folder)
        plane, panels = planes.panels_of(run, "pressure", run.snapshots(), range(4))
        figure = planes.plane_figure(run, "pressure", plane, panels, style.Normalize(0, 200), "neither")
        figure.savefig(self.path / "drawn.png")
        for axis in figure.axes[:4]:
            self.assertGreater(axis.yaxis.label.get_window_extent().x0, 0)
        style.plt.close(figure)

    def test_the_lowest_panel_of_each_column_has_labels(self):
        folder = new_folder(self.path, "run")
        write_tank(folder)
        run = DrawnRun(folder)
        plane, panels = planes.panels_of(run, "pressure", run.snapshots(), [0, 1, 2])
        with mock.patch.object(planes, "panel_grid", lambda *_: (2, 2)):
            figure = planes.plane_figure(run, "pressure", plane, panels, style.Normalize(0, 1), "neither")
        labelled = [bool(axis.get_xlabel()) and any(label.get_visible() for label in axis.get_xticklabels()) for axis in figure.axes[:3]]
        self.assertEqual(labelled, [False, True, True])
        style.plt.close(figure)

    def test_liquid_is_drawn_up_to_the_line_of_its_surface(self):
        # A disc of one colour in a round line on a picture as coarse as its pixels are many: no white between the two.
        folder = new_folder(self.path, "run")
        write_case(folder, "A drop", [0, 0], [1, 1], 0.05)
        drop = lattice([0, 0], [1, 1], 0.05)
        drop = drop[np.hypot(*(drop - 0.5).T) < 0.4]
        write_snapshots(folder / "fluid.vtkhdf", [0], lambda t: drop, {"pressure": lambda p, t: 1 + 0 * p[:, 0]})
        run = DrawnRun(folder)
        plane, (panel,) = planes.panels_of(run, "pressure", run.snapshots(), [0])
        panel.values[5:9, -3] = 1  # a surface that is two pixels from the edge somewhere
        figure = style.plt.figure(figsize=(12, 12), dpi=100)
        axis = figure.add_axes((0, 0, 1, 1))
        planes.draw_panel(axis, run, plane, panel, (0, 1, 0, 1), "pressure", style.Normalize(1, 2))
        figure.canvas.draw()
        across = np.asarray(figure.canvas.buffer_rgba())[:, 60:600, 0].astype(int)  # from beside the left edge to the middle
        top = np.asarray(figure.canvas.buffer_rgba())[60:110, 60:-60, 0]
        style.plt.close(figure)
        self.assertTrue((top == 255).all())
        for row in across[400:800]:
            inside = np.flatnonzero(row < 200)[0]  # the line
            self.assertLess(row[inside:].max(), 225)  # the line is blended into what it covers

    def test_a_plane_outside_the_domain_is_said(self):
        folder = new_folder(self.path, "run")
        write_tank(folder)
        with self.assertRaisesRegex(MissingResult, "the plane y = 3 is not in the domain, which reaches from 0 to 1"):
            planes.plane_of(DrawnRun(folder, Request(plane=(1, 3.0))))


class Rendering(Scratch):
    def test_a_box_is_as_large_as_it_is(self):
        scene = Scene()
        scene.add_box([0, 0, 0], [0.5, 0.5, 0.25], (0.2, 0.4, 0.8))
        image = scene.render(View(), (0, 1, 0, 0.5), 200)
        self.assertEqual(image.shape, (100, 200, 3))
        inside = np.all(image != 255, axis=-1)
        self.assertTrue(inside[55:, :95].all() and not inside[:45].any() and not inside[:, 105:].any())

    def test_the_surface_is_where_the_liquid_ends(self):
        folder = new_folder(self.path, "run")
        write_tank(folder)
        run = Results(folder)
        surface = liquid_surface(run.case, run.snapshots()[0].position, run.spacing)
        np.testing.assert_allclose(surface.GetBounds(), (0, 2, 0, 1, 0, 0.5), atol=0.1 * run.spacing)

    def test_the_surface_ends_flat_at_openings(self):
        folder = new_folder(self.path, "run")
        write_tank(folder, left="open", right="open", front="free-slip", back="free-slip", bottom="free-slip")
        with (folder / "case.toml").open("a") as file:
            file.write('[[inflow]]\nside = "left"\n[[outflow]]\nside = "right"\n')
        run = Results(folder)
        position = run.snapshots()[0].position
        gap = (position[:, 0] < 0.1) | (position[:, 0] > 1.9)
        surface = liquid_surface(run.case, position[~gap | (position[:, 1] < 0.4)], run.spacing)
        np.testing.assert_allclose(surface.GetBounds(), (0, 2, 0, 1, 0, 0.5), atol=0.1 * run.spacing)
        from vtkmodules.util.numpy_support import vtk_to_numpy
        points = vtk_to_numpy(surface.GetPoints().GetData())
        for side in (0, 2):
            end = points[np.abs(points[:, 0] - side) < 1e-3]
            np.testing.assert_allclose(end[:, 1].max(), 1, atol=0.1 * run.spacing)

    def picture(self, folder):
        with mock.patch.object(views, "DOTS_PER_INCH", 30):
            file, = views.plot_side_view(DrawnRun(folder, Request(times=(0.5,))), self.path)
        return pixels_of(file)

    def test_water_fills_the_picture_and_solids_are_seen(self):
        folder = new_folder(self.path, "run")
        write_tank(folder, solid=([1.2, 0, 0], [1.6, 0.4, 0.9]))
        image = self.picture(folder)
        drawn = np.any(image < 250, axis=-1)
        rows, columns = np.flatnonzero(drawn.any(axis=1)), np.flatnonzero(drawn.any(axis=0))
        self.assertLess(columns[0] + image.shape[1] - columns[-1], 0.06 * image.shape[1])
        self.assertLess(image.shape[0] - rows[-1], 0.1 * image.shape[0])
        red, blue = image[..., 0], image[..., 2]
        self.assertGreater(np.mean(blue > red + 15), 0.2)  # water
        self.assertGreater(np.mean((red > blue + 8) & drawn), 0.03)  # the block

    def test_bodies_are_seen_where_they_stand_and_hold_the_depth(self):
        folder = new_folder(self.path, "run")
        write_tank(folder, height=4.0, x="periodic", front="free-slip", back="free-slip", bottom="free-slip")
        position = lattice([0, 0, 0], [2, 1, 3], 0.1)
        write_snapshots(folder / "fluid.vtkhdf", [0, 1], lambda t: position, {"velocity": lambda p, t: p})
        run = DrawnRun(folder, Request())
        self.assertGreater(views.Stage(run, run.snapshots(), [0]).lower[2], 2)  # deep water without ends is cut
        write_bodies(folder, block([1.2, 0.2, 1.0], [1.6, 0.6, 3.4]))
        stage = views.Stage(run, run.snapshots(), [0])
        self.assertEqual(stage.lower[2], 0)
        self.assertAlmostEqual(stage.upper[2], 3.4, places=6)
        stone = lambda image: np.mean(image[..., 0] > image[..., 2] + 8)
        self.assertGreater(stone(self.picture(folder)), 0.005)

    def test_bodies_are_seen_at_both_of_the_periodic_sides_that_they_cross(self):
        folder = new_folder(self.path, "run")
        write_tank(folder, x="periodic", front="free-slip", back="free-slip", bottom="free-slip")
        write_bodies(folder, block([1.8, 0.2, 0.3], [2.4, 0.6, 0.9]))
        image = self.picture(folder)
        stone = image[..., 0] > image[..., 2] + 8
        third = image.shape[1] // 3
        self.assertGreater(stone[:, :third].mean(), 0.02)
        self.assertGreater(stone[:, -third:].mean(), 0.01)
        # Where it comes back the kernel is that of liquid that goes on behind its faces.
        write_snapshots(folder / "fluid.vtkhdf", [0], lambda t: lattice([0.4, 0, 0], [1.8, 1, 0.5], 0.1),
                        {"pressure": lambda p, t: p[:, 0]})
        run = DrawnRun(folder, Request(plane=(1, 0.4)))
        _, (panel,) = planes.panels_of(run, "pressure", run.snapshots(), [0])
        x = np.linspace(*panel.extent[:2], panel.values.shape[0])
        self.assertGreater(panel.share[(x > 0.41) & (x < 0.45), int(0.65 * panel.share.shape[1])].min(), 0.8)

    def test_the_face_of_a_body_at_a_side_covers_the_liquid_there(self):
        # A thin plate, which the kernel sums of the liquid do not tell: they share one plane at the front.
        folder = new_folder(self.path, "run")
        write_tank(folder)
        write_bodies(folder, block([1.2, 0, 0.1], [1.24, 1, 0.4]))
        image = self.picture(folder)
        self.assertGreater(np.mean(image[..., 0] > image[..., 2] + 8), 0.002)  # 0.0027 of the picture, speckled 0.0013

    def test_a_tall_tank_fits_the_page(self):
        folder = new_folder(self.path, "run")
        write_tank(folder, height=8.0, left="free-slip", right="free-slip", bottom="free-slip")
        write_snapshots(folder / "fluid.vtkhdf", [0, 1], lambda t: lattice([0, 0, 0], [0.4, 0.4, 7], 0.1),
                        {"velocity": lambda p, t: p})
        write_snapshots(folder / "bubbles.vtkhdf", [1], lambda t: lattice([0, 0, 1], [0.3, 0.3, 2], 0.1),
                        {"radius": lambda p, t: 0.01 * (1 + p[:, 2])})
        with (folder / "case.toml").open("a") as file:
            file.write("[bubbles]\n")
        (folder / "summary.json").write_text(json.dumps({"derived": {}}))
        with mock.patch.object(bubble_views, "DOTS_PER_INCH", 30):
            file, = bubble_views.plot_bubble_views(DrawnRun(folder, Request()), self.path)
        image = pixels_of(file)
        self.assertLess(max(image.shape), 2000)
        # The bubbles are purple to yellow, which water and tank are not.
        self.assertGreater(np.sum(image[..., 0] > image[..., 1] + 40), 50)


class Titles(Scratch):
    def test_a_title_is_no_wider_than_its_picture(self):
        for title, cut in (("Short", False), ("A title of forty-four letters in two inches", False),
                           ("A title that is much too long for two inches even in the smallest of letters", True)):
            figure = style.plt.figure(figsize=(2.4, 2))
            figure.exact = True  # as the pictures of planes are laid out
            with mock.patch.object(style.plt, "close"):
                style.finish(figure, self.path / "titled.png", title)
            drawn = figure._suptitle
            self.assertLessEqual(drawn.get_window_extent(figure.canvas.get_renderer()).width, figure.bbox.width)
            self.assertEqual(drawn.get_text() != title, cut)
            self.assertEqual(drawn.get_text().endswith(" ..."), cut)
            style.plt.close(figure)


class Options(Scratch):
    def run_folder(self, name="run"):
        folder = new_folder(self.path, name)
        write_case(folder, "A square", [0, 0], [1, 1], 0.1, left="free-slip", bottom="free-slip")
        with (folder / "case.toml").open("a") as file:
            file.write("[fluid]\ndensity = 1000\ngravity = 9.81\n")
        write_table(folder / "series.csv", series_of([0, 1.0], kinetic_energy=[1, 2]), {"t": "time"})
        write_snapshots(folder / "fluid.vtkhdf", [0, 0.5, 1], lambda t: lattice([0, 0], [1, 1], 0.1),
                        {"velocity": lambda p, t: p, "pressure": lambda p, t: p[:, 0]})
        return folder

    def pictures(self, *arguments):
        done = call("plots", *arguments)
        self.assertEqual((done.returncode, done.stderr), (0, ""), done.stdout)
        return [Path(line) for line in done.stdout.splitlines()]

    def test_fields_times_ranges_and_formats(self):
        folder = self.run_folder()
        files = self.pictures(folder, "--fields", "velocity_x", "pressure", "--times", 0.5, "--range", "velocity_x=-2:3",
                              "--format", "svg")
        self.assertEqual({file.name for file in files}, {"energy.svg", "numerics.svg", "velocity_x.svg", "pressure.svg"})
        text = (folder / "plots" / "velocity_x.svg").read_text()
        for label in ("A square: velocity x", "t = 0.5 s", "x [m]", "velocity x [m/s]"):
            self.assertTrue(f">{label}<" in text, label)
        self.assertFalse(">t = 1 s<" in text)
        self.assertTrue(">−2<" in text and ">3<" in text and ">4<" not in text)
        self.assertTrue(">pressure [Pa]<" in (folder / "plots" / "pressure.svg").read_text())
        self.assertTrue(">t [s]<" in (folder / "plots" / "energy.svg").read_text())
        pdf = self.pictures(folder, "--fields", "pressure", "--format", "pdf")
        self.assertTrue(all(file.read_bytes().startswith(b"%PDF") for file in pdf))

    def test_two_runs_are_drawn_beside_each_other(self):
        first, second = self.run_folder("first"), self.run_folder("second")
        files = self.pictures(first, second)
        self.assertEqual([str(file.relative_to(first)) for file in files],
                         [f"plots/beside_second/{name}.png" for name in ("series", "speed", "pressure")])

    def test_an_animation_has_a_frame_per_snapshot(self):
        file, *films = self.pictures(self.run_folder(), "--animate")
        with Image.open(file) as image:
            self.assertEqual((file.name, image.n_frames), ("speed.gif", 3))
        self.assertEqual([film.name for film in films], ["speed.mp4"] if shutil.which("ffmpeg") else [])
        for film in films:  # the box that every MP4 begins with
            self.assertEqual(film.read_bytes()[4:8], b"ftyp")

    def test_bad_options_are_said(self):
        folder = self.run_folder()
        for arguments, words in ((("--plane", "w=1"), "'w=1' is not an axis and a coordinate, such as y=0.5"),
                                 (("--plane", "y=a"), "'y=a': 'a' is not a number"),
                                 (("--range", "speed"), "'speed' is not a field with two limits, such as speed=0:2"),
                                 (("--range", "speed=2:1"), "'speed=2:1': the first limit is not below the second"),
                                 (("--format", "bmp"), "invalid choice: 'bmp'")):
            done = call("plots", folder, *arguments)
            self.assertEqual(done.returncode, 2)
            self.assertIn(words, done.stderr)

    def test_what_the_run_does_not_have_is_refused(self):
        folder = self.run_folder()
        for arguments, words in ((("--fields", "speed", "entropy"), "snapshot at t = 0: no field 'entropy'; it has"),
                                 (("--range", "entropy=0:1"), "snapshot at t = 0: no field 'entropy'; it has"),
                                 (("--times", "0", "7"), "no snapshot near t = 7; the run has them from 0 to")):
            done = call("plots", folder, *arguments)
            self.assertEqual((done.returncode, done.stdout), (2, ""))
            self.assertRegex(done.stderr, "^error: " + words)


class OlderReaders(Scratch):
    """Needs build/release/spume."""

    def test_debians_vtk_opens_every_step_of_a_spectral_run(self):
        from vtkmodules.util.numpy_support import vtk_to_numpy
        from vtkmodules.vtkIOHDF import vtkHDFReader

        case = new_folder(self.path, "case") / "case.toml"
        case.write_text((paths.ROOT / "cases" / "beltrami_exact" / "case.toml").read_text())
        program = paths.ROOT / "build" / "release" / "spume"
        done = subprocess.run([program, "run", case, "-o", self.path / "run", "--quiet", "--until", "0.02",
                               "--set", "output.every=0.01", "--set", "resolution.grid=12"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        snapshots = Results(self.path / "run").snapshots()
        listed = json.loads((self.path / "run" / "fluid.hdf.series").read_text())["files"]
        self.assertEqual([one["time"] for one in listed], list(snapshots.times))
        self.assertGreater(len(listed), 2)
        for one, snapshot in zip(listed, snapshots):
            reader = vtkHDFReader()
            reader.SetFileName(str(self.path / "run" / one["name"]))
            self.assertTrue(reader.CanReadFile(reader.GetFileName()))
            reader.Update()
            image = reader.GetOutput()
            self.assertEqual(image.GetDimensions(), (12, 12, 12))
            np.testing.assert_allclose(image.GetSpacing(), snapshot.spacing)
            for name in snapshot.fields:
                read = vtk_to_numpy(image.GetPointData().GetArray(name))
                np.testing.assert_array_equal(read, stored(snapshot.fields[name]))


def stored(values):
    """A field of a snapshot in the order of VTK: x fastest, components last."""
    return np.swapaxes(values, 0, 2).reshape(-1, *values.shape[3:])


if __name__ == "__main__":
    unittest.main()
