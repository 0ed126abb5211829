# SPDX-License-Identifier: MIT
"""Long runs of small scenes: conserved quantities, statistics, memory and speed must not drift.

Each scene has a state that it keeps: a flow that its force sustains, liquid at rest, a plume whose bubbles come and go, a tank that is shaken,
stirred turbulence without and with particles, a sustained flow and layers at rest of weakly compressible phases. Memory and processor time of the program are read while it runs.
"""
import math
import os
import subprocess
import time

import numpy as np

from ..case_file import toml_text
from ..results import MissingResult, Results
from .checks import finite_table

SETTLED = 0.1  # of the run, after which nothing may drift
MEMORY_GROWTH = 0.02, 4e6  # of what the program holds then, and bytes besides: buffers of files
SLOWER = 1.3  # processor time per step, last quarter over the first after settling: one core has company

PERIODIC = {"x": "periodic", "y": "periodic", "z": "periodic"}


def sustained_flow(step):
    """Kolmogorov's: force F sin(2 pi y), velocity F Re / (4 pi^2) sin(2 pi y); stable in a square box."""
    return {"title": "sustained flow", "method": "les-sph",
            "domain": {"lower": [0.0, 0.0], "upper": [1.0, 1.0], "x": "periodic", "y": "periodic"},
            "resolution": {"spacing": 1 / 16}, "fluid": {"reynolds": 50.0, "mach": 0.05},
            "forces": {"body": [f"{4 * math.pi**2 / 50!r}*sin(2*pi*y)", "0"]},
            "liquid": [{"velocity": ["sin(2*pi*y)", "0"]}], "time": {"max_step": step}}


def pool(step):
    return {"title": "pool", "method": "les-sph",
            "domain": {"lower": [0.0, 0.0], "upper": [1.0, 1.0], "left": "free-slip", "right": "no-slip", "bottom": "no-slip"},
            "resolution": {"spacing": 1 / 16}, "fluid": {"reynolds": 1000.0, "froude": 1.0, "mach": 0.05},
            "liquid": [{"where": "0.5 - y"}], "time": {"max_step": step}}


def plume(step):
    return {"title": "plume", "method": "les-sph",
            "domain": {"lower": [-0.5, -0.5, 0.0], "upper": [0.5, 0.5, 1.2], "left": "no-slip", "right": "no-slip",
                       "front": "no-slip", "back": "no-slip", "bottom": "no-slip"},
            "resolution": {"spacing": 0.125}, "fluid": {"reynolds": 1e5, "froude": 0.3193, "mach": 0.05},
            "liquid": [{"where": "1 - z"}], "turbulence": {"model": "mixed-scale"},
            "bubbles": {"weber": 1.4e4, "fluctuations": True, "breakup": True},
            "sparger": [{"shape": "disc", "position": [0.0, 0.0, 0.2], "radius": 0.1, "rate": "4e-6", "bubble_radius": 2e-3}],
            "time": {"max_step": step}}


def sloshing(step):
    """A tank shaken along x, a tenth of gravity below the frequency of its first mode, with a wedge on its floor."""
    return {"title": "sloshing", "method": "les-sph",
            "domain": {"lower": [0.0, 0.0], "upper": [1.0, 1.5], "left": "free-slip", "right": "free-slip", "bottom": "no-slip"},
            "resolution": {"spacing": 1 / 24}, "fluid": {"reynolds": 1000.0, "froude": 1.0, "mach": 0.05},
            "forces": {"body": ["0.1*sin(1.5*t)", "0"]}, "liquid": [{"where": "0.5 - y"}],
            "body": [{"shape": "outline", "points": [[0.2, -0.1], [0.8, -0.1], [0.5, 0.2]], "wall": "no-slip"}],
            "time": {"max_step": step}}


def turbulence(step, points=32, reynolds=40.0):
    side = 2 * math.pi
    return {"title": "turbulence", "method": "spectral",
            "domain": {"lower": [0.0] * 3, "upper": [side] * 3} | PERIODIC, "resolution": {"grid": points},
            "fluid": {"reynolds": reynolds}, "forcing": {"kind": "shell", "wavenumber": 1, "injection": 0.1},
            "initial": {"kind": "random", "spectrum": "k^4*exp(-2*(k/2)^2)", "energy": 0.4}, "time": {"max_step": step}}


