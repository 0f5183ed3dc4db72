"""The pictures of the secondary task: circles at random places, one of them larger."""

from __future__ import annotations

import math
from dataclasses import dataclass

from scenario_compiler.randomness import hash_bits, uniform
from scenario_compiler.source.study import SearchTask

WIDTH, HEIGHT = 300.0, 100.0
"""Size of the picture, in a unit of its own."""


@dataclass(frozen=True)
class SearchPicture:
    """A picture.

    Attributes:
        number: Its number in the run, from 0.
        circles: x, y and radius of each circle.
        target: Index of the larger one.
    """

    number: int
    circles: tuple[tuple[float, float, float], ...]
    target: int


def search_picture(task: SearchTask, seed: int, number: int) -> SearchPicture:
    """Return a picture of a run; it depends only on the run's seed and its own number.

    The circles are in the cells of a grid, at random offsets, so that none touches another.
    """
    columns = math.ceil(math.sqrt(task.items * WIDTH / HEIGHT))
    rows = math.ceil(task.items / columns)
    wide, high = WIDTH / columns, HEIGHT / rows
    radius = 0.42 * min(wide, high) / task.ratio
    cells = sorted(range(columns * rows), key=lambda cell: hash_bits(seed, number, f"search/cell/{cell}"))
    target = hash_bits(seed, number, "search/target") % task.items
    circles = []
    for k, cell in enumerate(cells[: task.items]):
        size = radius * task.ratio if k == target else radius
        places = []
        for axis, (index, step) in enumerate(((cell % columns, wide), (cell // columns, high))):
            free = 0.5 * step - size
            places.append((index + 0.5) * step + free * (2 * uniform(seed, number, f"search/{axis}/{k}") - 1))
        circles.append((round(places[0], 2), round(places[1], 2), round(size, 2)))
    return SearchPicture(number, tuple(circles), target)
