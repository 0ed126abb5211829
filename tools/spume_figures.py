# SPDX-License-Identifier: MIT
"""Drawing shared by plot.py, verify.py and convergence.py: particles, shaded liquid, curves with references."""
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import EllipseCollection
from matplotlib.colors import LinearSegmentedColormap, LogNorm, Normalize

from spume_results import MissingResult

plt.rcParams.update({"figure.dpi": 130, "savefig.dpi": 130, "font.size": 9, "axes.grid": False,
                     "axes.spines.top": False, "axes.spines.right": False, "legend.frameon": False})

# Fields drawn as slices, in this order, with a perceptual map each.
FIELDS = {"speed": "viridis", "pressure": "cividis", "dissipation": "inferno", "vorticity": "RdBu_r",
          "enstrophy": "inferno"}
WATER = LinearSegmentedColormap.from_list("water", ["#06304d", "#0b5c7a", "#1f93a3", "#7fd0c8", "#f4fbf7"])


def finish(figure, path):
    if not figure.get_constrained_layout():
        figure.tight_layout()
    figure.savefig(path)
    plt.close(figure)
    return path


def has_free_surface(run):
    """A scene has a free surface when some side of its domain is open; where the case is silent, the series tells."""
    try:
        surface = run.series["surface_particles"]
        return bool(np.nanmax(surface, initial=0) > 0)
    except MissingResult:
        domain = run.case["domain"]
        axes = {"x": ("left", "right"), "y": ("front", "back"), "z": ("bottom", "top")}
        if run.dimensions == 2:
            axes = {"x": ("left", "right"), "y": ("bottom", "top")}
        return any(domain.get(axis) != "periodic" and "open" in [domain.get(side, "open") for side in sides]
                   for axis, sides in axes.items())


def chosen_steps(run, snapshots, most=6):
    """Indices of the snapshots nearest to run.picture_times; without these, evenly spaced from first to last."""
    if run.picture_times:
        return np.unique([int(np.argmin(np.abs(snapshots.times - time))) for time in run.picture_times])
    count = len(snapshots)
    return np.unique(np.linspace(0, count - 1, min(most, count)).round().astype(int))


