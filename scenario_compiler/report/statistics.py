"""Statistics that a sweep's report states: how sure a rate is."""

from __future__ import annotations

import math
from statistics import NormalDist


def wilson_interval(hits: int, count: int, confidence: float = 0.95) -> tuple[float, float]:
    """Return the interval of a rate that was observed `hits` times of `count`, by Wilson's score (1927).

    It holds for rates near 0 and 1 and for few runs, where the normal interval does not (Brown, Cai and DasGupta
    2001). (0, 1) without a run.
    """
    if count == 0:
        return 0.0, 1.0
    z = NormalDist().inv_cdf(0.5 + confidence / 2)
    rate, share = hits / count, z * z / count
    middle = (rate + share / 2) / (1 + share)
    half = z / (1 + share) * math.sqrt(rate * (1 - rate) / count + share / (4 * count))
    low = 0.0 if hits == 0 else max(0.0, middle - half)
    high = 1.0 if hits == count else min(1.0, middle + half)
    return low, high
