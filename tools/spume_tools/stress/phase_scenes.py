# SPDX-License-Identifier: MIT
"""Random and worst-case scenes of wcsph: phases of densities up to 1e4 apart, jets, thin films, closed tanks, corners,
single particles of a phase. Lengths are in sides of the box, speeds in sqrt(g side)."""
import math

from .scenes import SPACING, Scene, box, log_uniform, periodic, pick, walls

STEPS = 400  # sound crosses some twenty spacings meanwhile, and the fastest particle about as many


def fluids(rng, *names):
    """Phases of falling density; the ratio of the first two is up to 1e4."""
    ratio = log_uniform(rng, 1, 1e4)
    phases = []
    for number, name in enumerate(names):
        density = 1000 / (1, ratio, ratio**0.5)[number]
        viscosity = pick(rng, [0.0, density * log_uniform(rng, 1e-6, 1e-2)])
        phases.append({"name": name, "density": float(density), "viscosity": float(viscosity)})
    return phases, ratio


def block(phase, lower, upper, velocity=None):
    region = {"phase": phase, "lower": [float(v) for v in lower], "upper": [float(v) for v in upper]}
    return region | ({"velocity": velocity} if velocity else {})


def ball(phase, centre, radius, velocity=None):
    region = {"phase": phase, "centre": [float(v) for v in centre], "radius": float(radius)}
    return region | ({"velocity": velocity} if velocity else {})


def tank(rng, d):
    return box(d, [1] * d, **walls(d, pick(rng, ["free-slip", "no-slip"])))


def two(rng, d, regions, **facts):
    phases, ratio = fluids(rng, "water", "air")
    return dict(domain=tank(rng, d), phase=phases, region=[{"phase": "air"}, *regions], froude=1.0, facts=facts,
                parameters={"ratio": ratio})


def velocity(d, along, up=0.0):
    return [f"{along:.4f}"] + ["0"] * (d - 2) + [f"{up:.4f}"]


def vortices(rng, d):
    u = ["-cos(2*pi*x)*sin(2*pi*y)", "sin(2*pi*x)*cos(2*pi*y)", "0"][:d]
    return dict(domain=box(d, [1] * d, **periodic(d)), phase=[{"name": "water", "density": 1.0, "viscosity": log_uniform(rng, 1e-6, 1e-2)}],
                region=[{"phase": "water", "velocity": u}], froude=None, facts={"free_axes": list(range(d))})


def stripes(rng, d):
    """Two phases that slip along each other in a periodic box: momentum is kept whatever the densities."""
    phases, ratio = fluids(rng, "water", "air")
    low, high = sorted(rng.uniform(0.15, 0.85, 2))
    return dict(domain=box(d, [1] * d, **periodic(d)), phase=phases, froude=None, parameters={"ratio": ratio},
                region=[{"phase": "air", "velocity": velocity(d, -1)},
                        block("water", [0] * (d - 1) + [low], [1] * (d - 1) + [max(high, low + 0.1)], velocity(d, 1))],
                facts={"free_axes": list(range(d))})


def layers(rng, d):
    """The lighter phase above or, half of the time, below."""
    height = rng.uniform(0.1, 0.9)
    lower, upper = ([0], [height]) if rng.random() < 0.5 else ([1 - height], [1])
    return two(rng, d, [block("water", [0] * (d - 1) + lower, [1] * (d - 1) + upper)], speed=1.5)


def dam(rng, d):
    return two(rng, d, [block("water", [0] * d, [rng.uniform(0.15, 0.8)] + [1] * (d - 2) + [rng.uniform(0.2, 0.9)])], speed=1.5)


def bubble(rng, d):
    made = two(rng, d, [], speed=1.5)
    made["region"] = [{"phase": "water"}, ball("air", [0.5] * (d - 1) + [rng.uniform(0.2, 0.8)], rng.uniform(0.08, 0.4))]
    return made


def jet(rng, d):
    """Water through air, at the corners of the tank too."""
    half, speed, height = rng.uniform(0.6, 5) * SPACING[d], log_uniform(rng, 0.5, 10), rng.uniform(0.05, 0.95)
    low, high = max(height - half, 0), min(height + half, 1)
    return two(rng, d, [block("water", [0.1] + [0.3] * (d - 2) + [low], [0.8] + [0.7] * (d - 2) + [high], velocity(d, speed))],
               speed=speed + 1.5)


def film(rng, d):
    depth = rng.uniform(0.6, 3.2) * SPACING[d]
    return two(rng, d, [block("water", [0] * d, [1] * (d - 1) + [depth], velocity(d, rng.uniform(-2, 2)))], speed=3.0)


def corner(rng, d):
    speed, radius = log_uniform(rng, 0.3, 5), rng.uniform(0.06, 0.2)
    return two(rng, d, [ball("water", [0.3] * d, radius, [f"{-speed:.4f}"] * d)], speed=speed * d + 1.5)