def panel_grid(count, width, height):
    """Rows and columns of panels of the given aspect that fill about a 3:2 page."""
    shapes = [(-(-count // columns), columns) for columns in range(1, count + 1)]
    return min(shapes, key=lambda s: abs(np.log((s[1] * width) / (s[0] * height) / 1.5)) + 0.1 * (s[0] * s[1] - count))


def draw_particles(axis, x, y, values, diameter, cmap, norm):
    """Particles as discs of the given diameter in data units, so that they fill the plane at any zoom."""
    discs = EllipseCollection(np.full(len(x), diameter), np.full(len(x), diameter), np.zeros(len(x)), units="xy",
                              offsets=np.column_stack([x, y]), transOffset=axis.transData, cmap=cmap, norm=norm,
                              linewidths=0, rasterized=True)
    discs.set_array(values)
    axis.add_collection(discs)
    return discs


def field_norm(name, samples):
    """Colour limits shared by all panels: robust percentiles, so that one stray particle does not hide the rest."""
    values = np.concatenate([s[np.isfinite(s)] for s in samples])
    if not len(values):
        return Normalize(0, 1)
    low, high = np.percentile(values, [0.5, 99.5])
    if name in ("dissipation", "enstrophy") and high > 0:
        return LogNorm(max(high * 1e-4, 1e-300), high)
    if name == "speed":
        low = 0.0
    if name == "vorticity":
        high = max(abs(low), abs(high))
        low = -high
    return Normalize(low, high if high > low else low + 1)


def draw_slices(run, snapshots, name, path):
    """Panels of particles coloured by one field; in 3-D the particles within half a spacing of the middle plane y."""
    lower, upper = run.bounds()
    spacing = run.spacing
    steps = chosen_steps(run, snapshots)
    loaded = []
    for step in steps:
        snapshot = snapshots[int(step)]
        values = snapshot.field(name)
        if values.ndim > 1:
            values = values[:, -1] if run.dimensions == 2 else np.linalg.norm(values, axis=1)
        position = snapshot.position
        if run.dimensions == 3:
            near = np.abs(position[:, 1] - 0.5 * (lower[1] + upper[1])) <= 0.5 * spacing
            position, values = position[near][:, [0, 2]], values[near]
        loaded.append((snapshot.time, position[:, 0], position[:, 1], values))
    norm = field_norm(name, [values for *_, values in loaded])
    # The frame is the liquid's own extent over all times, not an empty domain around it.
    everything = np.concatenate([np.column_stack([x, y]) for _, x, y, _ in loaded])
    corner = np.column_stack([lower[[0, -1]], upper[[0, -1]]])
    low = np.maximum(np.percentile(everything, 0.02, axis=0) - 2 * spacing, corner[:, 0])
    high = np.minimum(np.percentile(everything, 99.98, axis=0) + 2 * spacing, corner[:, 1])
    width, height = high - low
    rows, columns = panel_grid(len(loaded), width, height)
    size = min(9.0 / columns / width, 7.0 / rows / height)
    figure, axes = plt.subplots(rows, columns, squeeze=False, sharex=True, sharey=True, constrained_layout=True,
                                figsize=(columns * width * size + 1.5, rows * (height * size + 0.35) + 0.5))
    for axis in axes.flat[len(loaded):]:
        axis.remove()
    for axis, (time, x, y, values) in zip(axes.flat, loaded):
        discs = draw_particles(axis, x, y, values, 1.1 * spacing, FIELDS.get(name, "viridis"), norm)
        axis.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal", title=f"t = {time:.4g}")
    for axis in axes[-1, :]:
        axis.set_xlabel("x")
    for axis in axes[:, 0]:
        axis.set_ylabel("y" if run.dimensions == 2 else "z")
    figure.colorbar(discs, ax=[a for a in axes.flat if a.figure], label=name, shrink=0.85, extend="max")
    return finish(figure, path)


def draw_grid_slices(run, snapshots, name, path):
    """The middle plane y of a field on a grid at up to six times."""
    lower, upper = run.bounds()
    loaded = []
    for step in chosen_steps(run, snapshots):
        snapshot = snapshots[int(step)]
        values = snapshot.field(name)
        loaded.append((snapshot.time, values[:, values.shape[1] // 2, :]))
    norm = field_norm(name, [values.ravel() for _, values in loaded])
    width, height = upper[0] - lower[0], upper[2] - lower[2]
    rows, columns = panel_grid(len(loaded), width, height)
    size = min(9.0 / columns / width, 7.0 / rows / height)
    figure, axes = plt.subplots(rows, columns, squeeze=False, sharex=True, sharey=True, constrained_layout=True,
                                figsize=(columns * width * size + 1.5, rows * (height * size + 0.35) + 0.5))
    for axis in axes.flat[len(loaded):]:
        axis.remove()
    for axis, (time, values) in zip(axes.flat, loaded):
        image = axis.imshow(values.T, origin="lower", extent=(lower[0], upper[0], lower[2], upper[2]), norm=norm,
                            cmap=FIELDS.get(name, "viridis"), interpolation="bilinear")
        axis.set(aspect="equal", title=f"t = {time:.4g}")
    for axis in axes[-1, :]:
        axis.set_xlabel("x")
    for axis in axes[:, 0]:
        axis.set_ylabel("z")
    figure.colorbar(image, ax=[a for a in axes.flat if a.figure], label=name, shrink=0.85, extend="max")
    return finish(figure, path)


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


def draw_curves(figures, out):
    """Comparisons as measure.py describes them: a list of
    {"file": stem, "x": label, "y": label, "curves": [(label, x, y, style)], "log": "", "x", "y" or "xy"};
    style is a matplotlib format string: 'o' for measured references, '-' for computed lines, '--' for exact ones.
    """
    files = []
    for description in figures:
        figure, axis = plt.subplots(figsize=(5.6, 4.0))
        for label, x, y, style in description["curves"]:
            axis.plot(x, y, style, label=label, markersize=4, linewidth=1.3, markerfacecolor="none")
        if "x" in description.get("log", ""):
            axis.set_xscale("log")
        if "y" in description.get("log", ""):
            axis.set_yscale("log")
        axis.set(xlabel=description["x"], ylabel=description["y"])
        axis.legend(fontsize=8)
        files.append(finish(figure, out / f"{description['file']}.png"))
    return files
