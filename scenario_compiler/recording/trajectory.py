"""Trajectories as CSV, for exchange with other programs."""

from __future__ import annotations

import csv
import io
import math
from itertools import pairwise
from pathlib import Path

import numpy as np

from scenario_compiler.files import read_file
from scenario_compiler.outputs import write_whole
from scenario_compiler.recording.cells import cell_text, text_cell
from scenario_compiler.recording.decimals import shortest_of
from scenario_compiler.recording.recording import Header, Recording, RecordingBuilder

TRAJECTORY_COLUMNS = ("t", "name", "x", "y", "h", "v", "road", "lane", "s", "off")

_NUMBERS = ("x", "y", "h", "v", "s", "off")


class TrajectoryError(ValueError):
    """The file does not contain trajectories."""


def write_trajectory(recording: Recording, path: Path) -> None:
    """Write one row per step for each entity that is present, in document order.

    Units: s, m, rad in [0, 2 pi), m/s; OpenDRIVE axes; off every road `road,lane,s,off` is `-1,0,0,0`. Numbers are the
    shortest decimals that read back to the same bits.
    """
    names = [_written(name) for name in recording.header.entities]
    roads = [_written(road) for road in (*recording.roads, "-1")]
    present = recording.present
    row, entity = np.nonzero(present)
    times = shortest_of(recording.t)
    x, y, h, v, s, off = (shortest_of(getattr(recording, name)[present]) for name in _NUMBERS)
    rows = zip(
        map(times.__getitem__, row.tolist()),
        map(names.__getitem__, entity.tolist()),
        x,
        y,
        h,
        v,
        map(roads.__getitem__, recording.road[present].tolist()),
        map(str, recording.lane[present].tolist()),
        s,
        off,
        strict=True,
    )
    write_whole(path, "\n".join((",".join(TRAJECTORY_COLUMNS), *map(",".join, rows), "")))


def _written(text: str) -> str:
    """Return a text as it stands in a CSV file, in quotes if it contains a comma, a quote or a line break."""
    cell = io.StringIO()
    csv.writer(cell, lineterminator="").writerow((text_cell(text), ""))
    return cell.getvalue()[:-1]


def read_trajectory(path: Path) -> Recording:
    """Read trajectories in the format of `write_trajectory`: a recording without plan and events.

    Raises:
        TrajectoryError: The file does not contain trajectories.
        OSError: It cannot be read.
    """
    rows: dict[float, dict[str, dict[str, str]]] = {}
    try:
        text = io.StringIO(read_file(path).decode(), newline="")
        for row in csv.DictReader(text, strict=True):
            if None in row.values():
                raise ValueError(f"the row of {row['t']} s is incomplete")
            row["road"] = cell_text(row["road"])
            rows.setdefault(_finite(row["t"]), {})[cell_text(row["name"])] = row
        return _recorded(path.stem, rows)
    except (csv.Error, KeyError, TypeError, ValueError, OverflowError) as problem:
        raise TrajectoryError(f"{path} does not contain trajectories: {_reason(problem)}") from problem


def _reason(problem: Exception) -> str:
    """Return what is wrong with a file, for its author."""
    if isinstance(problem, UnicodeDecodeError):
        return "it is not text in UTF-8"
    return f"it has no column {problem.args[0]}" if isinstance(problem, KeyError) else str(problem)


def _recorded(name: str, rows: dict[float, dict[str, dict[str, str]]]) -> Recording:
    entities = tuple(dict.fromkeys(entity for there in rows.values() for entity in there))
    if not entities:
        raise TrajectoryError("it has no row")
    times = sorted(rows)
    step = min((after - before for before, after in pairwise(times)), default=0.0)
    roads = tuple(
        dict.fromkeys(row["road"] for there in rows.values() for row in there.values() if row["road"] != "-1")
    )
    number = {road: index for index, road in enumerate(roads)} | {"-1": -1}
    header = Header(plan_digest="", plan_name=name, seed=0, step=step, entities=entities, perception="ideal")
    columns: dict[str, list[float]] = {at: [0.0] * len(entities) for at in (*_NUMBERS, "road", "lane", "present")}
    builder = RecordingBuilder(header, roads, columns)
    for t in times:
        columns["present"][:] = [entity in rows[t] for entity in entities]
        for i, entity in enumerate(entities):
            if entity in rows[t]:
                row = rows[t][entity]
                for at in _NUMBERS:
                    columns[at][i] = _finite(row[at])
                columns["road"][i], columns["lane"][i] = number[row["road"]], int(row["lane"])
        builder.append(t)
    return builder.finish("")


def _finite(text: str) -> float:
    number = float(text)
    if not math.isfinite(number):
        raise ValueError(f"{text} is not a finite number")
    return number
