"""The trajectories as CSV, for other programs."""

from __future__ import annotations

import csv
from pathlib import Path

from scenario_compiler.recording.decimals import shortest
from scenario_compiler.recording.recording import Recording

TRAJECTORY_COLUMNS = ("t", "name", "x", "y", "h", "v", "road", "lane", "s", "off")


def write_trajectory(recording: Recording, path: Path) -> None:
    """Write one row an entity present and step, entities in document order.

    Units: s, m, rad in [0, 2 pi), m/s; OpenDRIVE axes; off every road `road,lane,s,off` is `-1,0,0,0`. Numbers
    are the shortest decimals that read back to the same bits.
    """
    names, roads = recording.header.entities, (*recording.roads, "-1")
    numbers = ("x", "y", "h", "v", "s", "off")
    columns = {name: getattr(recording, name).tolist() for name in (*numbers, "road", "lane", "present")}
    with path.open("w", encoding="utf-8", newline="") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(TRAJECTORY_COLUMNS)
        for k, t in enumerate(recording.t.tolist()):
            for i, name in enumerate(names):
                if columns["present"][k][i]:
                    x, y, h, v, s, off = (shortest(columns[number][k][i]) for number in numbers)
                    road, lane = roads[columns["road"][k][i]], columns["lane"][k][i]
                    rows.writerow((shortest(t), name, x, y, h, v, road, lane, s, off))
