# SPDX-License-Identifier: MIT
"""Whether the [verify] table of a case says something that can be run and checked; cases.py tells its form.

A misspelt word must not turn into a bound that nobody checks: whatever is not known is refused, with its line, what was
expected and the fix, and all faults of a case at once.
"""
import difflib
import math
import re
import tomllib

FORMS = ("quick", "run", "bounds")
RUN_KEYS = ("name", "set", "until", "start")
NAME = re.compile(r"\w[\w.+-]*")


def is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def suggestion(word, known):
    near = difflib.get_close_matches(word, known, 1)
    return f"; did you mean '{near[0]}'?" if near else ""


class Place:
    """Lines of a case file by the names of its tables and keys, however they are written.

    The parser gives no lines, but it tells which of the first lines of a file make a file and what they hold: something
    begins on the line after the longest such beginning that does not hold it.
    """

    def __init__(self, path, text):
        self.path = path
        self.lines = text.splitlines()

    def of(self, header, key=None, number=0):
        """`file:line` of a key in [header], or in the number-th [[header]]; else of the table; else the file."""
        for inside in ([key] if key is not None else []), []:
            line = self.line_of(header.split("."), number, inside)
            if line is not None:
                return f"{self.path}:{line}"
        return str(self.path)

    def line_of(self, names, number, inside):
        before = 0
        for line in range(1, len(self.lines) + 1):
            try:
                held = tomllib.loads("\n".join(self.lines[:line]) + "\n")
            except tomllib.TOMLDecodeError:
                continue  # in the middle of a value
            if holds(held, names, number, inside):
                return before + 1
            before = line
        return None


def holds(value, names, number, inside):
    """Whether a table holds what these names lead to, and that the names of `inside`; of repeated tables the number-th."""
    for name in [*names, *inside]:
        if isinstance(value, list):
            value = value[number] if number < len(value) else None
        if not isinstance(value, dict) or name not in value:
            return False
        value = value[name]
    return not isinstance(value, list) or bool(inside) or number < len(value)


class VerifyTable:
    """Collects what is wrong with one case's [verify]."""

    def __init__(self, path, text):
        self.place = Place(path, text)
        self.problems = []

    def refuse(self, text, header, key=None, number=0):
        self.problems.append(f"{self.place.of(header, key, number)}: {text}")

    def check(self, table, quick):
        """table: [verify] as read; quick: whether its short form is to be run. Returns the list of problems."""
        if not isinstance(table, dict):
            self.refuse(f"verify = {table!r}; expected a table: write [verify.bounds] with quantity = bound", "verify")
            return self.problems
        self.check_form(table, "verify", FORMS)
        short = table.get("quick", False)
        if isinstance(short, dict):
            self.check_form(short, "verify.quick", FORMS[1:])
        elif not isinstance(short, bool):
            self.refuse(f"quick = {short!r}; expected true, false or a table [verify.quick]", "verify", "quick")
        # What follows is about what is run now: a table may lack the bounds of a form that nobody asked for.
        separate = quick and isinstance(short, dict)
        form, header = (short, "verify.quick") if separate else (table, "verify")
        if (not quick or short) and not form.get("bounds"):
            self.refuse(f"[{header}] holds no bound, so nothing would be checked; add [{header}.bounds] with "
                        "quantity = bound", header)
        return self.problems

    def check_form(self, form, header, known):
        for key in form.keys() - set(known):
            self.refuse(f"unknown key '{key}' in [{header}]; expected {', '.join(known)}{suggestion(key, known)}",
                        header, key)
        self.check_runs(form.get("run", []), header)
        bounds = form.get("bounds", {})
        if not isinstance(bounds, dict):
            self.refuse(f"bounds = {bounds!r}; expected a table [{header}.bounds] with quantity = bound", header, "bounds")
            return
        for quantity, bound in bounds.items():
            fault = fault_of_bound(bound)
            if fault:
                self.refuse(f"{quantity} = {bound!r}: {fault}", f"{header}.bounds", quantity)

    def check_runs(self, runs, header):
        header += ".run"
        if not isinstance(runs, list) or not all(isinstance(run, dict) for run in runs):
            self.refuse(f"run = {runs!r}; expected tables [[{header}]] with a name each", header.rpartition(".")[0], "run")
            return
        before = []
        for number, run in enumerate(runs):
            def refuse(text, key=None):
                self.refuse(text, header, key, number)

            for key in run.keys() - set(RUN_KEYS):
                refuse(f"unknown key '{key}' in [[{header}]]; expected {', '.join(RUN_KEYS)}{suggestion(key, RUN_KEYS)}",
                       key)
            name = run.get("name")
            if name is None:
                refuse(f"run {number + 1} of [[{header}]] has no name; add name = \"...\", which measure.py knows it by")
            elif not isinstance(name, str) or not NAME.fullmatch(name) or name == "plots":
                refuse(f"name = {name!r}; expected letters, digits, '_', '-', '.' or '+' that can name a folder, other "
                       "than 'plots'", "name")
            elif name in before:
                refuse(f"name = '{name}' is that of an earlier run; give each run its own", "name")
            settings = run.get("set", [])
            if not isinstance(settings, list) or not all(isinstance(s, str) and "=" in s for s in settings):
                refuse(f"set = {settings!r}; expected a list of texts \"section.key=value\"", "set")
            until = run.get("until", 1)
            if not is_number(until) or not 0 < until < math.inf:
                refuse(f"until = {until!r}; expected a time above 0", "until")
            start = run.get("start")
            if start is not None and start not in before:
                refuse(f"start = {start!r} is no run before this one; expected {' or '.join(before) or 'none'}", "start")
            if isinstance(name, str):
                before.append(name)


def fault_of_bound(bound):
    """What is wrong with a bound; empty when nothing is."""
    if is_number(bound):
        return "" if 0 <= bound < math.inf else ("no magnitude lies below this; expected a finite number, at least 0, or "
                                                 "[lower, upper]")
    if not isinstance(bound, list) or len(bound) != 2 or not all(is_number(value) for value in bound):
        return "not a bound; expected a number, or [lower, upper] of two numbers, without quotation marks"
    lower, upper = bound
    if not lower <= upper or math.isinf(lower) and math.isinf(upper):
        return "no interval; expected [lower, upper], lower no greater than upper"
    return ""
