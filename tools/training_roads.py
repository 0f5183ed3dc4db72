"""Roads for the training of a lane detector besides those of real maps: maps with repainted marks, and made-up roads.

    python tools/training_roads.py OUT [--files 20] [--streets 12] [--wide 12] [--avenues 24] [--crossings 20]
        [--motorways 20] [--first 9000] [--repaint MAPS]

writes files of made-up roads, `made_up_00.xodr` and so on, files of streets with bends as sharp as where one turns at a
junction, `streets_00.xodr` and so on, of such streets with wide lanes, `wide_00.xodr` and so on, files of level roads
with bends of medium radius, `avenues_00.xodr` and so on, files of main streets with crossings, `crossings_00.xodr` and
so on, and files of motorways with ramps, `motorways_00.xodr` and so on, to the folder OUT, and for each road file of
the folder MAPS a copy with other lines, such as `repainted_town_grid.xodr`. The confidence is fitted to them
(`fit_confidence`). `tools/train_lane_network.py` makes the files that it needs itself.

The marks of a map follow its author's habits: some maps have no double line, some no line at the edge. Here all kinds
of lines of OpenDRIVE are used, white and yellow, with common widths, dashes and gaps.
"""

from __future__ import annotations

import argparse
import math
from pathlib import Path
from typing import NamedTuple

import numpy as np
from lxml import etree

from scenario_compiler.perception.calibration.cross_fit import COPY

DASHES = ((3.0, 9.0), (6.0, 12.0), (3.0, 6.0), (4.0, 8.0), (1.0, 1.0), (2.0, 4.0), (1.5, 1.5), (9.0, 3.0))
WIDTHS = (0.1, 0.12, 0.125, 0.15, 0.2, 0.25, 0.3)

KINDS: dict[str, dict[str, float]] = {
    "centre": {
        "solid": 0.2, "broken": 0.22, "solid solid": 0.2, "solid broken": 0.12, "broken solid": 0.12,
        "broken broken": 0.04, "none": 0.1,
    },
    "between": {
        "solid": 0.13, "broken": 0.62, "solid solid": 0.03, "solid broken": 0.05, "broken solid": 0.05,
        "broken broken": 0.02, "none": 0.1,
    },
    "edge": {"solid": 0.62, "broken": 0.13, "solid solid": 0.02, "none": 0.23},
}  # fmt: skip
"""Relative frequency of each kind of line in the middle of a road, between its lanes and at its edges."""

DRIVEN = ("driving", "bidirectional", "exit", "entry", "onRamp", "offRamp")
"""Types of lanes whose borders are painted."""

BESIDE = {
    "shoulder": (0.4, 3.0), "curb": (0.15, 0.3), "sidewalk": (1.0, 3.0), "parking": (2.0, 2.6), "biking": (1.2, 2.2),
}  # fmt: skip
"""Least and greatest width of the lanes beside the driving lanes by type, m."""

REPAINTED = 5000
"""Seed of the lines in the copy of a folder's first road file."""

STREETS, AVENUES, CROSSED, WIDE_STREETS = 1000, 2000, 3000, 4000
"""What is added to the seed of the first made-up file for that of the first file of streets, and of avenues, for that
of the first file's lines of crossings, and for that of the first file of streets with wide lanes.
"""

ROADS, LENGTH = 4, 500.0
"""Number of roads in a made-up file, and the least length of each, m."""


class Kind(NamedTuple):
    """A kind of made-up roads.

    Attributes:
        right: Numbers of driving lanes on the right, of which one is drawn.
        left: The same on the left; a number that occurs twice is drawn twice as often.
        radius: Least and greatest radius of a bend of the reference line, m, drawn on a logarithmic scale.
        angle: Least and greatest angle of a bend, rad.
        straight: Least and greatest length of the straight before it, m.
        level: Share of the roads without hills.
        width: Least and greatest width of the driving lanes of a road, m, from which each differs by up to 0.2 m.
    """

    right: tuple[int, ...]
    left: tuple[int, ...]
    radius: tuple[float, float]
    angle: tuple[float, float]
    straight: tuple[float, float]
    level: float = 0.35
    width: tuple[float, float] = (2.7, 4.0)


