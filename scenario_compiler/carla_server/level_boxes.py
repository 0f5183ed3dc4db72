"""Boxes about the things beside a map's roads, as cameras draw them: signs, lights, poles, buildings, trees.

A thing has one box for each semantic tag of its faces, such as one for a sign's board and one for its post. In CARLA,
these are the boxes of an actor's meshes (`UBoundingBoxCalculator::GetBBsOfActor` of 0.9.16).
"""

from __future__ import annotations

import math
from collections import defaultdict
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenario_compiler.frames import vector_from_carla
from scenario_compiler.perception.labels import Tag
from scenario_compiler.perception.roadside import roadside_of
from scenario_compiler.roads import Network

NO_ACTOR = 0
"""Id of the actor in the box of a thing that is not an actor."""


class LevelBoxes:
    """The boxes of a map.

    Attributes:
        by_tag: Middle, half extents and rotation of the boxes about the faces with a semantic tag, CARLA's axes.
        of_lights: The boxes about the traffic lights with an id in the road file.
    """

    def __init__(self, network: Network) -> None:
        """Put a box about each thing."""
        uprights = roadside_of(network).uprights
        faces: dict[tuple[int, int], list[int]] = defaultdict(list)
        for face, key in enumerate(zip(uprights.tag.tolist(), uprights.instance.tolist(), strict=True)):
            faces[key].append(face)
        boxes = {key: _about(uprights.quads[ones] + uprights.origin) for key, ones in faces.items()}
        self.by_tag: dict[int, list[list[Any]]] = defaultdict(list)
        for (tag, _), box in boxes.items():
            self.by_tag[tag].append(box)
        lights = {number: box for (tag, number), box in boxes.items() if tag == Tag.TRAFFIC_LIGHT}
        self.of_lights = {
            signal: [lights[number] for number in numbers if number in lights]
            for signal, numbers in uprights.signals.items()
        }


def _about(quads: NDArray[np.float64]) -> list[Any]:
    """Return the box about faces, (N, 4, 3), that is turned like their longest level edge."""
    edges = (np.roll(quads, -1, axis=1) - quads)[..., :2].reshape(-1, 2)
    ahead = edges[np.argmax((edges * edges).sum(axis=1))]
    heading = math.atan2(ahead[1], ahead[0])
    c, s = math.cos(heading), math.sin(heading)
    turned = quads.reshape(-1, 3) @ np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    low, high = turned.min(axis=0), turned.max(axis=0)
    x, y, z = 0.5 * (low + high)
    middle = vector_from_carla(x * c - y * s, x * s + y * c, z)
    return [list(middle), (0.5 * (high - low)).tolist(), [0.0, -math.degrees(heading), 0.0]]
