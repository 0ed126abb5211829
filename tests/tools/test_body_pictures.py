# SPDX-License-Identifier: MIT
"""Bodies in pictures of planes: where they stand at a time, their outline, and where a plane cuts them."""
import unittest
from types import SimpleNamespace
from unittest import mock

import paths
import numpy as np
from matplotlib.colors import to_rgb
from spume_tools.plots import bodies
from spume_tools.plots.bodies import Body, copies, cut, outline, places, turned
from spume_tools.plots.closing import closed, open_edges
from spume_tools.plots.planes import Plane
from spume_tools.plots.shares import fill_bodies
from spume_tools.plots.style import SOLID, plt

# A square of two triangles.
SQUARE = np.array([[[0, 0, 0], [1, 0, 0], [1, 1, 0]], [[0, 0, 0], [1, 1, 0], [0, 1, 0]]], float)


def run_in(lower, upper, **sides):
    domain = {"lower": lower, "upper": upper, **sides}
    return SimpleNamespace(dimensions=len(lower), case={"domain": domain}, bounds=lambda: (np.array(lower), np.array(upper)))


def run_of(**columns):
    table = {name: np.array(values, float) for name, values in columns.items()}
    return SimpleNamespace(dimensions=2, has=lambda name: True, table=lambda name: table)


def box():
    """The triangles of a cube from -1 to 1, outwards."""
    corner = lambda i: [1 if i & bit else -1 for bit in (1, 2, 4)]
    faces = [(0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6)]
    return np.array([[corner(a), corner(b), corner(c)] for w, x, y, z in faces for a, b, c in ((w, x, y), (w, y, z))], float)


def volume_of(corners):
    """What a closed surface holds, by the theorem of Gauss."""
    return np.sum(np.linalg.det(corners)) / 6


def pixels_with(*standing_there, dimensions=2, draw=lambda axis, run: bodies.draw_shapes(axis, run, 0)):
    """A picture, 200 x 200 pixels, of bodies in a square or cube from -1 to 1."""
    figure, axis = plt.subplots(figsize=(2, 2), dpi=100)
    axis.set(xlim=(-1, 1), ylim=(-1, 1), aspect="equal", position=(0, 0, 1, 1))
    run = SimpleNamespace(**vars(run_in([-1.0] * dimensions, [1.0] * dimensions)), has=lambda name: False, spacing=0.1)
    with mock.patch.object(bodies, "bodies_of", lambda *_: list(standing_there)):
        draw(axis, run)
    figure.canvas.draw()
    pixels = np.asarray(figure.canvas.buffer_rgba())[:, :, :3].copy()
    plt.close(figure)
    return pixels