COUNTRY = Kind((1, 2, 3), (0, 1, 1, 2, 3), (16.0, 400.0), (0.25, 1.7), (5.0, 80.0))
TOWN = Kind((1,), (0, 1), (10.0, 40.0), (0.4, 1.5), (4.0, 40.0))
WIDE = Kind((1,), (0, 1), (14.0, 60.0), (0.4, 1.5), (4.0, 40.0), width=(4.0, 7.0))
AVENUE = Kind((1, 2, 3, 4), (0, 1, 2, 2, 3, 4), (50.0, 250.0), (0.15, 1.6), (5.0, 60.0), level=0.9)
"""Winding roads; streets with usual lanes and sharp bends, which are rare in road files: a lane that bends so sharply
there is often a wide one; such streets with wide lanes, so that a wide lane is not only that of a junction; and level
roads with bends of medium radius.
"""


def repainted(source: Path, target: Path, seed: int) -> None:
    """Write a copy of a road file in which the driving lanes have other lines; all else is unchanged."""
    tree = etree.parse(str(source))
    draw = np.random.default_rng(seed)
    added = draw.uniform(0.0, 0.9)
    for road in tree.iterfind("road"):
        inside = road.get("junction", "-1") != "-1"
        kept = inside and draw.random() < 0.6
        styles = _Styles(draw)
        for section in road.iterfind("lanes/laneSection"):
            lanes = {int(lane.attrib["id"]): lane for lane in section.iter("lane")}
            for number, lane in lanes.items():
                where = _where(lanes, number)
                if where is None:
                    continue
                for mark in lane.findall("roadMark"):
                    bare = mark.get("type") in ("none", "curb", "grass")
                    if kept or (bare and draw.random() > (0.15 if inside else added)):
                        continue
                    _replace(mark, styles.line(where, number))
    tree.write(str(target), encoding="utf-8", xml_declaration=True)


def made_up(target: Path, seed: int, kind: Kind = COUNTRY) -> None:
    """Write a road file with `ROADS` hilly roads of a kind."""
    draw = np.random.default_rng(seed)
    drive = etree.Element("OpenDRIVE")
    etree.SubElement(drive, "header", revMajor="1", revMinor="6", name=target.stem)
    for number in range(ROADS):
        drive.append(_road(draw, number, kind))
    target.write_bytes(etree.tostring(drive, xml_declaration=True, encoding="utf-8"))


class _Styles:
    """The lines of one road; each is drawn at random when it is first asked for."""

    def __init__(self, draw: np.random.Generator) -> None:
        self._draw = draw
        self._lines: dict[tuple[str, int], etree._Element] = {}
        self._middle = "yellow" if draw.random() < 0.5 else "white"

    def line(self, where: str, number: int) -> etree._Element:
        """Return the mark of a lane's outer border.

        Args:
            where: Place of the border, a key of `KINDS`.
            number: OpenDRIVE lane id.
        """
        key = (where, number if self._draw.random() < 0.3 else 0)
        if key not in self._lines:
            self._lines[key] = self._drawn(where)
        return self._lines[key]

    def _drawn(self, where: str) -> etree._Element:
        draw, shares = self._draw, KINDS[where]
        kind = str(draw.choice(list(shares), p=np.array(list(shares.values())) / sum(shares.values())))
        colour = self._middle if where == "centre" or draw.random() < 0.15 else "white"
        width = float(draw.choice(WIDTHS))
        mark = etree.Element("roadMark", type=kind, color=colour, weight="standard", width=str(width))
        if kind == "none":
            return mark
        parts = kind.split()
        apart = float(draw.uniform(0.2, 0.45)) if len(parts) == 2 else 0.0
        if len(parts) == 2:
            width = min(width, 0.15)
        dash, gap = DASHES[int(draw.integers(len(DASHES)))]
        lines = etree.SubElement(mark, "type", name=kind, width=str(width))
        for part, side in zip(parts, (0.5, -0.5) if len(parts) == 2 else (0.0,), strict=True):
            broken = part == "broken"
            etree.SubElement(
                lines, "line", length=str(dash if broken else 100.0), space=str(gap if broken else 0.0),
                tOffset=f"{apart * side:.4f}", sOffset=f"{draw.uniform(0.0, dash + gap) if broken else 0.0:.3f}",
                width=str(width),
            )  # fmt: skip
        return mark


