"""Statistics in a sweep's report: the uncertainty of rates."""

from __future__ import annotations

import math
from statistics import NormalDist

LEVEL = 0.95
"""Confidence level of the intervals."""


def wilson_interval(hits: int, count: int) -> tuple[float, float]:
    """Return the 95 % confidence interval of a rate with `hits` of `count` runs, by Wilson's score (1927).

    It is also valid for rates near 0 and 1 and for few runs, unlike the normal interval (Brown, Cai and DasGupta 2001).
    Without a run it is (0, 1).

    Raises:
        ValueError: `hits` is not from 0 to `count`.
    """
    if not 0 <= hits <= count:
        raise ValueError(f"hits is from 0 to count, {count}, not {hits}")
    if count == 0:
        return 0.0, 1.0
    z = NormalDist().inv_cdf(0.5 + LEVEL / 2)
    rate, share = hits / count, z * z / count
    middle = (rate + share / 2) / (1 + share)
    half = z / (1 + share) * math.sqrt(rate * (1 - rate) / count + share / (4 * count))
    low = 0.0 if hits == 0 else max(0.0, middle - half)
    high = 1.0 if hits == count else min(1.0, middle + half)
    return low, high
