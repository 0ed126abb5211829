# SPDX-License-Identifier: MIT
"""Faults from outside: runs killed at random moments, disks that fill, damaged checkpoints, results and cases.

What must hold: no crash; a run that was broken off goes on to the same bits as one that never was, or is refused in words.
"""
import random
import resource
import shutil
import signal
import subprocess
import time
from pathlib import Path

import numpy as np

from ..case_file import toml_text
from ..results import MissingResult, Results
from .scenes import SCENES

MEMORY = 4 << 30  # a damaged number must not take the machine's memory

BASE = {
    "les-sph": """method = "les-sph"
[domain]
lower = [0, 0, 0]
upper = [1, 1, 1]
x = "periodic"
y = "periodic"
bottom = "no-slip"
[resolution]
spacing = 0.125
[fluid]
reynolds = 1e3
froude = 1
mach = 0.05
[constants]
depth = 0.5
[[liquid]]
where = "depth + 0.1*cos(2*pi*x) - z"
[turbulence]
model = "mixed-scale"
[bubbles]
weber = 1e3
fluctuations = true
[[bubble_cloud]]
lower = [0.3, 0.3, 0.1]
upper = [0.7, 0.7, 0.3]
number = 20
bubble_radius = 0.01
[[probe]]
name = "middle"
kind = "elevation"
position = [0.5, 0.5, 0]
[time]
end = 1.0
[output]
every = 0.02
checkpoint_every = 0
""",
    "spectral": """method = "spectral"
[domain]
lower = [0, 0, 0]
upper = [6.283185307179586, 6.283185307179586, 6.283185307179586]
x = "periodic"
y = "periodic"
z = "periodic"
[resolution]
grid = 12
[fluid]
reynolds = 50
[initial]
kind = "taylor-green"
[particles]
count = 300
diameter = 0.05
beta = 3
coupling = "four-way"
[time]
end = 2.0
[output]
every = 0.1
spectrum_every = 0.1
checkpoint_every = 0
""",
}


def limited(largest_file=None, memory=MEMORY):
    def prepare():
        resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
        if largest_file is not None:
            # Ignored, the signal turns into an error of write(), as on a full disk.
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (largest_file, largest_file))

    return prepare


class Program:
    def __init__(self, path, seconds=20):
        self.path, self.seconds = path, seconds

    def start(self, *arguments, **options):
        return subprocess.Popen([str(self.path), *map(str, arguments), "--threads", "1"], stdout=subprocess.DEVNULL,
                                stderr=subprocess.PIPE, text=True, errors="replace", preexec_fn=limited(**options))

    def run(self, *arguments, **options):
        process = self.start(*arguments, **options)
        try:
            said = process.communicate(timeout=self.seconds)[1]
        except subprocess.TimeoutExpired:
            process.kill()
            return "late", process.communicate()[1]
        return process.returncode, said


