# SPDX-License-Identifier: MIT
"""Two runs side by side, as a table and in pictures: `spume compare DIR DIR2`."""