def particles(step):
    # At half the Reynolds number the flow settles into a laminar wave after some hundred turnovers, as isotropic
    # turbulence does there (Linkmann and Morozov 2015).
    return turbulence(step, 16, 32.0) | {
        "title": "particles",
        "particles": {"volume_fraction": 0.02, "diameter": 0.2, "stokes": 1.0, "beta": 3.0, "coupling": "four-way"}}


def sustained_phase(step):
    """The sustained flow by wcsph: lists are made anew and particles shifted some ten thousand times."""
    return {"title": "sustained phase", "method": "wcsph",
            "domain": {"lower": [0.0, 0.0], "upper": [1.0, 1.0], "x": "periodic", "y": "periodic"},
            "resolution": {"spacing": 1 / 16}, "phase": [{"name": "water", "density": 1.0, "viscosity": 1 / 50}],
            "region": [{"phase": "water", "velocity": ["sin(2*pi*y)", "0"]}],
            "forces": {"body": [f"{4 * math.pi**2 / 50!r}*sin(2*pi*y)", "0"]},
            "compressibility": {"max_speed": 1.2}, "time": {"max_step": step}}


def layers(step):
    """Air over water at rest, with the viscosities of cases/hydrostatic_layers."""
    return {"title": "layers", "method": "wcsph",
            "domain": {"lower": [0.0, 0.0], "upper": [1.0, 1.0], "left": "free-slip", "right": "free-slip",
                       "bottom": "free-slip", "top": "free-slip"},
            "resolution": {"spacing": 1 / 16}, "fluid": {"froude": 1.0},
            "phase": [{"name": "water", "density": 1000.0, "viscosity": 0.5}, {"name": "air", "density": 1.0, "viscosity": 0.01}],
            "region": [{"phase": "air"}, {"phase": "water", "upper": [1.0, 0.5]}], "time": {"max_step": step}}


SCENES = {"sustained_flow": (sustained_flow, 0.004), "pool": (pool, 0.01), "plume": (plume, 0.02),
          "sloshing": (sloshing, 0.005),
          "turbulence": (turbulence, 0.02), "particles": (particles, 0.02), "sustained_phase": (sustained_phase, 0.0025),
          "layers": (layers, 2e-4)}


