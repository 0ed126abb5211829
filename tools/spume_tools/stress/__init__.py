# SPDX-License-Identifier: MIT
"""Random and worst-case scenes, faults from outside and long runs: tools/stress."""
