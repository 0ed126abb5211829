# SPDX-License-Identifier: MIT
"""Speed and memory of whole runs, parts and routines: tools/bench, tools/bench-compare, tools/roofline."""
