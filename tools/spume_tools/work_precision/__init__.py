# SPDX-License-Identifier: MIT
"""Error against run time of cases with a known answer: tools/work-precision."""
