# SPDX-License-Identifier: MIT
"""Validation cases run and held against their bounds: `spume verify [CASE...]`."""