class Bodies(unittest.TestCase):
    def test_a_turn_is_by_the_right_hand(self):
        np.testing.assert_allclose(turned([0, 0, 90], np.array([[1.0, 0, 5]])), [[0, 1, 5]], atol=1e-15)
        np.testing.assert_allclose(turned([0, 90, 0], np.array([[1.0, 2, 0]])), [[0, 2, -1]], atol=1e-15)

    def test_the_row_of_the_time_tells_the_place(self):
        run = run_of(t=[0, 0, 1, 1], body=[0, 1, 0, 1], position_x=[9, 0.5, 9, 2.5], position_y=[9, 0.5, 9, 0.5],
                     turn_z=[0, 0, 0, 90])
        at = places(run, Body(1, SQUARE, False))
        np.testing.assert_allclose(at(0.1), SQUARE, atol=1e-15)
        np.testing.assert_allclose(at(0.9)[0], [[3, 0, 0], [3, 1, 0], [2, 1, 0]], atol=1e-12)

    def test_bodies_beyond_periodic_sides_are_drawn_where_they_come_back(self):
        run = run_in([0, 0], [4, 2], x="periodic", bottom="free-slip")
        corner = lambda body: [tuple(copy.reshape(-1, 3).min(axis=0)[:2]) for copy in copies(run, body, *run.bounds())]
        self.assertEqual(corner(SQUARE + [1.5, 0, 0]), [(1.5, 0)])
        self.assertEqual(corner(SQUARE + [3.5, 0, 0]), [(-0.5, 0), (3.5, 0)])
        self.assertEqual(corner(SQUARE + [9, 1.5, 0]), [(1, 1.5)])      # twice around
        self.assertEqual(corner(SQUARE - [4.5, 0, 0]), [(-0.5, 0), (3.5, 0)])
        self.assertEqual(corner(SQUARE + [3, 0, 0]), [(3, 0)])          # ends on the side
        self.assertEqual(corner(SQUARE * [4, 1, 1]), [(0, 0)])          # without end along x
        self.assertEqual(corner(SQUARE + [1.5, -0.5, 0]), [(1.5, -0.5)])  # below a wall there is no other side

    def test_a_body_in_a_corner_of_two_periodic_axes_has_four_parts(self):
        run = run_in([0, 0], [4, 2], x="periodic", y="periodic")
        self.assertEqual(len(copies(run, SQUARE + [3.5, 1.5, 0], *run.bounds())), 4)

    def test_the_outline_leaves_inner_edges_out(self):
        edges = outline(SQUARE)
        self.assertEqual(len(edges), 4)
        self.assertAlmostEqual(np.linalg.norm(edges[:, 1] - edges[:, 0], axis=1).sum(), 4)

    def test_the_outline_is_that_of_the_shape_in_any_unit(self):
        for length in (1e-9, 1e6):
            with self.subTest(length=length):
                moved = (length * (SQUARE + [0.3, 0.7, 0])).astype(np.float32)
                moved[1] = np.nextafter(moved[1], np.inf, dtype=np.float32)  # corners of floats, found one by one
                self.assertEqual(len(outline(moved.astype(float))), 4)

    def test_bodies_are_filled_without_seams(self):
        # A fan of triangles whose edges cross pixels at all angles.
        angle = np.linspace(0, 2 * np.pi, 41)
        rim = np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
        disc = np.stack([np.zeros((40, 3)), rim[:-1], rim[1:]], axis=1)
        pixels = pixels_with(Body(0, disc, False))[30:-30, 30:-30]
        self.assertEqual(len(np.unique(pixels[60:80].reshape(-1, 3), axis=0)), 1)

    def test_what_is_taken_away_from_a_body_is_not_filled(self):
        ring = [Body(0, SQUARE - [0.5, 0.5, 0], False), Body(1, 0.5 * SQUARE - [0.25, 0.25, 0], False, True)]
        self.assert_ring(pixels_with(*ring, draw=lambda axis, run: fill_bodies(axis, run, Plane((0, 1), None, None, *run.bounds()), 0)))

    def test_what_a_plane_cuts_of_a_body_is_filled(self):
        pile, core = (half * box() for half in (0.5, 0.25))
        pictured = pixels_with(Body(0, pile, False), Body(1, core, False, True), dimensions=3,
                               draw=lambda axis, run: fill_bodies(axis, run, Plane((0, 2), 1, 0.1, *run.bounds()), 0))
        self.assert_ring(pictured)

    def assert_ring(self, pixels):
        """Solid between squares from 50 to 150 and from 75 to 125 pixels."""
        solid = np.all(pixels == np.round(255 * np.array(to_rgb(SOLID))), axis=-1)
        for within in (np.s_[55:70, 55:145], np.s_[130:145, 55:145], np.s_[55:145, 55:70], np.s_[55:145, 130:145]):
            self.assertTrue(solid[within].all())
        for without in (np.s_[80:120, 80:120], np.s_[5:45, 5:195], np.s_[5:195, 155:195]):
            self.assertFalse(solid[without].any())

    def test_surfaces_that_leave_the_domain_are_closed(self):
        lower, upper = np.array([-1.0] * 3), np.array([1.0] * 3)
        whole = box()
        along_z = np.ptp(whole[:, :, 2], axis=1) > 0
        pile = whole[along_z]
        beach = np.array([[[-2, -2, -1.5], [2, -2, 0.5], [2, 2, 0.5]], [[-2, -2, -1.5], [2, 2, 0.5], [-2, 2, -1.5]]], float)
        for surface, volume in ((whole, 8.0), (pile, 8.0)):
            self.assertEqual(len(open_edges(closed(surface, lower, upper))), 0)
            self.assertAlmostEqual(volume_of(closed(surface, lower, upper)), volume)
        solid = closed(beach, lower, upper)
        self.assertEqual(len(open_edges(solid)), 0)
        self.assertAlmostEqual(volume_of(solid), 16 * (-0.5 - solid[..., 2].min()))
        ceiling = closed(beach[:, ::-1], lower, upper)
        self.assertGreater(ceiling[..., 2].max(), 1)
        self.assertAlmostEqual(volume_of(ceiling), 16 * (ceiling[..., 2].max() + 0.5))

    def test_what_lies_outside_a_tank_is_solid(self):
        pixels = pixels_with(Body(0, 0.5 * SQUARE - [0.25, 0.25, 0], True))  # from 75 to 125
        solid = np.all(pixels == np.round(255 * np.array(to_rgb(SOLID))), axis=-1)
        inside = (slice(78, 122), slice(78, 122))
        self.assertFalse(solid[inside].any())
        for outside in (np.s_[5:70, 5:195], np.s_[130:195, 5:195], np.s_[5:195, 5:70], np.s_[5:195, 130:195]):
            self.assertTrue(solid[outside].all())

    def test_a_plane_through_corners_cuts_all_around(self):
        corners = np.array([[1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], float)
        octahedron = np.array([[corners[a], corners[b], corners[c]] for a in (0, 2) for b in (1, 3) for c in (4, 5)])
        lines = cut(octahedron, 1, 0.0, (0, 2))
        self.assertAlmostEqual(sum(np.linalg.norm(line[1] - line[0]) for line in lines), 4 * np.sqrt(2), places=5)


if __name__ == "__main__":
    unittest.main()
