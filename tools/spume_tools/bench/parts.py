# SPDX-License-Identifier: MIT
"""What each optional part of a scene costs: the time of a step and the arrays, with the part and without it.

A part that a scene does not name must cost nothing, so what is shown is the price of naming it. The runs of a part take
turns, and the least time of each counts: other load on the machine slows, it never speeds up.
"""
import copy
import math
import tempfile
from pathlib import Path

from ..case_file import toml_text

ROUNDS = 4
STEPS = 20


def tank():
    """A tank with everything: walls, surface, closure, viscosity, gravity, bubbles."""
    return {"method": "les-sph",
            "domain": {"lower": [0.0, 0.0, 0.0], "upper": [1.0, 0.3, 1.0], "left": "no-slip", "right": "no-slip",
                       "bottom": "no-slip", "y": "periodic"},
            "resolution": {"spacing": 0.025}, "fluid": {"reynolds": 1e5, "froude": 1.0, "mach": 0.05},
            "liquid": [{"where": "0.5 + 0.05*cos(pi*x) - z", "velocity": ["0.5*sin(2*pi*z)", "0", "0.5*sin(2*pi*x)"]}],
            "initial": {"jitter": 0.1}, "turbulence": {"model": "mixed-scale"},
            "bubbles": {"weber": 1e4}, "bubble_cloud": [{"lower": [0.3, 0.05, 0.1], "upper": [0.7, 0.25, 0.4], "number": 1000,
                                                         "bubble_radius": 1e-3}],
            "output": {"checkpoint_every": 1e9}, "time": {"end": STEPS * 0.002, "max_step": 0.002}}


def box():
    """Turbulence with bubbles that act on it and exclude each other."""
    side = 2 * math.pi
    return {"method": "spectral",
            "domain": {"lower": [0.0] * 3, "upper": [side] * 3, "x": "periodic", "y": "periodic", "z": "periodic"},
            "resolution": {"grid": 48}, "fluid": {"reynolds": 50.0},
            "forcing": {"kind": "shell", "injection": 0.1},
            "initial": {"kind": "random", "spectrum": "k^4*exp(-2*(k/2)^2)", "energy": 0.3},
            "particles": {"count": 50000, "diameter": 0.03, "beta": 3.0, "coupling": "four-way", "overlap_samples": 0},
            "output": {"checkpoint_every": 1e9, "series_every": 1e9}, "time": {"end": STEPS * 0.005, "max_step": 0.005}}


def without(base, *sections, **changes):
    case = copy.deepcopy(base)
    for section in sections:
        del case[section]
    for section, values in changes.items():
        case.setdefault(section, {}).update(values)
        for key in [k for k, v in case[section].items() if v is None]:
            del case[section][key]
    return case


def parts():
    """Part: (case with it, case without it). What a part rests on goes first: without bubbles, then without closure."""
    full = tank()
    dry = without(full, "bubbles", "bubble_cloud")
    idle = copy.deepcopy(full)
    idle["bubble_cloud"][0]["time"] = 100.0
    laminar = without(dry, "turbulence")
    filled = without(dry, domain={"top": "no-slip", "upper": [1.0, 0.3, 0.5]})
    filled["liquid"] = [{"velocity": dry["liquid"][0]["velocity"]}]
    ring = without(dry, domain={"left": None, "right": None, "x": "periodic"})
    flat = copy.deepcopy(dry)
    flat["domain"] = {"lower": [0.0, 0.0], "upper": [1.0, 1.0], "left": "no-slip", "right": "no-slip", "bottom": "no-slip"}
    flat["resolution"] = {"spacing": 0.0072}  # as many particles
    flat["liquid"] = [{"where": "0.5 + 0.05*cos(pi*x) - y", "velocity": ["0.5*sin(2*pi*y)", "0.5*sin(2*pi*x)"]}]
    flat["time"] = {"end": STEPS * 0.0005, "max_step": 0.0005}
    flow = box()
    one_way = without(flow, particles={"coupling": "one-way"})
    two_way = without(flow, particles={"coupling": "two-way"})
    alone = without(flow, "particles")
    drawn = without(dry, output={"every": 0.002})
    return {"bubbles": (full, dry), "bubbles, none alive": (idle, dry), "closure (LES)": (dry, laminar),
            "viscosity": (laminar, without(laminar, fluid={"reynolds": None})),
            "gravity": (dry, without(dry, fluid={"froude": None})), "free surface": (dry, filled), "walls": (dry, ring),
            "shifting": (dry, without(dry, shifting={"on": False})), "third dimension": (dry, flat),
            "output every step": (drawn, dry), "spectral: particles": (one_way, alone), "spectral: two-way": (two_way, one_way),
            "spectral: exclusion": (flow, two_way), "spectral: forcing": (alone, without(alone, "forcing"))}


def figures(run):
    """Nanoseconds of a step per particle or grid point, and bytes of arrays. A stage of the ledger that was called no more
    than twice belongs to the start and the end of the run, as checkpoints do, and not to its steps."""
    seconds = sum(stage["seconds"] for stage in run.ledger["stages"] if stage["calls"] > 2)
    size = run.summary["particles"]
    return 1e9 * seconds / run.summary["steps"] / size, run.summary["peak_array_bytes"] / size


def table(bench):
    lines = [f"{'':<22} {'ns per particle and step':>26} {'':>8} {'bytes per particle':>26}",
             f"{'part':<22} {'with':>13} {'without':>12} {'share':>8} {'with':>14} {'without':>11}"]
    with tempfile.TemporaryDirectory(prefix="spume-parts-") as scratch:
        for name, pair in parts().items():
            best = [[math.inf, 0.0], [math.inf, 0.0]]
            for turn in range(ROUNDS):
                for which in (0, 1) if turn % 2 == 0 else (1, 0):
                    case = Path(scratch) / "case.toml"
                    case.write_text(toml_text(pair[which]), encoding="utf-8")
                    run, _ = bench.run(case, "--threads", "1")
                    time, memory = figures(run)
                    best[which] = [min(best[which][0], time), memory]
            (on, on_bytes), (off, off_bytes) = best
            lines.append(f"{name:<22} {on:13.0f} {off:12.0f} {100 * (1 - off / on):7.1f}% {on_bytes:14.0f} {off_bytes:11.0f}")
    return "one thread\n" + "\n".join(lines)
