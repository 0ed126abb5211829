# SPDX-License-Identifier: MIT
"""The liquid of a 3-D scene with a free surface, with tank, solids and bubbles, seen from the side and above."""
import numpy as np
from matplotlib.transforms import offset_copy

from .bodies import standing
from .liquid import liquid_surface
from .renderer import Scene, View
from .shares import share_in_space
from .style import chosen_steps, finish, panel_grid, panel_size, picture_axes, time_title, title_of
from .sums import boxes_of, sides_of
from .walls import bounds_at

WATER = (0.62, 0.74, 0.82)
STONE = (0.80, 0.76, 0.69)
FLOOR = (0.93, 0.92, 0.90)
EDGES = (0.35, 0.35, 0.36)
OBLIQUE = View(azimuth=20, elevation=22)
OCCLUSION = 5.0   # spacings within which surfaces shade each other
BELOW = 0.32      # inches under a picture for the scale bar
DOTS_PER_INCH = 130


class Stage:
    """The part of the domain that is drawn, its walls and solids.

    lower, upper: the box that is drawn, over all times; copies: how often a narrow periodic width is repeated for the eye; deepest: a
    height that is drawn in any case; cut_below: whether the liquid goes on below the box.
    """

    def __init__(self, run, snapshots, steps, copies=None, deepest=np.inf):
        self.run = run
        bounds = np.array([bounds_at(run, snapshots.times[int(step)]) for step in steps])
        self.lower, self.upper = bounds[:, 0].min(axis=0), bounds[:, 1].max(axis=0)
        domain = run.case["domain"]
        length, width = (self.upper - self.lower)[:2]
        periodic = sides_of(domain, 1) == "periodic"
        self.copies = copies or (max(1, int(round(0.45 * length / width))) if periodic else 1)
        self.upper[1] += (self.copies - 1) * width
        self._fit(snapshots, steps, deepest)

    def _fit(self, snapshots, steps, deepest):
        """The air above the liquid and depths that never move are not drawn, nor what lies beyond open sides."""
        run, spacing = self.run, self.run.spacing
        high, low, depth = [], [], []
        for step in steps:
            position = snapshots[int(step)].position
            high.append(np.percentile(position, 99.98, axis=0))
            low.append(np.percentile(position, 0.02, axis=0))
            column = np.floor(position[:, :2] / (3 * spacing)).astype(np.int64)
            _, index = np.unique(column, axis=0, return_inverse=True)
            top = np.full(index.max() + 1, -np.inf)
            np.maximum.at(top, index.ravel(), position[:, 2])
            depth.append(np.percentile(top, 0.5))
        solids = [corner for _, corner in boxes_of(run.case)]
        solids += [self._in_box(corners).reshape(-1, 3).max(axis=0)
                   for step in steps for corners in self._bodies(snapshots.times[int(step)])]
        highest = max([np.max(high, axis=0)[2] + 2 * spacing, *(corner[2] for corner in solids)])
        self.upper[2] = min(self.upper[2], highest)
        for axis in range(3):
            kinds = sides_of(run.case["domain"], axis)
            if kinds[0] == "open":
                self.lower[axis] = max(self.lower[axis], np.min(low, axis=0)[axis] - 2 * spacing)
            if kinds[1] == "open" and axis < 2:
                self.upper[axis] = min(self.upper[axis], np.max(high, axis=0)[axis] + 2 * spacing)
        # Deep water without ends is cut below its surface, where no solid stands in it.
        length, deep = self.upper[0] - self.lower[0], self.lower[2]
        if not solids and sides_of(run.case["domain"], 0) == "periodic":
            self.lower[2] = max(self.lower[2], min(np.min(depth) - 0.15 * length, deepest - 0.05 * length))
        self.cut_below = self.lower[2] > deep

    def box_at(self, time):
        """The part of the box that the domain has at a time."""
        low, high = bounds_at(self.run, time)
        stays = [sides_of(self.run.case["domain"], axis) == "periodic" for axis in range(3)]
        return np.where(stays, self.lower, np.maximum(self.lower, low)), np.where(stays, self.upper, np.minimum(self.upper, high))

    def _in_box(self, corners):
        """Those of some triangles that reach into the box that is drawn."""
        return corners[np.all((corners.max(axis=1) >= self.lower) & (corners.min(axis=1) <= self.upper), axis=1)]

    def _bodies(self, time):
        """The triangles of each body that reaches into the box; all around the others is solid: they are the tank."""
        return [corners for body, corners in standing(self.run, time, (self.lower, self.upper))
                if not body.outside and len(self._in_box(corners))]

    def add_to(self, scene, time, floor=True):
        """Floor, solids where they stand at a time, and the edges of the domain."""
        lower, upper = self.box_at(time)
        lines = []
        for axis in range(3):
            a, b = [k for k in range(3) if k != axis]
            for i in (lower[a], upper[a]):
                for j in (lower[b], upper[b]):
                    pair = np.zeros((2, 3))
                    pair[:, a], pair[:, b] = i, j
                    pair[:, axis] = lower[axis], upper[axis]
                    lines.append(pair)
        scene.add_lines(lines, EDGES)
        bottom = sides_of(self.run.case["domain"], 2)[0]
        thickness = 0.01 * (upper[0] - lower[0])
        if floor and bottom in ("free-slip", "no-slip") and not self.cut_below:
            scene.add_box(lower - [0, 0, thickness], [upper[0], upper[1], lower[2]], FLOOR)
        # Solids cover the surface that the liquid has on their faces, and on the sides of the box that cut both.
        cover = 0.2 * self.run.spacing
        for low, high in boxes_of(self.run.case, bounds_at(self.run, time)):
            scene.add_box(low - cover, high + cover, STONE)
        beyond = 0.1 * cover
        for corners in self._bodies(time):
            for side, outside in ((lower, lower - beyond), (upper, upper + beyond)):
                corners = np.where(np.abs(corners - side) < beyond, outside, corners)
            scene.add_solid(corners, lower - beyond, upper + beyond, STONE)

    def cut(self, position):
        """Particles that are drawn."""
        return position[position[:, 2] > self.lower[2] - 3 * self.run.spacing]


