"""Finds the lanes of one point or of many, in the available form of the marked functions."""

from __future__ import annotations

from array import array
from itertools import pairwise
from typing import TYPE_CHECKING

from scenario_compiler.forms.form import form_of
from scenario_compiler.roads.tables import RoadTables

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

ROOM = 4
"""Initial room for lanes of each point."""


class Locator:
    """Locates points on the lanes of one network."""

    def __init__(self, tables: RoadTables) -> None:
        """Prepare the tables for the available form."""
        self._form = form_of("scenario_compiler.roads.entries", n=tables)
        cells = tables.in_arrays().cell_chunk
        most = max((after - before for before, after in pairwise(cells)), default=0)
        self._near = most + len(tables.in_arrays().wide_chunk)
        self._empty = bytes(8 * self._near)

    def one(self, x: float, y: float) -> list[tuple[int, float, float]]:
        """Return (lane row, s, offset) of every lane that contains a point, the nearest centre first."""
        kinds, rows = array("q", self._empty), array("q", self._empty)
        ss, offsets = array("d", self._empty), array("d", self._empty)
        end = self._form.enter("locate_point", x, y, kinds, rows, ss, offsets, 0)
        return list(zip(rows[:end], ss[:end], offsets[:end], strict=True))

    def many(
        self, xs: NDArray[np.float64], ys: NDArray[np.float64]
    ) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64], NDArray[np.float64]]:
        """Return (row starts by point, lane rows, s, offsets) of every lane that contains some of the points."""
        import numpy as np

        xs, ys = np.array(xs, np.float64, ndmin=1), np.array(ys, np.float64, ndmin=1)
        starts = np.zeros(len(xs) + 1, np.int64)
        room = ROOM * len(xs) + self._near
        while True:
            kinds, rows = np.empty(room, np.int64), np.empty(room, np.int64)
            ss, offsets = np.empty(room), np.empty(room)
            if self._form.enter("locate_points", xs, ys, starts, kinds, rows, ss, offsets) == 1:
                end = int(starts[-1])
                return starts, rows[:end].copy(), ss[:end].copy(), offsets[:end].copy()
            room *= 2
