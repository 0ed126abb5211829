# SPDX-License-Identifier: MIT
"""Validation cases: where they are, how one is run, and what its measure.py says about the runs.

cases/<name>/case.toml holds the case and, in [verify], what is run and which bounds hold:

    [verify]
    quick = true                      # takes seconds, so tools/test runs it; or a table like [verify] for a shorter one
    [[verify.run]]                    # none: the case as it stands, under the name "run"
    name = "coarse"
    set = ["resolution.spacing=0.02"] # as --set on the command line
    until = 1.0                       # as --until
    start = "flow"                    # [initial] is the last state of that earlier run, of any grid
    [verify.bounds]
    velocity_error = 0.01             # upper bound, or [lower, upper]

cases/<name>/measure.py defines
    measure(runs) -> {quantity: value}         runs: {name: Results}; quantities without a bound are reported only
    curves(runs)  -> [figure]                  optional; see plots.comparison.draw_curves
    errors(run)   -> {quantity: value}         optional; errors of one run, for convergence tables
and reads its references at its top level with spume_tools.results.read_reference: it is loaded before the first run, so that a
damaged one is found then.
"""
import importlib.util
import time
import traceback
from pathlib import Path

from ..places import CASES
from ..program import run_program
from ..results import DamagedResult, MissingResult, Results, read_case


class RunFailed(Exception):
    """The program ended with another exit code than 0."""


def case_folder(name):
    """The folder of a case given by name, by folder or by its case.toml."""
    for folder in (Path(name), Path(name).parent, CASES / name):
        if (folder / "case.toml").is_file() and (folder != Path(name).parent or Path(name).name == "case.toml"):
            return folder.resolve()
    known = ", ".join(sorted(path.parent.name for path in CASES.glob("*/case.toml")))
    raise MissingResult(f"{name}: not a case; the cases are {known}")


def cases_with_verification():
    return [path.parent for path in sorted(CASES.glob("*/case.toml")) if "verify" in read_case(path)]


def find_case(run):
    """The folder of the case that a run came from: the one that summary.json names, where it holds a measure.py; else the
    one in cases/ with the same title; None when there is none."""
    try:
        file = run.summary.get("case")
    except MissingResult:  # a run under way, or one that was killed
        file = None
    if isinstance(file, str):
        # A path as it was given where the run was started: most often a folder above the run's own.
        for start in (*run.folder.resolve().parents, Path.cwd()):
            folder = (start / file).parent
            if (folder / "measure.py").is_file():
                return folder.resolve()
    try:
        title = run.case.get("title")
    except MissingResult:
        return None
    for path in sorted(CASES.glob("*/case.toml")):
        try:
            if title and read_case(path).get("title") == title:
                return path.parent
        except MissingResult:
            continue
    return None


def load_measure(folder):
    """The module measure.py of a case; None when it has none. DamagedResult when it, or a reference it reads, is faulty."""
    path = Path(folder) / "measure.py"
    if not path.is_file():
        return None
    specification = importlib.util.spec_from_file_location(f"measure_{Path(folder).name}", path)
    module = importlib.util.module_from_spec(specification)
    try:
        specification.loader.exec_module(module)
    except MissingResult:
        raise
    except Exception as error:
        raise DamagedResult(f"{fault_place(path, error)}: cannot be loaded ({type(error).__name__}: {error}); correct "
                            "measure.py") from error
    return module


def fault_place(path, error):
    """`file:line` of the last line of the file that an error came through; the file alone where there is none."""
    lines = [frame.lineno for frame in traceback.extract_tb(error.__traceback__) if frame.filename == str(path)]
    if isinstance(error, SyntaxError) and error.filename == str(path):
        lines.append(error.lineno)
    return f"{path}:{lines[-1]}" if lines else str(path)


def run_case(program, folder, out, settings=(), until=None, threads=None):
    """Runs the program on a case into the folder out, which must not exist; returns its Results."""
    command = [str(program), "run", str(Path(folder) / "case.toml"), "-o", str(out), "--quiet"]
    for setting in settings:
        command += ["--set", setting]
    if until is not None:
        command += ["--until", repr(float(until))]
    if threads is not None:
        command += ["--threads", str(threads)]
    start = time.monotonic()
    printed, errors, code = run_program(command)
    seconds = time.monotonic() - start
    if code != 0:
        messages = (printed + errors).strip().splitlines()[-25:]
        words = "\n".join(f"    {message}" for message in messages)
        raise RunFailed(f"exit code {code} from: {' '.join(command)}\n{words}")
    return Results(out, wall_seconds=seconds)


def settings_of(run, runs):
    """What a [[verify.run]] sets on the command line; runs: those made before it."""
    settings = list(run.get("set", ()))
    if "start" in run:
        if run["start"] not in runs:
            raise RunFailed(f"run '{run['name']}' starts from '{run['start']}', which is no run before it")
        checkpoint = runs[run["start"]].folder.resolve() / "checkpoint.h5"
        settings.append(f'initial={{kind="checkpoint", file="{checkpoint}"}}')
    return settings


def within(value, bound):
    """True when the value lies within the bound: an upper bound for its magnitude, or [lower, upper]."""
    if isinstance(bound, list):
        return bound[0] <= value <= bound[1]
    return abs(value) <= bound
