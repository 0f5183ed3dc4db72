"""What is true about the lane in a picture, and when a detected boundary is right."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from scenario_compiler.perception.lane_detector import Boundary

Floats = NDArray[np.float64]

X = np.arange(6.0, 18.5, 1.0)
"""Distances ahead of the camera at which a boundary has to be right, m."""

SEEN, SEEN_SHARE = 0.15, 0.6
"""Quality times the weather's contrast over which paint counts as there, and the share of the stretch that needs it."""


@dataclass(frozen=True, eq=False)
class Truth:
    """The lane ahead.

    Attributes:
        boundaries: y(X) of the left and the right boundary in the camera's ground frame, m; infinite where a boundary
            turns away so much that it never comes as far ahead.
        painted: Share of the stretch on which paint is there, of the left and the right boundary.
    """

    boundaries: tuple[Floats, Floats]
    painted: tuple[float, float]

    @staticmethod
    def of(left: Floats, right: Floats, painted: tuple[float, float]) -> Truth:
        """Return the truth from points (n, 2) of both boundaries in the camera's ground frame, in order of travel."""
        return Truth((_at(left), _at(right)), painted)

    def error(self, side: int, boundary: Boundary) -> float:
        """Return the largest lateral error of a detected boundary, m."""
        return float(np.abs(boundary.y(X) - self.boundaries[side]).max())

    def there(self, side: int) -> bool:
        """Return whether the boundary counts as painted."""
        return self.painted[side] > SEEN_SHARE


def _at(points: Floats) -> Floats:
    ahead, last = [], -np.inf
    for x, y in points.tolist():
        if x > last:
            ahead.append((x, y))
            last = x
        elif last > 0.0:
            break
    along = np.array(ahead)
    return np.asarray(np.interp(X, along[:, 0], along[:, 1], right=np.inf))