def _where(lanes: dict[int, etree._Element], number: int) -> str | None:
    """Return the place of a lane's outer border, a key of `KINDS`; None if no driving lane is on either side."""

    def driven(k: int) -> bool:
        return k in lanes and lanes[k].get("type") in DRIVEN

    if number == 0:
        return "centre" if driven(1) and driven(-1) else "edge" if driven(1) or driven(-1) else None
    outer = number + (1 if number > 0 else -1)
    if not driven(number):
        return "edge" if driven(outer) else None
    return "between" if driven(outer) else "edge"


def _replace(mark: etree._Element, line: etree._Element) -> None:
    """Replace the attributes and children of a mark by those of a line; its sOffset is kept."""
    begin = mark.get("sOffset", "0")
    mark.attrib.clear()
    for child in list(mark):
        mark.remove(child)
    mark.attrib.update({"sOffset": begin, **{str(k): str(v) for k, v in line.attrib.items()}})
    for child in line:
        mark.append(etree.fromstring(etree.tostring(child)))


def _road(draw: np.random.Generator, number: int, kind: Kind) -> etree._Element:
    plan, length = _plan(draw, (0.0, 4000.0 * number), kind)
    road = etree.Element("road", name=f"road {number}", length=f"{length:.6f}", id=str(number), junction="-1")
    road.append(plan)
    road.append(_elevation(draw, length, kind.level))
    section = etree.SubElement(etree.SubElement(road, "lanes"), "laneSection", s="0")
    styles = _Styles(draw)
    right, left = int(draw.choice(kind.right)), int(draw.choice(kind.left))
    widths = float(draw.uniform(*kind.width))
    between = ["bidirectional"] if left and draw.random() < 0.2 else []
    sides = {
        "left": [*between, *["driving"] * left, *_beside(draw)],
        "center": ["none"],
        "right": [*["driving"] * right, *_beside(draw)],
    }
    numbers = {"left": range(1, 20), "center": range(1), "right": range(-1, -20, -1)}
    made = {
        number: etree.Element("lane", id=str(number), type=kind, level="false")
        for side, kinds in sides.items()
        for number, kind in zip(numbers[side], kinds, strict=False)
    }
    for side in sides:
        found = sorted(set(numbers[side]) & set(made), reverse=True)
        if not found:
            continue
        group = etree.SubElement(section, side)
        for k in found:
            lane = made[k]
            group.append(lane)
            use = str(lane.get("type"))
            if k:
                low, high = (widths - 0.2, widths + 0.2) if use in DRIVEN else BESIDE[use]
                width = f"{draw.uniform(low, high):.3f}"
                etree.SubElement(lane, "width", sOffset="0", a=width, b="0", c="0", d="0")
            where = _where(made, k)
            mark = etree.SubElement(lane, "roadMark", sOffset="0", type="none", color="standard")
            if where is not None:
                _replace(mark, styles.line(where, k))
            if use in ("sidewalk", "curb"):
                etree.SubElement(lane, "height", sOffset="0", inner="0.12", outer="0.12")
    return road


def _beside(draw: np.random.Generator) -> list[str]:
    """Return the types of the lanes between the outermost driving lane and the verge, from the inside outwards."""
    choices: tuple[list[str], ...] = (
        [],
        [],
        ["shoulder"],
        ["shoulder"],
        ["curb", "sidewalk"],
        ["parking", "curb", "sidewalk"],
        ["biking"],
    )
    return list(choices[int(draw.integers(len(choices)))])


