# SPDX-License-Identifier: MIT
"""Python behind the commands of Spume: reading results, pictures, verification, benchmarks, stress tests.

For programs of your own, `from spume_tools import results` reads what a run left in its folder into numpy arrays. The
folder that holds this package must be on PYTHONPATH: tools/ of the sources, share/spume/tools of an installation.
"""