def liquid_of(stage, snapshot):
    """The surface of a snapshot in the box that is drawn."""
    case = stage.run.case
    return liquid_surface(case, stage.cut(snapshot.position), stage.run.spacing, stage.copies,
                          bottom=stage.lower[2] if stage.cut_below else None,
                          bodies=lambda *grid: share_in_space(stage.run, snapshot.time, *grid),
                          bounds=bounds_at(stage.run, snapshot.time))


def scale_bar(axis, view, stage):
    """A line of a round length along the lower front edge, with its length beneath."""
    length = stage.upper[0] - stage.lower[0]
    exponent = np.floor(np.log10(length))
    bar = max(m * 10**exponent for m in (0.1, 0.2, 0.5, 1, 2, 5) if m * 10**exponent <= 0.5 * length)
    (x0, y0), (x1, y1) = view.project(np.array([stage.lower, stage.lower + [bar, 0, 0]]))
    tilt = np.degrees(np.arctan2(y1 - y0, x1 - x0))
    axis.annotate("", (x0, y0), (x1, y1), annotation_clip=False, xycoords=offset_copy(axis.transData, axis.figure, y=-0.08),
                  textcoords=offset_copy(axis.transData, axis.figure, y=-0.08),
                  arrowprops={"arrowstyle": "|-|, widthA=0.25, widthB=0.25", "linewidth": 1.2, "shrinkA": 0, "shrinkB": 0})
    axis.text(0.5 * (x0 + x1), 0.5 * (y0 + y1), f"{bar:g}" + (" m" if stage.run.si else ""), ha="center", va="top", fontsize=8,
              rotation=tilt, transform=offset_copy(axis.transData, axis.figure, y=-0.14))


def framed(view, stage):
    """The frame of a stage."""
    frame = view.frame(stage.lower, stage.upper)
    return frame + 0.005 * (frame[1] - frame[0]) * np.array([-1, 1, -1, 1])


def show(axis, image, frame, words):
    """An image of a frame in its axes."""
    axis.imshow(image, extent=frame, interpolation="lanczos", aspect="auto")
    axis.set(xlim=frame[:2], ylim=frame[2:])
    axis.set_title(words, loc="left", pad=2)


def draw_side_view(run, snapshots, steps, of_steps=None):
    """A figure of the liquid at some steps. of_steps: the frame is that of these, for a figure that is one of several."""
    stage = Stage(run, snapshots, steps if of_steps is None else of_steps)
    frame = framed(OBLIQUE, stage)
    width, height = frame[1] - frame[0], frame[3] - frame[2]
    rows, columns = panel_grid(len(steps), width, height)
    size = panel_size(rows, columns, width, height)
    figure, axes = picture_axes(rows, [width] * columns, [height] * rows, size, below=BELOW, title=title_of(run))
    for axis, step in zip(axes.flat, steps):
        snapshot = snapshots[int(step)]
        scene = Scene()
        scene.add_surface(liquid_of(stage, snapshot), WATER)
        stage.add_to(scene, snapshot.time)
        image = scene.render(OBLIQUE, frame, int(width * size * DOTS_PER_INCH), OCCLUSION * run.spacing)
        show(axis, image, frame, time_title(snapshot.time, run.si))
        scale_bar(axis, OBLIQUE, stage)
    return figure


def has_free_surface(run):
    """Whether particles lay on a free surface at any time, as the series of the run says."""
    return "surface_particles" in run.series and bool(np.nanmax(run.series["surface_particles"], initial=0) > 0)


def has_view(run):
    """Whether there is a liquid to be seen from the side."""
    return run.dimensions == 3 and not run.on_grid and has_free_surface(run) and run.has("fluid.vtkhdf")


def plot_side_view(run, out):
    """The liquid of a 3-D scene with a free surface at up to six times, with tank and solids."""
    if not has_view(run):
        return []
    snapshots = run.snapshots()
    return [finish(draw_side_view(run, snapshots, chosen_steps(run, snapshots)), out / "side_view.png")]


PICTURES = (plot_side_view,)
