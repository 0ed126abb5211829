# SPDX-License-Identifier: MIT
"""Labels of points that do not cover each other or the points."""
import numpy as np

PLACES = [(dx * r, dy * r) for r in (5, 10, 16, 23, 31, 40)
          for dx, dy in ((1, 1), (1, -1), (-1, 1), (-1, -1), (1, 0), (-1, 0), (0, 1), (0, -1))]  # typographic points


def free_labels(axis, points, texts, fontsize=8):
    """Writes each text at the nearest place beside its point where it covers no other and no point, with a line to it.

    The limits and scales of the axes must be set, and its place in the figure. Returns the boxes of the texts in pixels,
    (N, 4): left, bottom, right, top.
    """
    figure = axis.figure
    renderer = figure.canvas.get_renderer()
    per_point = figure.dpi / 72
    marks = axis.transData.transform(np.asarray(points, float))
    taken = [np.concatenate([mark - 3 * per_point, mark + 3 * per_point]) for mark in marks]
    boxes = []
    for own, (mark, text) in enumerate(zip(marks, texts)):
        label = axis.annotate(text, points[own], xytext=(0, 0), textcoords="offset points", fontsize=fontsize, ha="center",
                              va="center", arrowprops={"arrowstyle": "-", "linewidth": 0.4, "color": "grey", "shrinkA": 0, "shrinkB": 2})
        half = text_half(label, renderer)
        for dx, dy in PLACES:
            centre = mark + per_point * np.array([dx, dy]) + np.sign([dx, dy]) * half
            box = np.concatenate([centre - half, centre + half])
            others = taken[:own] + taken[own + 1: len(marks)] + boxes
            if not any(overlap(box, other) for other in others):
                break
        label.set_position((centre - mark) / per_point)
        boxes.append(box)
    return np.array(boxes)


def text_half(label, renderer):
    """Half the width and height of a text in pixels, without its line."""
    from matplotlib.text import Text

    extent = Text.get_window_extent(label, renderer)
    return 0.5 * np.array([extent.width, extent.height])


def overlap(a, b):
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]