def _plan(draw: np.random.Generator, start: tuple[float, float], kind: Kind) -> tuple[etree._Element, float]:
    """Return a planView of straights and bends from a start (x, y), and its length, m.

    The bends have clothoids, and the road never turns back.
    """
    plan = etree.Element("planView")
    (x, y), heading, s = start, 0.0, 0.0
    while s < LENGTH:
        side = float(draw.choice([-1.0, 1.0])) if abs(heading) < 0.3 else -math.copysign(1.0, heading)
        angle = side * float(draw.uniform(*kind.angle))
        radius = math.exp(float(draw.uniform(*np.log(kind.radius))))
        turn = math.copysign(1.0 / radius, angle)
        spiral = min(float(draw.uniform(0.2, 1.0)) * radius, 0.8 * abs(angle) * radius, 60.0)
        arc = abs(angle) * radius - spiral
        straight = float(draw.uniform(*kind.straight))
        for length, first, last in ((straight, 0.0, 0.0), (spiral, 0.0, turn), (arc, turn, turn), (spiral, turn, 0.0)):
            piece = etree.SubElement(
                plan, "geometry", s=f"{s:.6f}", x=f"{x:.6f}", y=f"{y:.6f}", hdg=f"{heading:.9f}", length=f"{length:.6f}"
            )
            if first == last == 0.0:
                etree.SubElement(piece, "line")
            elif first == last:
                etree.SubElement(piece, "arc", curvature=f"{first:.9f}")
            else:
                etree.SubElement(piece, "spiral", curvStart=f"{first:.9f}", curvEnd=f"{last:.9f}")
            u = np.linspace(0.0, length, 401)
            bearing = heading + first * u + (last - first) * u * u / (2.0 * length)
            x += float(np.trapezoid(np.cos(bearing), u))
            y += float(np.trapezoid(np.sin(bearing), u))
            heading, s = float(bearing[-1]), s + length
    return plan, s


def _elevation(draw: np.random.Generator, length: float, level: float) -> etree._Element:
    """Return the elevation profile: cubics with grades of up to 6 %; `level` is the probability of a level road."""
    profile = etree.Element("elevationProfile")
    steepest = 0.0 if draw.random() < level else 0.06
    s, z, grade = 0.0, 0.0, 0.0
    while s < length:
        span = float(draw.uniform(50.0, 140.0))
        mean, end = float(draw.uniform(-0.7, 0.7)) * steepest, float(draw.uniform(-1.0, 1.0)) * steepest
        rise = mean * span
        c = (3.0 * rise - (2.0 * grade + end) * span) / span**2
        d = ((grade + end) * span - 2.0 * rise) / span**3
        etree.SubElement(
            profile, "elevation", s=f"{s:.6f}", a=f"{z:.6f}", b=f"{grade:.8f}", c=f"{c:.10f}", d=f"{d:.12f}"
        )
        s, z, grade = s + span, z + rise, end
    return profile


def main() -> None:
    """Write the files of made-up roads and the repainted copies."""
    from training_crossings import crossings  # needs the extra `maps`, which the other users of this module do not
    from training_motorways import motorway  # needs it too

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path)
    parser.add_argument("--files", type=int, default=20, help="number of files of winding roads")
    parser.add_argument("--streets", type=int, default=12, help="number of files of streets")
    parser.add_argument("--wide", type=int, default=12, help="number of files of streets with wide lanes")
    parser.add_argument("--avenues", type=int, default=24, help="number of files of level roads with medium bends")
    parser.add_argument("--crossings", type=int, default=20, help="number of files of main streets with crossings")
    parser.add_argument("--motorways", type=int, default=20, help="number of files of motorways with ramps")
    parser.add_argument("--first", type=int, default=9000, help="seed of the first file")
    parser.add_argument("--repaint", type=Path, metavar="MAPS", help="folder with road files to repaint")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    for name, count, first, kind in (
        ("made_up", options.files, options.first, COUNTRY),
        ("streets", options.streets, options.first + STREETS, TOWN),
        ("wide", options.wide, options.first + WIDE_STREETS, WIDE),
        ("avenues", options.avenues, options.first + AVENUES, AVENUE),
    ):
        for number in range(count):
            made_up(options.out / f"{name}_{number:02d}.xodr", first + number, kind)
    for number in range(options.crossings):
        file = options.out / f"crossings_{number:02d}.xodr"
        crossings(file, options.first + number)
        repainted(file, file, options.first + CROSSED + number)
    for number in range(options.motorways):
        motorway(options.out / f"motorways_{number:02d}.xodr", options.first + number)
    for seed, file in enumerate(sorted(options.repaint.glob("*.xodr")) if options.repaint else [], REPAINTED):
        repainted(file, options.out / f"{COPY}{file.stem}.xodr", seed)


if __name__ == "__main__":
    main()
