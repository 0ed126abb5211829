# SPDX-License-Identifier: MIT
"""What tools/stress asks of a run: `judge` gives an outcome and the list of complaints.

Outcomes: ok; slow (ended by the driver's clock, in good order); refused (exit 2, said why); stopped (exit 3, said where
and why); failed (a check complains); crashed (a signal, or an exit code that is none of the program's).
"""
import re

import numpy as np

from ..results import MissingResult, Results

# Bounds, each relative to what is named with it.
MOMENTUM = 0.02  # of mass times the largest speed: interpolation with corrected gradients is not pairwise antisymmetric
ENERGY_GROWTH = 0.05  # of the largest energy that has moved; a stable scheme loses energy, rounding is far below
SPECTRAL_GROWTH = 1e-3  # of the initial energy: transport conserves it, and viscosity is exact
PAIRWISE_MOMENTUM = 1e-4  # of wcsph: rounding of float sums, 1e-7 of forces a hundred times as large as what they leave
BALANCE = 0.05  # of what viscosity takes between two rows, courant <= 0.5
STILL = 1e-3  # of sqrt(gH): speeds of water at rest
LOADED_BALANCE = 0.25  # the same with particles, whose force is held over a step


def finite_table(table):
    return [f"{name} is not finite in row {int(np.argmin(np.isfinite(values)))}" for name, values in table.items()
            if values.dtype.kind == "f" and not np.all(np.isfinite(values))]


def removed_mass(series):
    """What left through open sides for good, in each row."""
    return series["mass_removed"] if "mass_removed" in series else np.zeros(len(series["t"]))


def particles_removed(run, count, time):
    """Of `count` at the start, all of one mass, until `time`."""
    if "mass_removed" not in run.series or "mass" not in run.series:
        return 0
    row = int(np.argmin(np.abs(run.series["t"] - time)))
    return round(float(run.series["mass_removed"][row] / run.series["mass"][0]) * count)


def check_particles(run, scene, complaints, periodic_margin=0.0):
    snapshots = run.snapshots()
    first, last = snapshots[0], snapshots[-1]
    for name, values in [("position", last.position), *last.fields.items()]:
        if not np.all(np.isfinite(values)):
            complaints.append(f"finite: {name} of the last snapshot is not")
    if "id" in first.fields:
        before, after = np.sort(first.fields["id"]), np.sort(last.fields["id"])
        removed = particles_removed(run, len(before), last.time)
        if len(after) != len(before) - removed or len(np.unique(after)) < len(after) or not np.all(np.isin(after, before)):
            complaints.append(f"particles: {len(before)} at the start, {removed} removed, {len(after)} at the end, or other ids")
    lower, upper = run.bounds()
    domain = scene.case["domain"]
    names = ["left", "right", "bottom", "top"] if len(lower) == 2 else ["left", "right", "front", "back", "bottom", "top"]
    walls = scene.case.get("domain.wall_velocity", {})
    for axis in range(len(lower)):
        held = "xyz"[axis] in domain
        for side, sign in ((2 * axis, -1), (2 * axis + 1, 1)):
            if not held and domain.get(names[side], "open") == "open" or names[side] in walls:
                continue
            beyond = sign * (last.position[:, axis] - (lower, upper)[side % 2][axis])
            allowed = 1e-9 + (periodic_margin if held else 0)
            if np.any(beyond > allowed):
                complaints.append(f"particles: {int(np.sum(beyond > allowed))} beyond the {names[side]} side")
    for solid in scene.case.get("solid", []):
        inside = np.all((last.position[:, :len(lower)] > np.array(solid["lower"]) + 1e-6)
                        & (last.position[:, :len(lower)] < np.array(solid["upper"]) - 1e-6), axis=1)
        if np.any(inside):
            complaints.append(f"particles: {int(np.sum(inside))} inside a solid")


def work_of_force(series, force, axes, gravity):
    """Impulse per mass of the uniform force and of gravity at each row, by the midpoint of each step."""
    t = series["t"]
    impulse = np.zeros((len(t), len(axes)))
    for row in range(1, len(t)):
        acceleration = np.array(force((t[row] + t[row - 1]) / 2) if force else np.zeros(3))[: len(gravity)] + gravity
        impulse[row] = impulse[row - 1] + (t[row] - t[row - 1]) * acceleration[axes]
    return impulse


