# SPDX-License-Identifier: MIT
"""Statistics of tools/bench-compare: ratios of times measured in pairs on a machine that others use too.

Each round gives one time of the old and one of the new program, taken one right after the other, so that what changes
slowly on the machine drops out of their ratio. What remains is noise of unknown shape with outliers on one side: only the
order of the ratios is used. The interval between the k-th smallest and the k-th largest of n ratios covers the median
with probability 1 - 2 P(X < k), X binomial(n, 1/2), whatever the shape (the sign test turned round).
"""
import math
from dataclasses import dataclass

import numpy as np

# Threads of a benchmark wait as the program's do (src/cli/openmp_environment.cpp).
WAITING = {"GOMP_SPINCOUNT": "1000", "OMP_WAIT_POLICY": "passive"}


def sign_interval(values, confidence=0.98):
    """(low, high, coverage): the narrowest interval of order statistics that covers the median at least so often."""
    ordered = np.sort(np.asarray(values, float))
    n = len(ordered)
    if n < 2:
        raise ValueError("an interval needs at least two ratios")
    tail, k = 0.0, 0
    while k < n // 2:
        further = tail + math.comb(n, k) / 2**n
        if 1 - 2 * further < confidence:
            break
        tail, k = further, k + 1
    k = max(k, 1)
    return float(ordered[k - 1]), float(ordered[n - k]), 1 - 2 * sum(math.comb(n, i) for i in range(k)) / 2**n


@dataclass
class Verdict:
    ratio: float  # median of new over old
    low: float
    high: float
    word: str  # "slower", "faster" or ""

    @property
    def regression(self):
        return self.word == "slower"


def judge(old, new, effect=0.04, confidence=0.98):
    """old, new: times of the rounds in pairs. A difference counts when the whole interval of the median lies on one side
    of equality and the median differs by more than `effect`: where functions lie in memory alone moves a time by a few
    per cent, and that is nobody's regression."""
    ratios = np.asarray(new, float) / np.asarray(old, float)
    if len(ratios) % 2:
        raise ValueError("an odd number of rounds gives one program the better place once more than the other")
    low, high, _ = sign_interval(ratios, confidence)
    ratio = float(np.median(ratios))
    word = "slower" if low > 1 and ratio > 1 + effect else "faster" if high < 1 and ratio < 1 - effect else ""
    return Verdict(ratio, low, high, word)


def undecided(old, new, effect=0.04, confidence=0.98):
    """Whether more rounds may show a difference: the median is past half the effect, the interval holds equality."""
    verdict = judge(old, new, effect, confidence)
    return not verdict.word and abs(verdict.ratio - 1) > effect / 2
