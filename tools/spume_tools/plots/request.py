# SPDX-License-Identifier: MIT
"""What a user asks of the pictures: times, fields, plane, ranges."""
from dataclasses import dataclass, field

from ..results import Results


@dataclass(frozen=True)
class Request:
    times: tuple = ()        # that snapshots are drawn at; without: evenly spaced
    fields: tuple = ()       # drawn in planes; without: those of FIELDS that the run has
    plane: tuple = None      # axis (0, 1, 2) and coordinate; without: the middle of the second axis
    ranges: dict = field(default_factory=dict)  # of the colours, by field: (low, high)


class DrawnRun(Results):
    """A run with what is asked of its pictures."""

    def __init__(self, folder, request=Request()):
        super().__init__(folder)
        self.request = request


def request_of(run):
    """What is asked of the pictures of a run; everything where nothing is."""
    return getattr(run, "request", Request())