def state_of(folder):
    """What two runs that are one must share to the last bit: series, probes and snapshots."""
    run = Results(folder)
    state = {}
    for name in ("series.csv", "probes.csv", "bubble_sizes.csv", "spectrum.csv", "particle_pairs.csv"):
        if run.has(name):
            state[name] = (folder / name).read_bytes()
    for family in ("fluid", "bubbles"):
        if not run.has(f"{family}.vtkhdf"):
            continue
        snapshots = run.grid_snapshots(family) if run.on_grid and family == "fluid" else run.snapshots(family)
        state[f"{family} times"] = snapshots.times.tobytes()
        for index in {0, len(snapshots) // 2, len(snapshots) - 1}:
            snapshot = snapshots[index]
            for name, values in snapshot.fields.items():
                state[f"{family} {index} {name}"] = np.ascontiguousarray(values).tobytes()
    return state


def differences(reference, folder):
    try:
        state = state_of(folder)
    except (MissingResult, OSError, KeyError, ValueError) as error:
        return [f"results cannot be read: {type(error).__name__}: {error}"]
    return [f"differs in {name}" for name in reference if state.get(name) != reference[name]]


def refused(code, said):
    return code == 2 and "error" in said


def resumed_or_refused(program, folder, reference, may_refuse=True):
    code, said = program.run("resume", folder, "--quiet")
    if code == 0:
        wrong = differences(reference, folder)
        return ("failed", "wrong resume: " + ", ".join(wrong[:3])) if wrong else ("ok", "")
    if refused(code, said):
        if "is already at t" in said:
            wrong = differences(reference, folder)
            return ("failed", "finished, but " + ", ".join(wrong[:3])) if wrong else ("ok", "")
        return ("refused" if may_refuse else "failed"), said.strip()[:300]
    if code == 3:
        return "failed", "wrong resume: " + said.strip()[:300]
    return "crashed", f"exit code {code}: {said.strip()[-300:]}"


def kill(program, draw, work, case, reference, seconds):
    """SIGKILL after a random share of the run, up to three times, then to the end."""
    folder = work / "run"
    arguments = ["run", case, "-o", folder, "--quiet"]
    for _ in range(draw.randint(1, 3)):
        process = program.start(*arguments)
        time.sleep(draw.uniform(0, seconds))
        process.kill()
        process.communicate()
        if (folder / "checkpoint.h5").exists():
            arguments = ["resume", folder, "--quiet"]
        elif folder.exists():
            code, said = program.run("resume", folder, "--quiet")
            if not refused(code, said):
                return "failed", f"resume without a checkpoint: exit code {code}: {said.strip()[-200:]}"
            shutil.rmtree(folder)
    if arguments[0] == "run":
        code, said = program.run(*arguments)
        if code != 0:
            return "failed", f"exit code {code}: {said.strip()[-200:]}"
        arguments = ["resume", folder, "--quiet"]
    return resumed_or_refused(program, folder, reference, may_refuse=False)


def disk(program, draw, work, case, reference, seconds):
    """No file may grow beyond a random size; with the limit gone, the run goes on."""
    folder = work / "run"
    code, said = program.run("run", case, "-o", folder, "--quiet", largest_file=int(2 ** draw.uniform(6, 20)))
    # A disk that is full is bad input before the first step and a failure of the run after it; either names the file.
    if code != 0 and not (code in (2, 3) and "error: cannot" in said):
        return ("crashed" if code not in (2, 3, 130) else "failed"), f"exit code {code}: {said.strip()[-300:]}"
    if not (folder / "checkpoint.h5").exists():
        return "refused", said.strip()[:200]
    return resumed_or_refused(program, folder, reference, may_refuse=False)


def damage(draw, data):
    data = bytearray(data)
    if not data:
        return b"x"
    way = draw.choice(["flip", "flip", "flips", "cut", "zeros", "longer", "swap", "empty"])
    place = draw.randrange(len(data))
    if way == "flip":
        data[place] ^= 1 << draw.randrange(8)
    elif way == "flips":
        for _ in range(draw.randint(2, 50)):
            data[draw.randrange(len(data))] ^= 1 << draw.randrange(8)
    elif way == "cut":
        del data[place:]
    elif way == "zeros":
        data[place:place + 4096] = bytes(len(data[place:place + 4096]))
    elif way == "longer":
        data += draw.randbytes(draw.randint(1, 2000))
    elif way == "swap":
        other = draw.randrange(len(data))
        data[place:place + 64], data[other:other + 64] = data[other:other + 64], data[place:place + 64]
    else:
        data.clear()
    return bytes(data)


def spoil(program, draw, work, broken_off, reference, names):
    folder = work / "run"
    shutil.copytree(broken_off, folder)
    name = draw.choice(names)
    before = (folder / name).read_bytes()
    (folder / name).write_bytes(damage(draw, before))
    outcome, said = resumed_or_refused(program, folder, reference)
    return outcome, f"{name}: {said}" if said else ""


def checkpoint(program, draw, work, broken_off, reference, seconds):
    return spoil(program, draw, work, broken_off, reference, ["checkpoint.h5"])


def results(program, draw, work, broken_off, reference, seconds):
    """Records of the run are read again on resume: never a crash. What was spoilt in them cannot be known."""
    outcome, said = spoil(program, draw, work, broken_off, reference,
                          [p.name for p in sorted(broken_off.iterdir()) if p.suffix in (".vtkhdf", ".csv", ".h5part")])
    if outcome == "failed" and ("differs" in said or "does not unpack" in said) or "results cannot be read" in said:
        return "ok", ""
    return outcome, said


NUMBERS = ["0", "-1", "1e308", "-1e308", "1e-308", "nan", "inf", "1e9", "1e-9", "9223372036854775807", "0.5", "3", "\"x\"", "[]",
           "[1, 2]", "true", "\"1/0\"", "\"sqrt(-1)\"", "\"x*\"", "\"(((((((\"", "1e400", "{}", "\"\""]


def mutated_case(draw, text):
    lines = text.split("\n")
    for _ in range(draw.choice([1, 1, 1, 2, 5])):
        at = draw.randrange(len(lines))
        way = draw.choice(["value", "value", "value", "drop", "twice", "bytes", "swap"])
        if way == "value" and "=" in lines[at]:
            lines[at] = lines[at].split("=")[0] + "= " + draw.choice(NUMBERS)
        elif way == "drop":
            lines[at] = ""
        elif way == "twice":
            lines.insert(at, lines[draw.randrange(len(lines))])
        elif way == "bytes":
            data = damage(draw, lines[at].encode())
            lines[at] = data.decode("latin-1")
        else:
            other = draw.randrange(len(lines))
            lines[at], lines[other] = lines[other], lines[at]
    return "\n".join(lines)


def case(program, draw, work, text, reference, seconds):
    """A damaged case is refused in words, or is a case."""
    file = work / "case.toml"
    file.write_text(mutated_case(draw, text), encoding="latin-1")
    code, said = program.run("check", file)
    if code == 0:
        return "ok", ""
    if refused(code, said):
        return "refused", said.strip().split("\n")[0][:200]
    if code == "late":
        return "failed", "check took longer than the clock"
    return "crashed", f"exit code {code}: {said.strip()[-300:]}"


FAULTS = {"kill": kill, "disk": disk, "checkpoint": checkpoint, "results": results, "case": case}


def stress(arguments, out):
    """Rows of the table: the faults in turn, on each method."""
    program, begin, rows = Program(arguments.program, max(arguments.each, 10)), time.monotonic(), []
    prepared = {}
    for method, text in BASE.items():
        folder = out / f"reference-{method}"
        folder.mkdir()
        (folder / "case.toml").write_text(text, encoding="utf-8")
        start = time.monotonic()
        code, said = program.run("run", folder / "case.toml", "-o", folder / "run", "--quiet")
        seconds = time.monotonic() - start
        if code != 0:
            raise SystemExit(f"stress: the undisturbed run of {method} fails with exit code {code}: {said}")
        half = Results(folder / "run").case["time"]["end"] / 2
        code, said = program.run("run", folder / "case.toml", "-o", folder / "half", "--quiet", "--until", half)
        # --until is written into the case of the run; the whole run is what resume should go on to.
        text_of_run = (folder / "run" / "case.toml").read_text(encoding="utf-8")
        (folder / "half" / "case.toml").write_text(text_of_run, encoding="utf-8")
        prepared[method] = (folder, text, state_of(folder / "run"), seconds)
    names = [name for name in arguments.kinds or FAULTS if name in FAULTS]
    for number in range(arguments.first, arguments.first + arguments.runs):
        if time.monotonic() - begin > arguments.seconds:
            print(f"stress: the time is over after {len(rows)} runs; --first {number} goes on")
            break
        draw = random.Random(f"{arguments.seed} {number}")
        kind = names[number % len(names)]
        method = list(BASE)[number // len(names) % len(BASE)]
        folder, text, reference, seconds = prepared[method]
        work = out / f"run-{number}"
        work.mkdir()
        source = {"kill": folder / "case.toml", "disk": folder / "case.toml", "case": text}.get(kind, folder / "half")
        if kind == "case" and draw.random() < 0.5:
            text = toml_text(SCENES[method](np.random.default_rng([arguments.seed, number])).case)
            source = text
        outcome, complaint = FAULTS[kind](program, draw, work, source, reference, seconds)
        rows.append({"number": number, "kind": kind, "method": method, "outcome": outcome, "complaint": complaint})
        if outcome in ("failed", "crashed"):
            print(f"{number:5d} {kind:<10} {method:<8} {outcome:<8} {complaint[:220]}", flush=True)
            (out / "failures").mkdir(exist_ok=True)
            shutil.move(work, out / "failures" / work.name)
        else:
            shutil.rmtree(work)
    return rows
