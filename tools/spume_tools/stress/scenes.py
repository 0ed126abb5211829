# SPDX-License-Identifier: MIT
"""Random and worst-case scenes for tools/stress: each a case file and the facts that its checks rest on.

A scene is drawn from a random generator alone, so that seed and number give it back. Lengths are in sides of the box.
"""
import math

SPACING = {2: 1 / 40, 3: 1 / 12}  # at most about 2000 particles


class Scene:
    """case: sections of the case file; parameters: what the map is drawn over; facts: what the checks may assume.

    facts: free_axes     axes along which nothing but a uniform force acts
           force         t -> uniform acceleration beside gravity, or None
           conservative  no energy enters but by the uniform force
           speed         speed that the scene was set up with, sqrt(g h) included
           keeps_all     every particle stays in the domain
    """

    def __init__(self, kind, case, parameters, **facts):
        self.kind, self.case, self.parameters = kind, case, parameters
        self.facts = {"free_axes": [], "force": None, "conservative": True, "speed": 1.0, "keeps_all": True} | facts


def log_uniform(rng, low, high):
    return float(math.exp(rng.uniform(math.log(low), math.log(high))))


def pick(rng, values):
    return values[int(rng.integers(len(values)))]


def box(dimensions, upper, **sides):
    return {"lower": [0.0] * dimensions, "upper": [float(v) for v in upper]} | sides


WALLS = {2: ("left", "right", "bottom", "top"), 3: ("left", "right", "front", "back", "bottom", "top")}


def walls(dimensions, kind, without=()):
    return {side: kind for side in WALLS[dimensions] if side not in without}


def periodic(dimensions):
    return {axis: "periodic" for axis in "xyz"[:dimensions]}


# -- les-sph: a function of (rng, dimensions) gives domain, liquids, gravity, further sections, facts ------------------


def vortices(rng, d):
    u = ["-cos(2*pi*x)*sin(2*pi*y)", "sin(2*pi*x)*cos(2*pi*y)", "0"][:d]
    return dict(domain=box(d, [1] * d, **periodic(d)), liquid=[{"velocity": u}], froude=None,
                facts={"free_axes": list(range(d))})


def channel(rng, d):
    u = ["sin(pi*{0})".format("yz"[d - 2]) + f"*(1 + {rng.uniform(0, 1):.3f}*sin(2*pi*x))"] + ["0"] * (d - 1)
    sides = {"x": "periodic"} | ({"y": "periodic"} if d == 3 else {})
    wall = pick(rng, ["no-slip", "free-slip"])
    return dict(domain=box(d, [1] * d, bottom=wall, top=wall, **sides), liquid=[{"velocity": u}], froude=None,
                facts={"free_axes": list(range(d - 1)) if wall == "free-slip" else []})


def wave(rng, d):
    chi = float(rng.uniform(0.05, 0.7))
    up = "xyz"[d - 1]
    constants = {"chi": chi, "eta": "0.5 + (chi*cos(2*pi*x) + chi^2/2*cos(4*pi*x) + 3/8*chi^3*cos(6*pi*x))/(2*pi)",
                 "a": "chi*sqrt(1+chi^2)/sqrt(2*pi)"}
    u = [f"a*cos(2*pi*x)*exp(2*pi*({up}-0.5))"] + ["0"] * (d - 2) + [f"a*sin(2*pi*x)*exp(2*pi*({up}-0.5))"]
    sides = {"x": "periodic"} | ({"y": "periodic"} if d == 3 else {})
    return dict(domain=box(d, [1] * d, bottom=pick(rng, ["free-slip", "no-slip"]), **sides), constants=constants,
                liquid=[{"where": f"eta - {up}", "velocity": u, "conform": bool(rng.random() < 0.7)}], froude=1.0,
                facts={"speed": 1.0, "free_axes": []}, parameters={"chi": chi})


