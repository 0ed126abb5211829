# SPDX-License-Identifier: MIT
"""Checks of the sources that no compiler makes: tools/lint."""
