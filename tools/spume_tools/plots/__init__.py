# SPDX-License-Identifier: MIT
"""Standard pictures of a run: `spume plot DIR`."""