def check_les_sph(run, scene, complaints):
    series, facts = run.series, scene.facts
    complaints += [f"finite: {text}" for text in finite_table(series)]
    if complaints:
        return
    mass, removed = series["mass"], removed_mass(series)
    # What is beyond an open side and not removed yet is in neither; that no particle is lost check_particles() sees.
    spills, lacks = "mass_removed" in series, mass[0] - mass - removed
    wrong = -np.min(lacks) if spills else np.max(np.abs(lacks))
    if "bubbles" not in scene.case and wrong > 4e-15 * mass[0]:
        complaints.append(f"mass: changes by {wrong / mass[0]:.3g}")
    residual, tolerance = series["pressure_residual"], series["pressure_tolerance"]
    worst = int(np.argmax(residual - tolerance))
    if residual[worst] > tolerance[worst] * (1 + 1e-6):
        complaints.append(f"convergence: residual {residual[worst]:.3g} for {tolerance[worst]:.3g} in row {worst}, nothing was said")
    if np.max(tolerance) > 0.01:
        complaints.append(f"convergence: only {np.max(tolerance):.3g} was asked for")
    gravity = np.zeros(run.dimensions)
    gravity[-1] = -1.0 / scene.case["fluid"].get("froude", np.inf) ** 2
    if spills:
        # What leaves takes momentum and energy with it.
        left = np.abs(lacks + removed) > 4e-15 * mass[0]
        held = int(np.argmax(left)) if np.any(left) else len(left)
        series, mass = {name: values[:held] for name, values in series.items()}, mass[:held]
    speed = max(facts["speed"], float(np.max(series["max_speed"])))
    axes = facts["free_axes"]
    if axes:
        momentum = np.stack([series["momentum_" + "xyz"[axis]] for axis in axes], axis=1)
        expected = momentum[0] + mass[:1] * work_of_force(series, facts["force"], axes, gravity)
        drift = np.max(np.abs(momentum - expected)) / (mass[0] * speed)
        if drift > MOMENTUM:
            complaints.append(f"momentum: drifts by {drift:.3g} of mass times largest speed")
    kinetic, potential, total = series["kinetic_energy"], series["potential_energy"], series["total_energy"]
    if facts["conservative"]:
        # A quarter of a spacing in height is what the arrangement of particles alone may move.
        moved = max(np.max(kinetic), np.max(np.abs(potential - potential[0])))
        moved += mass[0] * abs(gravity[-1]) * run.spacing / 4
        growth = (np.max(total) - total[0]) / max(moved, 1e-300)
        if growth > ENERGY_GROWTH:
            complaints.append(f"energy: grows by {growth:.3g} of the energy moved")
    check_particles(run, scene, complaints)


def integral(series, name):
    """Over time, by trapezia."""
    t, values = series["t"], series[name]
    return float(np.sum(0.5 * (values[1:] + values[:-1]) * np.diff(t)))


def loading(run, particles):
    """Volume fraction of the particles, and their mass with the fluid that they move over that of all fluid."""
    lower, upper = run.bounds()
    fraction = particles.get("volume_fraction") or (
        particles["count"] * np.pi / 6 * particles["diameter"] ** 3 / np.prod(np.subtract(upper, lower)))
    return fraction, fraction * (0.5 * (3 / particles["beta"] - 1) + 0.5)


def check_spectral(run, scene, complaints):
    series, facts = run.series, scene.facts
    # Not numbers by definition: scales without viscosity, moments of no gradient, dimensions of too few particles.
    undefined = {"gradient_skewness", "gradient_flatness", "taylor_scale", "kolmogorov_scale", "reynolds_lambda", "kmax_eta",
                 "correlation_dimension"}
    complaints += [f"finite: {text}" for text in finite_table({k: v for k, v in series.items() if k not in undefined})]
    if complaints:
        return
    energy = series["mean_energy"]
    aliased = scene.case["spectral"]["dealiasing"] == "none"
    if facts["conservative"] and not aliased:
        growth = (np.max(energy) - energy[0]) / energy[0]
        if growth > SPECTRAL_GROWTH:
            complaints.append(f"energy: grows by {growth:.3g} without a force")
    if facts["loaded"] and not aliased and "gravity" not in scene.case["particles"]:
        # Particles give back what they brought along; and what is put into a fluid of which a part is bubbles moves the
        # rest the more, by 1 / (1 - fraction): (11) of de Wit et al. (2024).
        fraction, mass = loading(run, scene.case["particles"])
        supply = energy[0] * (1 + mass) + integral(series, "mean_injection") / (1 - fraction)
        if np.max(energy) > (1 + ENERGY_GROWTH) * supply:
            complaints.append(f"energy: {np.max(energy):.3g} of {supply:.3g} that start, force and particles supply")
    if scene.case["time"]["courant"] <= 0.5 and not aliased and len(energy) > 3:
        # Relative to the energy in play where viscosity takes next to nothing.
        lost = integral(series, "mean_dissipation")
        worst = np.max(np.abs(series["balance_residual"][3:]))
        if worst > (LOADED_BALANCE if facts["loaded"] else BALANCE) and lost > 1e-3 * energy[0]:
            complaints.append(f"energy: balance off by {worst:.3g} of the dissipation")
    if "particles" in scene.case:
        snapshots = run.snapshots("bubbles")
        first, last = snapshots[0], snapshots[-1]
        if len(first) != len(last) or np.any(np.sort(first.fields["id"]) != np.sort(last.fields["id"])):
            complaints.append(f"particles: {len(first)} at the start, {len(last)} at the end, or other ids")
        for name, values in [("position", last.position), *last.fields.items()]:
            if not np.all(np.isfinite(values)):
                complaints.append(f"finite: {name} of the particles is not")
        lower, upper = run.bounds()
        if np.any(last.position < lower - 1e-5) or np.any(last.position > upper + 1e-5):
            complaints.append("particles: outside the box")


