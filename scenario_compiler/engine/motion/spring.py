"""The critically damped spring by which an entity approaches a distance: no overshoot, within limits.

a = k e - 2 sqrt(k) u, with the error e, the speed u that is to vanish, and k = 0.4 times the greatest acceleration
(esmini 3.6).
"""

from __future__ import annotations

from scenario_compiler.engine.columns.numbers import clip, safe_sqrt
from scenario_compiler.marker import compiled

STIFFNESS = 0.4
"""Share of the greatest acceleration that is the spring's constant, 1/m."""


@compiled
def spring_acceleration(error: float, speed: float, stiff: float, most: float, least: float) -> float:
    """Return the acceleration towards an error of 0, m/s2, from -`least` to `most`.

    `error` is in m, and `speed`, m/s, is to vanish. The constant is STIFFNESS times `stiff`, m/s2.
    """
    k = STIFFNESS * max(stiff, 0.0)
    return clip(k * error - 2.0 * safe_sqrt(k) * speed, -least, most)
