# SPDX-License-Identifier: MIT
"""The liquid of a 3-D scene with a free surface, shaded, seen from the side and above."""
import matplotlib.pyplot as plt
import numpy as np

from .style import WATER, chosen_steps, field_norm, finish, panel_grid


def smooth(image, mask, sigma):
    """Gaussian blur of an image over the pixels of a mask only."""
    reach = int(3 * sigma) + 1
    kernel = np.exp(-0.5 * (np.arange(-reach, reach + 1) / sigma) ** 2)

    def blur(a):
        padded = np.pad(a, ((reach, reach), (0, 0)))
        a = sum(w * padded[k: k + a.shape[0]] for k, w in enumerate(kernel))
        padded = np.pad(a, ((0, 0), (reach, reach)))
        return sum(w * padded[:, k: k + a.shape[1]] for k, w in enumerate(kernel))

    weight = blur(mask.astype(float))
    return np.where(mask, blur(np.where(mask, image, 0.0)) / np.maximum(weight, 1e-12), 0.0)


def shaded_liquid(position, values, radius, azimuth, elevation, pixels, norm):
    """An image of the liquid: discs into a depth buffer, the depth smoothed, light from its slope.

    position (N, 3), values (N,) colour the surface; the view direction turns from +y towards -x by azimuth and looks
    down by elevation (radians). Returns rgba (height, width, 4) and the extent in view units.
    """
    right = np.array([np.cos(azimuth), -np.sin(azimuth), 0.0])
    forward = np.array([np.sin(azimuth) * np.cos(elevation), np.cos(azimuth) * np.cos(elevation), -np.sin(elevation)])
    up = np.cross(right, forward)
    u, v, depth = position @ right, position @ up, -(position @ forward)
    low = np.array([u.min(), v.min()]) - 2 * radius
    high = np.array([u.max(), v.max()]) + 2 * radius
    scale = pixels / (high[0] - low[0])
    shape = (int(np.ceil((high[1] - low[1]) * scale)), pixels)
    reach = max(1.0, radius * scale)
    column, row = (u - low[0]) * scale, (v - low[1]) * scale
    order = np.argsort(depth)  # far first: where several particles share a pixel, the last, nearest, one is kept
    row, column = np.round(row[order]).astype(int), np.round(column[order]).astype(int)
    depth, values = depth[order], values[order]
    surface = np.full(shape[0] * shape[1], -np.inf)
    colour = np.zeros_like(surface)
    layer, layer_colour = np.empty_like(surface), np.empty_like(surface)
    span = np.arange(-int(np.ceil(reach)), int(np.ceil(reach)) + 1)
    for di, dj in ((di, dj) for di in span for dj in span if di * di + dj * dj <= reach**2):
        inside = (row + di >= 0) & (row + di < shape[0]) & (column + dj >= 0) & (column + dj < shape[1])
        pixel = (row[inside] + di) * shape[1] + column[inside] + dj
        layer.fill(-np.inf)
        layer[pixel] = depth[inside] + radius * np.sqrt(1 - (di * di + dj * dj) / reach**2)
        layer_colour[pixel] = values[inside]
        nearer = layer > surface
        surface[nearer] = layer[nearer]
        colour[nearer] = layer_colour[nearer]
    surface, colour = surface.reshape(shape), colour.reshape(shape)
    mask = np.isfinite(surface)
    # Twice: once to merge the discs, once over pixels of like depth only, so that a crest stays apart from the trough.
    soft = smooth(np.where(mask, surface, 0.0), mask, 0.9 * reach)
    same = mask & (np.abs(np.where(mask, surface, 0.0) - soft) < 4 * radius)
    soft = np.where(same, smooth(np.where(same, surface, 0.0), same, 0.9 * reach), np.where(mask, surface, 0.0))
    slope_v, slope_u = np.gradient(soft * scale)
    edge = ~(mask & np.roll(mask, 1, 0) & np.roll(mask, -1, 0) & np.roll(mask, 1, 1) & np.roll(mask, -1, 1))
    slope_u[edge] = slope_v[edge] = 0.0
    normal = np.stack([-slope_u, -slope_v, np.ones(shape)], axis=-1)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    light = np.array([-0.45, 0.75, 0.5]) / np.linalg.norm([-0.45, 0.75, 0.5])
    diffuse = np.clip(normal @ light, 0, 1)
    half = light + np.array([0.0, 0.0, 1.0])
    glint = np.clip(normal @ (half / np.linalg.norm(half)), 0, 1) ** 60
    rgb = WATER(norm(smooth(colour, mask, 0.5 * reach)))[..., :3]
    rgb = np.clip(rgb * (0.6 + 0.6 * diffuse)[..., None] + 0.45 * glint[..., None], 0, 1)
    rgba = np.concatenate([rgb, mask[..., None].astype(float)], axis=-1)
    return rgba, (low[0], high[0], low[1], high[1])


def draw_side_view(run, snapshots, path):
    """The liquid of up to six times, shaded and coloured by speed. A narrow periodic width is repeated for the eye."""
    lower, upper = run.bounds()
    length, width = (upper - lower)[:2]
    copies = max(1, int(round(0.45 * length / width))) if run.case["domain"].get("y") == "periodic" else 1
    steps = chosen_steps(run, snapshots)
    speeds = [snapshots[int(step)].field("speed") for step in steps]
    norm = field_norm("speed", speeds)
    images = []
    for step, speed in zip(steps, speeds):
        snapshot = snapshots[int(step)]
        position = np.concatenate([snapshot.position + [0, copy * width, 0] for copy in range(copies)])
        images.append((snapshot.time, *shaded_liquid(position, np.tile(speed, copies), 0.75 * run.spacing,
                                                     np.radians(20), np.radians(24), 620, norm)))
    extents = np.array([extent for *_, extent in images])
    left, right = extents[:, 0].min(), extents[:, 1].max()
    bottom, top = extents[:, 2].min(), extents[:, 3].max()
    rows, columns = panel_grid(len(images), right - left, top - bottom)
    size = min(10.0 / columns / (right - left), 7.5 / rows / (top - bottom))
    figure, axes = plt.subplots(rows, columns, squeeze=False, constrained_layout=True,
                                figsize=(columns * (right - left) * size + 1.2, rows * ((top - bottom) * size + 0.3)))
    for axis in axes.flat:
        axis.set_axis_off()
    for axis, (time, rgba, extent) in zip(axes.flat, images):
        axis.imshow(rgba, origin="lower", extent=extent, interpolation="bilinear")
        axis.set(xlim=(left, right), ylim=(bottom, top), title=f"t = {time:.4g}")
    figure.colorbar(plt.cm.ScalarMappable(norm, WATER), ax=list(axes.flat), label="speed", shrink=0.7, extend="max")
    return finish(figure, path)


def has_free_surface(run):
    """Whether particles lay on a free surface at any time, as the series of the run says."""
    return "surface_particles" in run.series and bool(np.nanmax(run.series["surface_particles"], initial=0) > 0)


def plot_side_view(run, out):
    """The liquid of a 3-D scene with a free surface, shaded, seen from the side and above."""
    if run.dimensions != 3 or run.on_grid or not has_free_surface(run):
        return []
    return [draw_side_view(run, run.snapshots(), out / "side_view.png")]


PICTURES = (plot_side_view,)
