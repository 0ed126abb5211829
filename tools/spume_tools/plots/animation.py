# SPDX-License-Identifier: MIT
"""GIFs of all snapshots: the liquid from the side, with its bubbles, or fields in a plane. Where ffmpeg is installed it
makes an MP4 of each as well."""
import io
import shutil
import subprocess
import sys

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


def write_film(figures, path):
    """Writes figures of one size as the frames of a GIF, and of an MP4 where ffmpeg is there. Returns the files."""
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
    return [path, *write_mp4(frames, path.with_suffix(".mp4"))]


def write_mp4(frames, path):
    """The frames as H.264, which every browser and player shows; no file without ffmpeg."""
    program = shutil.which("ffmpeg")
    if program is None:
        return []
    # Colours are stored for four pixels together: width and height are even.
    width, height = (size - size % 2 for size in frames[0].size)
    pixels = b"".join(frame.convert("RGB").crop((0, 0, width, height)).tobytes() for frame in frames)
    done = subprocess.run([program, "-y", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{width}x{height}",
                           "-r", str(1000 / MILLISECONDS), "-i", "-", "-pix_fmt", "yuv420p", str(path)],
                          input=pixels, capture_output=True)
    if done.returncode:
        print(f"{path} left out: {program} says {done.stderr.decode(errors='replace').strip()}", file=sys.stderr)
        path.unlink(missing_ok=True)
        return []
    return [path]


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
        return write_film((draw_bubble_views(run, snapshots, bubbles, [k], steps) for k in steps), out / "bubble_views")
    return write_film((draw_side_view(run, snapshots, [k], steps) for k in steps), out / "side_view")


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
        files += write_film((plane_figure(run, name, plane, [panel], norm, ends, panels) for panel in panels), out / name)
    return files


PICTURES = (plot_side_views, plot_planes)
