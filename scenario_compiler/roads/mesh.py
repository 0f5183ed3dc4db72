"""The network as quads: road surfaces by material and painted marks, for the camera, for plots and for mesh export."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray


class Material(IntEnum):
    """What a piece of ground is made of."""

    VERGE = 0
    ASPHALT = 1
    SHOULDER = 2
    CONCRETE = 3
    GRASS = 4
    CYCLE = 5


class Paint(IntEnum):
    """Colour of a mark."""

    WHITE = 0
    YELLOW = 1
    BLUE = 2
    GREEN = 3
    RED = 4
    ORANGE = 5
    VIOLET = 6
    BLACK = 7


@dataclass(frozen=True, eq=False)
class Surface:
    """Pieces of lanes, and of the verge beside them. N pieces.

    Attributes:
        quads: (N, 4, 3) float32, world, m: left and right are as seen along increasing s; corners are left start, left
            end, right end, right start.
        material: (N,) uint8, a `Material`.
        layer: (N,) uint8, what is laid on what where pieces overlap: larger lies on top.
        road: (N,) int32 index of the road.
        lane: (N,) int32 id of the lane, 0 for the verge.
        s: (N, 2) float32 start and end, m.
    """

    quads: NDArray[np.float32]
    material: NDArray[np.uint8]
    layer: NDArray[np.uint8]
    road: NDArray[np.int32]
    lane: NDArray[np.int32]
    s: NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class Marks:
    """Painted pieces. M pieces.

    Attributes:
        quads: (M, 4, 3) float32, corners as in `Surface`.
        colour: (M,) uint8, a `Paint`.
        quality: (M,) float32 share of the paint that is left, 1 new, 0 gone.
        width: (M,) float32, m.
        road: (M,) int32 index of the road.
        lane: (M,) int32 id of the lane whose outer border the mark lies on; 0 for the centre mark.
        s: (M, 2) float32 start and end, m.
    """

    quads: NDArray[np.float32]
    colour: NDArray[np.uint8]
    quality: NDArray[np.float32]
    width: NDArray[np.float32]
    road: NDArray[np.int32]
    lane: NDArray[np.int32]
    s: NDArray[np.float32]


def road_surface(network: object, step: float = 2.0) -> Surface:
    """Stub."""
    raise NotImplementedError


def road_marks(network: object) -> Marks:
    """Stub."""
    raise NotImplementedError
