# SPDX-License-Identifier: MIT
"""GIFs of all snapshots: the liquid from the side, with its bubbles, or fields in a plane."""
import io

import matplotlib.pyplot as plt
import numpy as np

from .bubble_views import draw_bubble_views
from .planes import drawn_fields, panels_of, plane_figure
from .request import request_of
from .style import chosen_steps, extension, field_norm
from .views import draw_side_view, has_view

MOST = 200          # frames; of more snapshots evenly spaced ones are drawn
MILLISECONDS = 80   # that a frame is shown: 12.5 in a second
PAUSE = 1000        # that the last one is
DOTS_PER_INCH = 100


def write_gif(figures, path):
    """Writes figures of one size as the frames of a GIF."""
    from PIL import Image

    frames = []
    for figure in figures:
        buffer = io.BytesIO()
        figure.savefig(buffer, format="png", dpi=DOTS_PER_INCH)
        plt.close(figure)
        frames.append(Image.open(buffer).convert("RGB").quantize(256))
    path = path.with_suffix(".gif")
    frames[0].save(path, save_all=True, append_images=frames[1:], loop=0,
                   duration=[MILLISECONDS] * (len(frames) - 1) + [PAUSE])
    return path


def steps_of(run, snapshots):
    return chosen_steps(run, snapshots, MOST)


def plot_side_views(run, out):
    """The liquid of a 3-D scene with a free surface; with bubbles these as well."""
    if not has_view(run) or request_of(run).fields:
        return []
    snapshots = run.snapshots()
    steps = steps_of(run, snapshots)
    if run.has("bubbles.vtkhdf"):
        bubbles = run.snapshots("bubbles")
        return [write_gif((draw_bubble_views(run, snapshots, bubbles, [k], steps) for k in steps), out / "bubble_views")]
    return [write_gif((draw_side_view(run, snapshots, [k], steps) for k in steps), out / "side_view")]


def plot_planes(run, out):
    """Fields in a plane: those asked for; without a request the first one, where there is no view from the side."""
    if has_view(run) and not request_of(run).fields:
        return []
    snapshots = run.snapshots()
    steps = steps_of(run, snapshots)
    names = drawn_fields(run, snapshots)
    files = []
    for name in names if request_of(run).fields else names[:1]:
        plane, panels = panels_of(run, name, snapshots, steps)
        samples = [panel.values[np.isfinite(panel.values)] for panel in panels]
        norm = field_norm(name, samples, request_of(run).ranges.get(name))
        ends = extension(norm, samples)
        files.append(write_gif((plane_figure(run, name, plane, [panel], norm, ends, panels) for panel in panels),
                               out / name))
    return files


PICTURES = (plot_side_views, plot_planes)