def dam(rng, d):
    width, height = rng.uniform(0.15, 0.5), rng.uniform(0.2, 0.9)
    top = [float(width)] + [1.0] * (d - 2) + [float(height)]
    further = {}
    thick = 0.3  # two supports of any kernel that is drawn, in 2-D
    if d == 2 and rng.random() < 0.6 and width + thick < 0.9:
        # An obstacle on the floor: its foot and the corners of the tank are the worst places for images.
        left = float(rng.uniform(width + 0.02, 1 - thick))
        further["solid"] = [{"lower": [left] + [0.0] * (d - 1), "upper": [left + thick] + [1.0] * (d - 2) + [0.2],
                             "wall": pick(rng, ["free-slip", "no-slip"])}]
    return dict(domain=box(d, [1] * d, **walls(d, pick(rng, ["free-slip", "no-slip"]), ("top",))),
                liquid=[{"lower": [0.0] * d, "upper": top}], froude=1.0, further=further,
                facts={"speed": math.sqrt(2 * height)})


def drop_free(rng, d):
    radius = rng.uniform(1.5, 12) * SPACING[d]
    c = "xyz"[d - 1]
    motion = pick(rng, ["spin", "strain", "fly", "rest"])
    u = {"spin": [f"-({c}-1)", "x-1"], "strain": ["(x-1)", f"-({c}-1)"], "fly": ["1", "0.5"], "rest": ["0", "0"]}[motion]
    scale = 1 if motion in ("fly", "rest") else radius
    u = [u[0]] + ["0"] * (d - 2) + [u[1]]
    return dict(domain=box(d, [2] * d), liquid=[{"centre": [1.0] * d, "radius": float(radius), "velocity": u}],
                froude=pick(rng, [None, 1.0]), facts={"free_axes": list(range(d)), "speed": scale, "keeps_all": True})


def drop_impact(rng, d):
    depth, radius = rng.uniform(2, 10) * SPACING[2], rng.uniform(0.05 if d == 2 else 0.1, 0.18)
    depth = max(depth, 1.2 * SPACING[d])
    speed = log_uniform(rng, 0.3, 10)
    c = [0.5] * (d - 1) + [float(depth + radius + 2 * SPACING[d])]
    u = [f"{rng.uniform(-1, 1):.3f}"] + ["0"] * (d - 2) + [f"-{speed:.4f}"]
    sides = {"x": "periodic"} | ({"y": "periodic"} if d == 3 else {})
    return dict(domain=box(d, [1] * d, bottom="no-slip", **sides),
                liquid=[{"lower": [0.0] * d, "upper": [1.0] * (d - 1) + [float(depth)]},
                        {"centre": c, "radius": float(radius), "velocity": u}],
                froude=1.0, facts={"speed": speed + 1})


def colliding_drops(rng, d):
    radius, offset = rng.uniform(0.08, 0.24), rng.uniform(0, 0.2)
    still = ["0"] * (d - 1)
    left, right = [0.7] + [1.0] * (d - 1), [1.3] + [1.0] * (d - 2) + [float(1 + offset)]
    return dict(domain=box(d, [2] * d), froude=None, facts={"free_axes": list(range(d))},
                liquid=[{"centre": left, "radius": float(radius), "velocity": ["1", *still]},
                        {"centre": right, "radius": float(radius), "velocity": ["-1", *still]}])


def sheet(rng, d):
    half = rng.uniform(1.02, 3) * SPACING[d] / 2
    return dict(domain=box(d, [1] * d, **walls(d, "free-slip", ("top",))), froude=1.0, facts={"speed": 1.5},
                liquid=[{"lower": [float(0.5 - half)] + [0.0] * (d - 2) + [0.1],
                         "upper": [float(0.5 + half)] + [1.0] * (d - 2) + [0.9]}])


def jet(rng, d):
    half, speed = rng.uniform(1, 5) * SPACING[d], log_uniform(rng, 0.5, 10)
    lower, upper = [0.2] + [0.4] * (d - 2) + [float(0.5 - half)], [0.95] + [0.6] * (d - 2) + [float(0.5 + half)]
    return dict(domain=box(d, [1] * d, **walls(d, "free-slip", ("top", "left"))), froude=1.0, facts={"speed": speed + 1},
                liquid=[{"lower": lower, "upper": upper, "velocity": [f"{speed:.4f}"] + ["0"] * (d - 1)}])


def film(rng, d):
    depth = rng.uniform(0.6, 3.2) * SPACING[d]
    u = [f"{rng.uniform(0.5, 2):.3f}*(1 + 0.3*sin(2*pi*x))"] + ["0"] * (d - 1)
    sides = {"x": "periodic"} | ({"y": "periodic"} if d == 3 else {})
    return dict(domain=box(d, [1] * d, bottom=pick(rng, ["free-slip", "no-slip"]), **sides), froude=1.0,
                liquid=[{"lower": [0.0] * d, "upper": [1.0] * (d - 1) + [float(depth)], "velocity": u}],
                facts={"speed": 2.6})