def usage(pid):
    """Resident bytes and processor seconds of a process."""
    with open(f"/proc/{pid}/statm", encoding="ascii") as file:
        resident = int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")
    with open(f"/proc/{pid}/stat", encoding="ascii") as file:
        fields = file.read().rpartition(")")[2].split()
    return resident, (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def last_step(path):
    """Step of the last whole row of series.csv; 0 before there is one."""
    try:
        with path.open("rb") as file:
            file.seek(max(0, path.stat().st_size - 4000))
            return int(float(file.read().decode().rstrip("\n").splitlines()[-1].split(",")[0]))
    except (OSError, ValueError, IndexError):
        return 0


def watch(process, series):
    """(step, resident bytes, processor seconds) while the program runs, about twice a second."""
    samples = []
    while process.poll() is None:
        time.sleep(0.5)
        try:
            samples.append((last_step(series), *usage(process.pid)))
        except (OSError, IndexError):
            break
    return np.array(samples).reshape(-1, 3)


def drift(values):
    """Difference of the means of the last quarter and the first, over the spread of either."""
    quarter = len(values) // 4
    first, last = values[:quarter], values[-quarter:]
    spread = max(np.std(first), np.std(last))
    return abs(np.mean(last) - np.mean(first)), spread


def check_series(kind, series):
    complaints = finite_table(series)
    if complaints:
        return complaints
    settled = series["step"] > SETTLED * series["step"][-1]
    late = {name: values[settled] for name, values in series.items()}
    if "mass" in series and np.ptp(series["mass"]) > 1e-12 * series["mass"][0]:
        complaints.append(f"mass: changes by {np.ptp(series['mass']) / series['mass'][0]:.3g}")
    if kind == "layers":
        # They leave the lattice that they begin on, and come to rest again.
        _, spread = drift(late["max_speed"])
        quarter = len(late["max_speed"]) // 4
        first, last = (np.mean(part) for part in (late["max_speed"][:quarter], late["max_speed"][-quarter:]))
        if last > first + 0.5 * spread:
            complaints.append(f"rest: speed {last:.3g}, and it grows")
        return complaints
    if kind == "pool":
        # Liquid at rest: nothing but the tolerance of the solves moves it.
        if np.max(late["max_speed"]) > 1e-2:
            complaints.append(f"rest: speed {np.max(late['max_speed']):.3g}")
        return complaints
    name = "mean_energy" if "mean_energy" in series else "kinetic_energy"
    change, spread = drift(late[name])
    # Steady to the sampling error: windows of a quarter hold tens of turnovers, a mean of them scatters by less than
    # half of the spread; and what does not vary may not change by more than 1e-3.
    if change > 0.5 * spread + 1e-3 * abs(np.mean(late[name])):
        complaints.append(f"energy: {change / np.mean(late[name]):.3g} of its mean apart, spread {spread / np.mean(late[name]):.3g}")
    if kind == "plume":
        came = late["injected_volume"] + late["entrained_volume"]
        error = np.max(np.abs(late["bubble_volume"] + late["burst_volume"] - came) / came)
        if error > 1e-10:
            complaints.append(f"gas: balance off by {error:.3g}")
    return complaints


def check_usage(samples, steps):
    """Memory and processor time per step after settling; no complaint about runs too short to sample."""
    samples = samples[samples[:, 0] > SETTLED * steps] if len(samples) else samples
    quarter = len(samples) // 4
    if quarter < 4:
        return [], {}
    complaints = []
    first, last = np.max(samples[:quarter, 1]), np.max(samples[-quarter:, 1])
    if last > first * (1 + MEMORY_GROWTH[0]) + MEMORY_GROWTH[1]:
        complaints.append(f"memory: {first / 1e6:.1f} MB, {last / 1e6:.1f} MB at the end")
    per_step = [np.ptp(part[:, 2]) / max(np.ptp(part[:, 0]), 1) for part in (samples[:quarter], samples[-quarter:])]
    if per_step[1] > SLOWER * per_step[0]:
        complaints.append(f"speed: {1e3 * per_step[0]:.3g} ms a step, {1e3 * per_step[1]:.3g} at the end")
    return complaints, {"megabytes": last / 1e6, "growth": last / first - 1, "slowdown": per_step[1] / per_step[0]}


def stress(arguments, out):
    """Rows of the table: each scene once, arguments.steps steps."""
    rows, begin = [], time.monotonic()
    for number, (kind, (make, step)) in enumerate(SCENES.items()):
        if arguments.kinds and kind not in arguments.kinds:
            continue
        if time.monotonic() - begin > arguments.seconds:
            print(f"stress: the time is over after {len(rows)} runs; --kinds {kind} and later ones are left")
            break
        folder = out / kind
        folder.mkdir()
        end = step * arguments.steps
        case = make(step)
        case["time"]["end"] = end
        case["output"] = {"series_every": end / 2000}
        (folder / "case.toml").write_text(toml_text(case), encoding="utf-8")
        command = [str(arguments.program), "run", str(folder / "case.toml"), "-o", str(folder / "run"), "--quiet", "--threads", "1"]
        start = time.monotonic()
        with (folder / "said.txt").open("w", encoding="utf-8") as said:
            process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=said)
            samples = watch(process, folder / "run" / "series.csv")
        complaints, figures, steps = [], {}, 0
        if process.returncode != 0:
            complaints = [f"exit code {process.returncode}: {(folder / 'said.txt').read_text(encoding='utf-8').strip()[-200:]}"]
        else:
            try:
                series = Results(folder / "run").series
                steps = int(series["step"][-1])
                complaints = check_series(kind, series)
            except MissingResult as missing:
                complaints = [str(missing)]
            more, figures = check_usage(samples, steps)
            complaints += more
        outcome = "crashed" if process.returncode < 0 else "failed" if complaints else "ok"
        rows.append({"number": number, "kind": kind, "outcome": outcome, "steps": steps,
                     **{name: f"{value:.4g}" for name, value in figures.items()},
                     "seconds": f"{time.monotonic() - start:.1f}", "complaint": "; ".join(complaints)})
        print(f"{kind:<16} {outcome:<8} {steps} steps in {rows[-1]['seconds']} s "
              f"{' '.join(f'{k} {v:.3g}' for k, v in figures.items())} {'; '.join(complaints)[:220]}", flush=True)
    return rows
