# SPDX-License-Identifier: MIT
"""Still water over one or two bodies of random shape, size, place and angle, some through the floor or a wall, by the
method that the kind names. The water is 1.1 deep in a tank of 1.6 (by 1.2) by 1.3; by gfd, which has no free surface,
it fills a tank as high as that, half of the time below oil."""
from .scenes import Scene, pick, walls

METHODS = ("les-sph", "wcsph", "gfd")
DEPTH, OIL_FROM, SPACING = 1.1, 0.63, {2: 0.04, 3: 0.1}
OUTLINE = [[-0.4, -0.3], [0.4, -0.3], [0.3, 0.1], [0.0, 0.35], [-0.35, 0.2]]


def numbers(rng, low, high, count):
    return [round(float(v), 4) for v in rng.uniform(low, high, count)]


def body(rng, d):
    shape = pick(rng, ["box", "box", "ball", "ellipsoid", "outline"])
    across = [0.1, 0.1][: d - 1], [1.5, 1.1][: d - 1]
    made = {"shape": shape, "position": [round(float(v), 4) for v in rng.uniform(*across)] + numbers(rng, 0, 0.4, 1)}
    if shape == "ball":
        return made | {"radius": numbers(rng, 0.2, 0.4, 1)[0]}
    if shape == "box":
        made["size"] = numbers(rng, 0.3, 0.8, d)
    elif shape == "ellipsoid":
        made["semi_axes"] = numbers(rng, 0.2, 0.5, d)
    else:
        made["points"] = OUTLINE
        if d == 3:
            made["length"] = numbers(rng, 0.3, 0.7, 1)[0]
    return made | {"rotation": numbers(rng, 0, 180, 1) if d == 2 else numbers(rng, 0, 90, 3)}


def phases(names):
    densities = {"water": 1.0, "oil": 0.8}
    return [{"name": name, "density": densities[name], "viscosity": 1e-4} for name in names]


def still_scene(rng, kinds=None, fixed=None, plain=False):
    method = pick(rng, kinds or list(METHODS))
    d = 3 if rng.random() < 0.2 else 2
    values = {"end": 5.0} | (fixed or {})
    upper = [1.6, 1.2, 1.3] if d == 3 else [1.6, 1.3]
    water = upper[:-1] + [DEPTH]
    case = {"title": f"Still water by {method}", "method": method,
            "domain": {"lower": [0.0] * d, "upper": water if method == "gfd" else upper}
            | walls(d, "free-slip", without=() if method == "gfd" else ("top",)),
            "resolution": {"spacing": SPACING[d]}}
    if method == "wcsph":
        case |= {"fluid": {"gravity": 1.0}, "phase": phases(["water"]), "region": [{"phase": "water", "upper": water}]}
    elif method == "gfd":
        names = ["water", "oil"] if rng.random() < 0.5 else ["water"]
        case |= {"fluid": {"gravity": 1.0}, "phase": phases(names), "region": [{"phase": "water"}]}
        if len(names) > 1:
            case["interface"] = {"surface_tension": 0.0}
            case["region"].append({"phase": "oil", "lower": [0.0] * (d - 1) + [OIL_FROM]})
    else:
        case |= {"fluid": {"reynolds": 1e4, "mach": 0.05, "froude": 1.0}, "liquid": [{"upper": water}]}
    case |= {"body": [body(rng, d) for _ in range(1 if rng.random() < 2 / 3 else 2)],
             "time": {"end": float(values["end"] * DEPTH**0.5)}}
    return Scene(method, case, values | {"dimensions": d}, speed=DEPTH**0.5)