def full_box(rng, d):
    return dict(domain=box(d, [1] * d, **walls(d, pick(rng, ["free-slip", "no-slip"]))), froude=1.0,
                liquid=[{"velocity": ["sin(pi*x)*cos(pi*{0})".format("yz"[d - 2])] + ["0"] * (d - 2)
                         + ["-cos(pi*x)*sin(pi*{0})".format("yz"[d - 2])]}])


def jolt(rng, d):
    """Gravity that changes size and sign at once."""
    strength, period = log_uniform(rng, 1, 50), 0.1
    force = lambda t: [0.0] * (d - 1) + [strength if int(t / period + 1e-9) % 2 else -strength]
    # rint is the only rounding of muParser; floor(x) = rint(x - 1/2) for x that is no integer.
    law = f"{strength:.6g}*(1 - 2*(rint(t/{2 * period} - 0.5 + 0.001) < rint(t/{2 * period} + 0.001) ? 1 : 0)) * -1"
    return dict(domain=box(d, [1] * d, **walls(d, "free-slip")), froude=None,
                liquid=[{"lower": [0.0] * d, "upper": [1.0] * (d - 1) + [0.4]}],
                further={"forces": {"body": ["0"] * (d - 1) + [law]}},
                facts={"speed": math.sqrt(strength), "conservative": False}, parameters={"jolt": strength})


def cluster(rng, d):
    """All particles in a few cells of a domain that is mostly empty."""
    far = 30.0 if d == 2 else 8.0
    side = 0.3
    return dict(domain=box(d, [far] * d, **walls(d, "free-slip", ("top",))), froude=1.0,
                liquid=[{"lower": [far / 2] * (d - 1) + [0.0], "upper": [far / 2 + side] * (d - 1) + [side]}],
                facts={"speed": 1.0})


