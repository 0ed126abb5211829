# SPDX-License-Identifier: MIT
"""Runs the program, and stops it when the script that runs it is stopped.

    with interruptible():
        out, errors, code = run_program(["spume", "run", ...])

SIGINT, SIGTERM and SIGHUP then raise Interrupted, once the signal has been passed on to the program and the program has
ended, so that with-blocks around it clean up. A second signal does not wait for the program's checkpoint.
"""
import signal
import subprocess
import sys
from contextlib import contextmanager

EXIT_CODE = 130  # as the program's own
PATIENCE = 20.0  # seconds that the program has for its checkpoint; then it is killed


class Interrupted(BaseException):
    """The script was asked to stop. Not an Exception: nothing that deals with failures may deal with this."""

    def __init__(self, number):
        super().__init__(signal.Signals(number).name)
        self.number = number


class State:
    child = None
    starting = False  # a child is being made: what arrives now waits until it is known
    pending = None
    stopping = False


def note(number, _frame):
    if State.stopping:
        if State.child is not None:
            State.child.kill()
    elif State.starting:
        State.pending = number
    else:
        State.stopping = True
        raise Interrupted(number)


@contextmanager
def interruptible():
    """From here on the signals raise Interrupted. SIGHUP does not where it is ignored, as under nohup."""
    State.stopping, State.pending = False, None
    numbers = [signal.SIGINT, signal.SIGTERM]
    if signal.getsignal(signal.SIGHUP) != signal.SIG_IGN:
        numbers.append(signal.SIGHUP)
    before = [(number, signal.signal(number, note)) for number in numbers]
    try:
        yield
    finally:
        for number, handler in before:
            signal.signal(number, handler)


def interruptible_main(main):
    """The exit code of main(), or that of an interruption."""
    try:
        with interruptible():
            return main()
    except Interrupted as stop:
        print(f"interrupted by {stop}", file=sys.stderr)
        return EXIT_CODE


def run_program(command):
    """What the command printed, its error output and its exit code."""
    try:
        State.starting = True
        State.child = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                       errors="replace")
        State.starting = False
        if State.pending is not None:
            note(State.pending, None)
        out, errors = State.child.communicate()
        return out, errors, State.child.returncode
    except BaseException as error:
        if State.child is not None:
            end(State.child, error.number if isinstance(error, Interrupted) else signal.SIGTERM)
        raise
    finally:
        State.starting, State.child = False, None


def end(child, number):
    """Passes the signal on and waits until the child is gone."""
    child.send_signal(number)
    try:
        child.communicate(timeout=PATIENCE)  # reads on, so that a full pipe does not hold the child
    except subprocess.TimeoutExpired:
        child.kill()
        child.wait()