def phase_masses(run, scene):
    phase = np.asarray(run.snapshots()[0].field("phase"), int)
    volume = run.spacing**run.dimensions
    return [volume * one["density"] * np.sum(phase == number) for number, one in enumerate(scene.case["phase"])]


def said_densities(run):
    log = run.folder / "log.txt"
    return log.is_file() and "the density of" in log.read_text(encoding="utf-8")


def check_wcsph(run, scene, complaints):
    series, facts = run.series, scene.facts
    complaints += [f"finite: {text}" for text in finite_table(series)]
    if complaints:
        return
    names, masses = [one["name"] for one in scene.case["phase"]], phase_masses(run, scene)
    speed = max(facts["speed"], float(np.max(series["max_speed"])))
    # Forces are antisymmetric but for those of tension; shifting of several phases carries momentum too.
    if "interface" not in scene.case:
        for axis in facts["free_axes"]:
            momentum = sum(mass * series[f"velocity_{name}_{'xyz'[axis]}"] for mass, name in zip(masses, names))
            drift = np.max(np.abs(momentum - momentum[0])) / (sum(masses) * speed)
            if drift > PAIRWISE_MOMENTUM:
                complaints.append(f"momentum: drifts by {drift:.3g} of mass times largest speed")
    if facts["conservative"]:
        parts = [series[name] for name in ("kinetic_energy", "potential_energy", "compression_energy", "surface_energy")
                 if name in series]
        # Pressures jump and interfaces are measured with the first step.
        parts = [part[1 if "interface" in scene.case else 0:] for part in parts]
        total = sum(parts)
        moved = max(np.max(np.abs(part - part[0])) for part in parts) + parts[0][0]
        if "froude" in scene.case.get("fluid", {}):
            # In height, as for les-sph; densities follow kernel sums, which jitter makes uneven, within 1 %: a spacing.
            moved += sum(masses) * run.spacing * (0.25 if scene.parameters.get("jitter", 0) == 0 else 1)
        if "interface" in scene.case:
            moved += np.max(series["surface_energy"])  # found from the arrangement within 2 %
        growth = (np.max(total) - total[0]) / max(moved, 1e-300)
        # A run whose densities leave the range of their sound speed says so, and what to set.
        if growth > ENERGY_GROWTH and not said_densities(run):
            complaints.append(f"energy: grows by {growth:.3g} of the energy moved")
    # Particles go round periodic sides when lists are made: until then they are up to half a skin outside.
    periodic_margin = scene.case.get("lists", {}).get("skin", 0.4) / 2 * run.spacing
    check_particles(run, scene, complaints, periodic_margin)


def check_still(run, scene, complaints):
    complaints += [f"finite: {text}" for text in finite_table(run.series)]
    if complaints:
        return
    speed = run.series["max_speed"] / scene.facts["speed"]
    if np.max(speed) > STILL:
        first = run.series["t"][int(np.argmax(speed > STILL))]
        complaints.append(f"rest: {np.max(speed):.3g} sqrt(gH), above {STILL:g} from t = {first:.3g} on")
    check_particles(run, scene, complaints)


CHECKS = {"les-sph": check_les_sph, "spectral": check_spectral, "wcsph": check_wcsph, "still": check_still}

# What an error must say: its place in the case file or its step, and what was found.
WORDS = {2: re.compile(r"error: \S+"), 3: re.compile(r"step \d+.*t = ", re.S)}


def judge(method, scene, folder, code, stderr, timed_out):
    """Outcome, complaints and figures of a finished run."""
    if code < 0 or code not in (0, 2, 3, 130):
        return "crashed", [f"exit code {code}: {stderr.strip()[-300:]}"], {}
    if code in WORDS and not WORDS[code].search(stderr):
        return "failed", [f"message: exit code {code} does not say where and why: {stderr.strip()[-300:]}"], {}
    if code == 2:
        return "refused", [line for line in stderr.splitlines() if "error" in line][:1], {}
    if code == 130 and not timed_out:
        return "failed", ["exit code 130 although nobody interrupted the run"], {}
    complaints, figures = [], {}
    try:
        run = Results(folder)
        figures = {"steps": int(run.series["step"][-1]), "reached": float(run.series["t"][-1]),
                   "retries": run.summary["retries"], "max_speed": float(np.max(run.series["max_speed"]))}
        CHECKS[method](run, scene, complaints)
        if code == 3:  # it said itself that it makes energy
            complaints = [text for text in complaints if not text.startswith(("energy", "momentum", "rest"))]
    except (MissingResult, KeyError, IndexError, OSError, ValueError) as error:
        complaints.append(f"results: {type(error).__name__}: {error}")
    if code == 3 and method == "still":  # no jet, no thin film: water at rest ends nowhere
        complaints.append(stderr.strip().splitlines()[0][:300])
    if complaints:
        return "failed", complaints, figures
    if code == 3:
        return "stopped", [stderr.strip().splitlines()[0][:300]], figures
    return ("slow" if timed_out else "ok"), [], figures
