# SPDX-License-Identifier: MIT
"""What readers raise."""


class MissingResult(Exception):
    """A file or a column that a run did not write."""


class DamagedResult(MissingResult):
    """A file that is there but does not hold what it should."""