def crumbs(rng, d):
    """Single particles and pairs, too few for any gradient."""
    liquid = []
    for number in range(6):
        c = [0.2 + 0.3 * (number % 3)] + [0.5] * (d - 2) + [0.3 + 0.4 * (number // 3)]
        liquid.append({"centre": [float(v + rng.uniform(-0.02, 0.02)) for v in c],
                       "radius": float(rng.uniform(0.9, 1.6) * SPACING[d]),
                       "velocity": [f"{v:.3f}" for v in rng.uniform(-1, 1, d)]})
    return dict(domain=box(d, [1] * d, **walls(d, "free-slip", ("top",))), liquid=liquid, froude=1.0,
                facts={"speed": 2.0, "keeps_all": True})


def piston(rng, d):
    speed = log_uniform(rng, 0.1, 1)
    u = [f"{speed:.4f}*sin(4*t)"] + ["0"] * (d - 1)
    return dict(domain=box(d, [1] * d, **walls(d, "free-slip", ("top",))), froude=1.0,
                liquid=[{"lower": [0.0] * d, "upper": [1.0] * (d - 1) + [0.4]}],
                further={"domain.wall_velocity": {"left": u}}, facts={"conservative": False, "speed": 1 + speed})


def lid(rng, d):
    return dict(domain=box(d, [1] * d, **walls(d, "no-slip")), froude=None, liquid=[{}],
                further={"domain.wall_velocity": {"top": ["1"] + ["0"] * (d - 1)}}, facts={"conservative": False})


def pool(rng, d):
    sides = {"x": "periodic"} | ({"y": "periodic"} if d == 3 else {})
    return dict(domain=box(d, [1] * d, bottom="free-slip", **sides), froude=1.0,
                liquid=[{"lower": [0.0] * d, "upper": [1.0] * (d - 1) + [float(rng.uniform(0.1, 0.9))]}])


def bubbles(rng, d):
    """A cloud in a closed or an open tank, from far below the spacing to as large, up to alpha = 0.6."""
    closed = rng.random() < 0.3
    depth = 1.0 if closed else 0.7
    radius = log_uniform(rng, 1e-6, SPACING[d])
    alpha = rng.uniform(0.001, 0.6)
    cloud = 0.3
    volume = math.pi * radius**2 if d == 2 else 4 / 3 * math.pi * radius**3
    number = int(min(max(alpha * cloud**d / volume, 1), 3000))
    sides = walls(d, "free-slip", () if closed else ("top",))
    further = {"bubbles": {"weber": log_uniform(rng, 10, 1e5), "density_ratio": log_uniform(rng, 2, 1e3),
                           "fluctuations": bool(rng.random() < 0.4), "breakup": bool(rng.random() < 0.4),
                           "entrainment": bool(not closed and rng.random() < 0.4),
                           "momentum_form": pick(rng, ["mixture-pressure", "two-fluid"]),
                           "integrator": pick(rng, ["stable", "stable", "substep"])},
               "bubble_cloud": [{"lower": [0.35] * (d - 1) + [0.1], "upper": [0.65] * (d - 1) + [0.4],
                                 "number": number, "bubble_radius": radius}]}
    return dict(domain=box(d, [1] * d, **sides), froude=1.0, further=further,
                liquid=[{"lower": [0.0] * d, "upper": [1.0] * (d - 1) + [depth]}],
                facts={"conservative": False, "speed": 1.2},
                parameters={"alpha": number * volume / cloud**d, "bubble_radius": radius})


PARTICLE_SCENES = {f.__name__: f for f in (vortices, channel, wave, dam, drop_free, drop_impact, colliding_drops, sheet, jet,
                                           film, full_box, jolt, cluster, crumbs, piston, lid, pool, bubbles)}


def les_sph_scene(rng, kinds=None, fixed=None, plain=False, steps=120):
    kind = pick(rng, kinds or list(PARTICLE_SCENES))
    d = 3 if rng.random() < 0.2 or kind == "bubbles" else 2
    made = PARTICLE_SCENES[kind](rng, d)
    values = {"courant": float(rng.uniform(0.05, 1)), "mach": float(pick(rng, [0.0, rng.uniform(0, 0.3)])),
              "reynolds": log_uniform(rng, 1, 1e8), "jitter": float(pick(rng, [0.0, rng.uniform(0, 0.5)]))}
    values |= fixed or {}
    facts = {"speed": 1.0} | made.get("facts", {})
    spacing = SPACING[d]
    # The Mach number is that of the fastest liquid.
    fluid = {"reynolds": values["reynolds"], "mach": values["mach"] / max(1.0, facts["speed"])}
    if made["froude"]:
        fluid["froude"] = made["froude"]
    # The diffusive limit of the step too: a run of Re = 1 takes shorter steps.
    h = 1.3 * spacing
    dt = min(values["courant"] * h / facts["speed"], 0.2 * h * h * values["reynolds"])
    case = {"title": kind, "method": "les-sph", "domain": made["domain"], "resolution": {"spacing": spacing},
            "fluid": fluid, "liquid": made["liquid"], "initial": {"jitter": values["jitter"]},
            "time": {"end": steps * dt, "courant": values["courant"]}} | made.get("further", {})
    if "constants" in made:
        case["constants"] = made["constants"]
    if kind == "bubbles" and any(case["bubbles"][key] for key in ("fluctuations", "breakup", "entrainment")):
        case["turbulence"] = {"model": "mixed-scale"}
    seldom = lambda section, key, choices: not plain and rng.random() < 0.15 and case.setdefault(section, {}).update({key: pick(rng, choices)})
    if not plain and rng.random() < 0.4:
        case["turbulence"] = {"model": pick(rng, ["mixed-scale", "smagorinsky", "dynamic-shepard", "dynamic-lagrangian"])}
    seldom("resolution", "kernel", ["quintic-spline"])
    seldom("resolution", "smoothing_ratio", [1.0, 1.2, 1.5, 1.8])
    seldom("pressure", "solver", ["cg"])
    seldom("pressure", "preconditioner", ["jacobi"])
    seldom("pressure", "precision", ["double"])
    seldom("pressure", "tolerance", [1e-3, 1e-9])
    seldom("time", "centred", [False])
    seldom("shifting", "velocity_correction", ["none", "second-order"])
    case["seed"] = int(rng.integers(1, 1000))
    parameters = values | {"dimensions": d, "spacing": spacing} | made.get("parameters", {})
    return Scene(kind, {"seed": case.pop("seed")} | case, parameters, **facts)


# -- spectral ----------------------------------------------------------------------------------------------------------


def spectral_scene(rng, kinds=None, fixed=None, plain=False, steps=60):
    kind = pick(rng, kinds or ["decay", "inviscid", "forced", "bubbles", "heavy", "exclusion"])
    grid = int(pick(rng, [16, 24, 32]))
    values = {"courant": float(rng.uniform(0.05, 1)), "reynolds": log_uniform(rng, 1, 1e8)} | (fixed or {})
    side = 2 * math.pi
    lengths = [side, side * pick(rng, [1, 1, 0.5]), side]
    start = pick(rng, [{"kind": "taylor-green"}, {"kind": "abc"},
                       {"kind": "random", "spectrum": "k^4*exp(-2*(k/2)^2)", "energy": log_uniform(rng, 1e-3, 10)}])
    case = {"seed": int(rng.integers(1, 1000)), "title": kind, "method": "spectral",
            "domain": {"lower": [0.0] * 3, "upper": lengths} | periodic(3), "resolution": {"grid": grid},
            "fluid": {} if kind == "inviscid" else {"reynolds": values["reynolds"]}, "initial": start,
            "spectral": {"integrator": pick(rng, ["ab2", "rk3", "rk4"]),
                         "dealiasing": pick(rng, ["padded", "padded", "two-thirds", "none"]),
                         "precision": pick(rng, ["double", "single"])}}
    if kind == "inviscid":
        case["spectral"]["integrator"] = pick(rng, ["rk3", "rk4"])
    if start["kind"] == "abc":
        case["domain"]["upper"] = [side] * 3
    if plain:
        case["spectral"] = {"integrator": "ab2", "dealiasing": "padded", "precision": "double"}
    forced = kind != "decay" and kind != "inviscid" and rng.random() < 0.7
    if forced:
        case["initial"] = {"kind": "random", "spectrum": "k^4*exp(-2*(k/2)^2)", "energy": 0.3}
        case["forcing"] = pick(rng, [{"kind": "shell", "injection": log_uniform(rng, 1e-2, 1)},
                                     {"kind": "linear", "rate": float(rng.uniform(0.05, 0.5))}])
    particles = None
    if kind in ("bubbles", "heavy", "exclusion"):
        diameter = log_uniform(rng, 1e-3, 1) * side / grid
        particles = {"count": int(log_uniform(rng, 10, 2e4)), "diameter": diameter,
                     "response_time": log_uniform(rng, 1e-4, 10), "beta": 3.0 if kind != "heavy" else float(rng.uniform(0, 1)),
                     "coupling": pick(rng, ["one-way", "two-way", "four-way"]) if kind != "exclusion" else "four-way",
                     "drag": pick(rng, ["stokes", "schiller-naumann"]), "matching": pick(rng, ["rounds", "sorting"]),
                     "spline_order": int(pick(rng, [2, 4, 6])), "overlap_samples": 1000,
                     "placement": pick(rng, ["random", "clustered"])}
        if kind == "exclusion":
            particles["volume_fraction"] = float(rng.uniform(0.01, 0.6))
            particles["diameter"] = float(rng.uniform(0.4, 1.5) * side / grid)
            del particles["count"]
        if rng.random() < 0.3:
            particles["gravity"] = [0.0, 0.0, -log_uniform(rng, 0.1, 100)]
        case["particles"] = particles
    # Speeds of order one, or what an injection of 1 or the linear force builds up.
    speed = 3 * math.sqrt(case["initial"].get("energy", 0.5))
    case["time"] = {"end": steps * values["courant"] * side / grid / max(speed, 0.05) / 3, "courant": values["courant"]}
    loaded = particles is not None and particles["coupling"] != "one-way"
    # Statistics of pairs cost more than a step where particles cluster.
    case["output"] = {"series_every": case["time"]["end"] / 30}
    parameters = values | {"grid": grid}
    if particles:
        parameters |= {key: particles[key] for key in ("diameter", "response_time", "beta", "volume_fraction") if key in particles}
    return Scene(kind, case, parameters, conservative=not forced and not loaded, forced=forced, loaded=loaded, speed=speed)


SCENES = {"les-sph": les_sph_scene, "spectral": spectral_scene}