def crumbs(rng, d):
    """Single particles of a phase in the other."""
    regions = [ball("water", [0.2 + 0.2 * n] + [0.5] * (d - 2) + [rng.uniform(0.1, 0.9)], 0.75 * SPACING[d],
                    velocity(d, rng.uniform(-1, 1))) for n in range(4)]
    made = two(rng, d, regions, speed=2.5)
    if rng.random() < 0.5:  # of air in water
        made["region"] = [{"phase": "water"}] + [region | {"phase": "air"} for region in regions]
    return made


def three(rng, d):
    phases, ratio = fluids(rng, "water", "air", "oil")
    return dict(domain=tank(rng, d), phase=phases, froude=1.0, parameters={"ratio": ratio}, facts={"speed": 1.5},
                region=[{"phase": "air"}, block("water", [0] * d, [0.5] + [1] * (d - 2) + [0.5]),
                        block("oil", [0.5] + [0] * (d - 1), [1] * (d - 1) + [0.6])])


def drop(rng, d):
    """With surface tension, spinning, in air or vapour."""
    phases, ratio = fluids(rng, "water", "air")
    up = "xyz"[d - 1]
    u = [f"-({up}-0.5)"] + ["0"] * (d - 2) + ["x-0.5"]
    return dict(domain=tank(rng, d), phase=phases, froude=None, parameters={"ratio": ratio},
                region=[{"phase": "air"}, ball("water", [0.5] * d, rng.uniform(0.15, 0.35), u)],
                further={"interface": {"surface_tension": log_uniform(rng, 1, 1000)}}, facts={"speed": 1.0})


def collapse(rng, d):
    """One phase and a free surface."""
    return dict(domain=box(d, [1] * d, **walls(d, pick(rng, ["free-slip", "no-slip"]), ("top",))), froude=1.0,
                phase=[{"name": "water", "density": 1000.0, "viscosity": pick(rng, [0.0, 0.1])}],
                region=[block("water", [0] * d, [rng.uniform(0.1, 1)] + [1] * (d - 2) + [rng.uniform(0.1, 0.9)])],
                facts={"speed": 1.5})


def stirred(rng, d):
    """A disc or ball that moves about below the surface, or between the phases."""
    made = collapse(rng, d) if rng.random() < 0.5 else layers(rng, d)
    made["further"] = {"body": [{"shape": "ball", "position": [0.5] * (d - 1) + [0.4], "radius": float(rng.uniform(0.08, 0.2)),
                                 "wall": pick(rng, ["free-slip", "no-slip"]),
                                 "displacement": [f"{rng.uniform(0.05, 0.2):.3f}*sin({rng.uniform(1, 6):.3f}*t)"] + ["0"] * (d - 1)}]}
    made["facts"] = {"speed": 2.5, "conservative": False}
    return made


PHASE_SCENES = {f.__name__: f for f in (vortices, stripes, layers, dam, bubble, jet, film, corner, crumbs, three, drop, collapse, stirred)}


def wcsph_scene(rng, kinds=None, fixed=None, plain=False, steps=STEPS):
    kind = pick(rng, kinds or list(PHASE_SCENES))
    d = 3 if rng.random() < 0.2 else 2
    made = PHASE_SCENES[kind](rng, d)
    values = {"courant": float(rng.uniform(0.1, 0.8)), "jitter": float(pick(rng, [0.0, rng.uniform(0, 0.4)]))} | (fixed or {})
    facts = {"speed": 1.0} | made.get("facts", {})
    spacing = SPACING[d]
    # Sound in the lightest phase is as fast as its stiffness asks: the end is that of a liquid alone, and the clock of a
    # run with air ends most of them.
    step = values["courant"] * 1.3 * spacing / (11 * facts["speed"])
    ratio = made.get("parameters", {}).get("ratio", 1)
    case = {"seed": int(rng.integers(1, 1000)), "title": kind, "method": "wcsph", "domain": made["domain"],
            "resolution": {"spacing": spacing}, "fluid": {"froude": made["froude"]} if made["froude"] else {},
            "phase": made["phase"], "region": made["region"], "initial": {"jitter": values["jitter"]},
            "time": {"end": steps * step / math.sqrt(max(ratio / 5, 1)), "courant": values["courant"]}} | made.get("further", {})
    if not plain and rng.random() < 0.2:
        case["compressibility"] = {"repulsion": float(rng.uniform(0, 0.1))}
    if not plain and rng.random() < 0.1:
        case.setdefault("compressibility", {})["density_filter"] = "shepard"
    if not plain and rng.random() < 0.15:
        case["lists"] = {"skin": float(rng.uniform(0.05, 1.5))}
    parameters = values | {"dimensions": d, "spacing": spacing} | made.get("parameters", {})
    return Scene(kind, case, parameters, **facts)
