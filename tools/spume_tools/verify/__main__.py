# SPDX-License-Identifier: MIT
import signal
import sys

signal.signal(signal.SIGINT, signal.SIG_DFL)  # no traceback from a stop during what follows
from .command import command

sys.exit(command())
