# SPDX-License-Identifier: MIT
"""Bubbles as spheres within the liquid, from the side and from beneath."""
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm, Normalize

from ..results import MissingResult, hinze_radius
from .renderer import Scene, View
from .request import request_of
from .style import chosen_steps, evenly, finish, panel_grid, panel_size, picture_axes, time_title, title_of
from .views import BELOW, DOTS_PER_INCH, OBLIQUE, WATER, Stage, framed, has_view, liquid_of, scale_bar, show

BENEATH = View(azimuth=0, elevation=-90)
SMALLEST = 1.5    # pixels across that a bubble is drawn with at least
CLEARNESS = 0.28  # opacity of the water, so that bubbles beneath its surface are seen


def length_of_colours(run):
    """What radii are divided by where colours tell of them, and the words for it: the Hinze radius where there is one."""
    try:
        return hinze_radius(run), "radius / Hinze radius"
    except MissingResult:
        return 1.0, "radius [m]" if run.si else "radius"


def radius_norm(radius):
    """Colours of radii over their range, logarithmic where that is wide; about the radius where all are alike."""
    if not len(radius):
        return Normalize(0, 1)
    low, high = max(radius.min(), 0.01 * radius.max()), radius.max()
    if high > 5 * low:
        return LogNorm(low, high)
    return Normalize(low, high) if high > 1.2 * low else Normalize(0.5 * high, 1.5 * high)


def bubbles_at(bubbles, time):
    """The bubbles of a time; none where no snapshot is near it, as before the first one."""
    if not len(bubbles):
        return None
    k = int(np.argmin(np.abs(bubbles.times - time)))
    return bubbles[k] if np.isclose(bubbles.times[k], time, rtol=1e-6, atol=1e-9) else None


def scene_of(run, stage, liquid, shot, view, size, colours):
    """Water, tank and bubbles at one time. size: inches per unit of length."""
    scene = Scene()
    stage.add_to(scene, liquid.time, floor=view is not BENEATH)
    scene.add_surface(liquid_of(stage, liquid), WATER, opacity=CLEARNESS)
    if shot is not None and len(shot):
        width = run.bounds()[1][1] - run.bounds()[0][1]
        unit, norm, cmap = colours
        radius = shot.field("radius")
        place = np.concatenate([shot.position + [0, k * width, 0] for k in range(stage.copies)])
        least = 0.5 * SMALLEST / (size * DOTS_PER_INCH)
        scene.add_spheres(place, np.tile(np.maximum(radius, least), stage.copies),
                          np.tile(cmap(norm(radius / unit)), (stage.copies, 1)))
    return scene


def draw_bubble_views(run, fluid, bubbles, steps, of_steps=None):
    """A figure: rows of times, from the side and above, and from beneath through the floor.

    of_steps: frame and colours are those of these steps, for a figure that is one of several.
    """
    of_steps = steps if of_steps is None else of_steps
    liquids = [fluid[int(step)] for step in steps]
    shots = [bubbles_at(bubbles, liquid.time) for liquid in liquids]
    unit, words = length_of_colours(run)
    known = [shot for shot in (bubbles_at(bubbles, fluid.times[int(step)]) for step in of_steps) if shot is not None]
    radius = np.concatenate([np.empty(0), *(shot.field("radius") / unit for shot in known)])
    deepest = min((shot.position[:, 2].min() for shot in known if len(shot)), default=np.inf)
    stage = Stage(run, fluid, of_steps, copies=1, deepest=deepest)
    norm, cmap = radius_norm(radius), plt.cm.plasma
    side, beneath = framed(OBLIQUE, stage), framed(BENEATH, stage)
    # One scale for both, beside or above each other, whichever leaves less room empty.
    (w, h), (v, g) = ((f[1] - f[0], f[3] - f[2]) for f in (side, beneath))
    above = abs(w - v) * min(h, g) < abs(h - g) * min(w, v)
    width, height = (max(w, v), h + g) if above else (w + v, max(h, g))
    rows, columns = panel_grid(len(steps), width, height)
    size = panel_size(rows, columns, width, height, page=(12.0, 8.5))
    several = len(radius) and radius.max() > 1.2 * radius.min()
    room = {"below": BELOW, "title_room": 0.45, "right": 1.0 if several else 0.1, "title": title_of(run)}
    if above:
        heights = np.tile([h, g], rows)
        figure, axes = picture_axes(2 * rows, [width] * columns, heights, size, **room)
        axes = axes.reshape(rows, 2, columns).swapaxes(1, 2)
    else:
        figure, axes = picture_axes(rows, [w, v] * columns, [height] * rows, size, **room)
        axes = axes.reshape(rows, columns, 2)
    for axis in axes.reshape(-1, 2)[len(steps):].flat:
        axis.remove()
    for pair, liquid, shot in zip(axes.reshape(-1, 2), liquids, shots):
        count = 0 if shot is None else len(shot)
        for axis, view, frame, words_of in (
                (pair[0], OBLIQUE, side, f"{time_title(liquid.time, run.si)}\n{count} bubble{'s' * (count != 1)}"),
                (pair[1], BENEATH, beneath, "from beneath")):
            shrink(axis, frame, size)
            scene = scene_of(run, stage, liquid, shot, view, size, (unit, norm, cmap))
            show(axis, scene.render(view, frame, int((frame[1] - frame[0]) * size * DOTS_PER_INCH)), frame, words_of)
        scale_bar(pair[0], OBLIQUE, stage)
    if several:
        wide = figure.get_figwidth()
        bar = figure.add_axes((1 - 0.95 / wide, 0.2, 0.16 / wide, 0.6))
        figure.colorbar(ScalarMappable(norm, cmap), cax=bar, label=words)
        bar.yaxis.set_major_formatter("{x:g}")
        bar.yaxis.set_minor_formatter("")
    return figure


def shrink(axis, frame, size):
    """Makes an axis as large as its frame, with its upper left corner where it was."""
    box, figure = axis.get_position(), axis.figure
    width = (frame[1] - frame[0]) * size / figure.get_figwidth()
    height = (frame[3] - frame[2]) * size / figure.get_figheight()
    axis.set_position((box.x0, box.y1 - height, width, height))


def plot_bubble_views(run, out):
    """Up to four times from the side and from beneath: bubbles as spheres in clear water."""
    if "bubbles" not in run.case or not run.has("bubbles.vtkhdf") or not has_view(run):
        return []
    fluid, bubbles = run.snapshots(), run.snapshots("bubbles")
    steps = chosen_steps(run, fluid, most=4)
    if not request_of(run).times and len(bubbles):
        there = np.flatnonzero(fluid.times >= bubbles.times[0])  # without bubbles there is another picture
        steps = there[evenly(len(there), 4)] if len(there) else steps
    return [finish(draw_bubble_views(run, fluid, bubbles, steps), out / "bubble_views.png")]


PICTURES = (plot_bubble_views,)
