"""Objects and signals of road files become shapes of their kind, size and place."""

from __future__ import annotations

import math
from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np
import pytest

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.perception import roadside
from scenario_compiler.perception.labels import Tag
from scenario_compiler.perception.roadside import (
    GREEN_LAMP,
    LARGEST,
    MOST_PLACES,
    RED_LAMP,
    YELLOW_LAMP,
    Roadside,
    lit_lamps,
    roadside_of,
)
from scenario_compiler.roads.mesh import Paint
from scenario_compiler.roads.network import load_network
from tests.roads.make import network, road

Points = np.ndarray


def beside(folder: Path, *parts: str, length: float = 100.0) -> Roadside:
    objects = "".join(part for part in parts if part.startswith("<object"))
    signals = "".join(part for part in parts if part.startswith("<signal"))
    more = f"<objects>{objects}</objects><signals>{signals}</signals>"
    return roadside_of(network(folder, road(length=length, more=more)))


def attributes(words: dict[str, object]) -> str:
    return " ".join(f"{name}={quoteattr(str(value))}" for name, value in words.items())


def thing(kind: str, inside: str = "", **more: object) -> str:
    words: dict[str, object] = {"id": "1", "type": kind, "s": 50, "t": 8, "zOffset": 0, "hdg": 0, **more}
    return f"<object {attributes(words)}>{inside}</object>"


def extent(points: Points) -> tuple[float, ...]:
    """Return the size along x, y and z of the points (..., 3), to the centimetre."""
    flat = points.reshape(-1, 3)
    return tuple(round(float(one), 2) for one in np.ptp(flat, axis=0))


def outwards(made: Roadside) -> bool:
    """Whether all faces look away from the middle of them all."""
    quads = made.uprights.quads.astype(float)
    normals = np.cross(quads[:, 1] - quads[:, 0], quads[:, 3] - quads[:, 0])
    return bool((((quads.mean(axis=1) - quads.mean(axis=(0, 1))) * normals).sum(axis=1) > -1e-6).all())


@pytest.mark.parametrize(
    ("kind", "tag"),
    [
        ("building", Tag.BUILDING), ("pole", Tag.POLE), ("obstacle", Tag.STATIC), ("vegetation", Tag.VEGETATION),
        ("soundBarrier", Tag.WALL), ("barrier", Tag.GUARD_RAIL), ("railing", Tag.FENCE),
        ("trafficIsland", Tag.SIDEWALK), ("unheard-of", Tag.OTHER), ("", Tag.OTHER),
    ],
)  # fmt: skip
def test_a_box_has_the_size_of_the_file_and_the_tag_of_its_kind(kind: str, tag: Tag, tmp_path: Path) -> None:
    made = beside(tmp_path, thing(kind, length=6, width=2, height=3)).uprights
    walls = made.quads[np.abs(made.quads[:, :, 2] - made.quads[:, :1, 2]).max(axis=1) > 2.0]
    assert extent(walls) == (6.0, 2.0, 3.0)
    assert set(made.tag.tolist()) == {tag}
    assert set(made.instance.tolist()) == {-1}


def test_a_heading_turns_a_box_and_a_radius_makes_a_cylinder(tmp_path: Path) -> None:
    turned = beside(tmp_path, thing("obstacle", length=6, width=2, height=3, hdg=math.pi / 2))
    assert extent(turned.uprights.quads) == (2.0, 6.0, 3.0)
    round_one = beside(tmp_path, thing("obstacle", radius=2, height=3))
    assert extent(round_one.uprights.quads) == (4.0, 4.0, 3.0)
    assert len(round_one.uprights.quads) > 8
    assert outwards(turned)
    assert outwards(round_one)


def test_objects_with_neither_size_nor_a_known_kind_are_left_out(tmp_path: Path) -> None:
    assert len(beside(tmp_path, thing("-1"), thing("none"), thing("obstacle")).uprights.quads) == 0
    assert len(beside(tmp_path, thing("pole")).uprights.quads) > 0


def test_outlines_stand_where_their_corners_are(tmp_path: Path) -> None:
    """In the object's axes, or along the road; a corner that turns inwards stays one."""
    corners = ((0, 0), (8, 0), (8, 3), (3, 3), (3, 8), (0, 8))
    local = "".join(f'<cornerLocal id="{k}" u="{u}" v="{v}" z="0" height="4"/>' for k, (u, v) in enumerate(corners))
    of_road = "".join(f'<cornerRoad s="{50 + u}" t="{8 + v}" dz="0" height="4"/>' for u, v in corners)
    first, second = (
        beside(tmp_path, thing("obstacle", f"<outlines><outline>{one}</outline></outlines>")).uprights.quads
        for one in (local, of_road)
    )
    for quads in (first, second):
        assert extent(quads) == (8.0, 8.0, 4.0)
        roof = quads[(quads[:, :, 2] > 3.9).all(axis=1)].astype(float)
        area = sum(abs(np.cross(q[2] - q[0], q[3] - q[1])[2]) / 2.0 for q in roof)
        assert area == pytest.approx(8 * 3 + 3 * 5)
    assert np.allclose(np.sort(first.reshape(-1, 3), axis=0), np.sort(second.reshape(-1, 3), axis=0), atol=1e-4)


def test_a_repeated_object_stands_at_every_place_and_grows(tmp_path: Path) -> None:
    repeat = '<repeat s="10" length="40" distance="10" tStart="5" tEnd="9" heightStart="1" heightEnd="3"/>'
    quads = beside(tmp_path, thing("pole", repeat, length=0.2, width=0.2)).uprights.quads
    places = {
        round(float(quad[:, 0].mean())) for quad in quads if np.ptp(quad[:, 0]) < 0.01 or np.ptp(quad[:, 1]) < 0.01
    }
    assert places == {10, 20, 30, 40, 50}
    tops = [float(quads[np.abs(quads[:, :, 0].mean(axis=1) - x) < 0.5][:, :, 2].max()) for x in (10, 30, 50)]
    assert tops == pytest.approx([1.0, 2.0, 3.0])


def test_a_wall_without_gaps_follows_the_road_in_short_pieces(tmp_path: Path) -> None:
    repeat = (
        '<repeat s="10" length="60" distance="0" tStart="5" tEnd="5" zOffsetStart="0.3" zOffsetEnd="0.3" '
        'heightStart="0.5" heightEnd="0.5" widthStart="0.2" widthEnd="0.2"/>'
    )
    made = beside(tmp_path, thing("barrier", repeat))
    assert extent(made.uprights.quads) == (60.0, 0.2, 0.5)
    assert float(made.uprights.quads[..., 2].min()) == pytest.approx(0.3)
    assert np.ptp(made.uprights.quads[:, :, 0], axis=1).max() < 5.0
    assert outwards(made)


def test_a_tree_has_a_trunk_and_a_crown_of_crossing_faces_that_are_seen_from_both_sides(tmp_path: Path) -> None:
    made = beside(tmp_path, thing("tree", height=9)).uprights
    crown = made.quads[made.two_sided]
    assert float(made.quads[..., 2].max()) == pytest.approx(9.0)
    assert len(crown) == 4
    assert {extent(quad)[0] > 1.0 for quad in crown} == {True, False}
    assert set(made.tag.tolist()) == {Tag.VEGETATION}


def test_a_crosswalk_has_stripes_across_the_walking_direction(tmp_path: Path) -> None:
    marks = beside(tmp_path, thing("crosswalk", length=4, width=7, t=0)).marks
    sizes = {tuple(round(size, 1) for size in extent(quad)[:2]) for quad in marks.quads}
    assert len(marks.quads) == 7
    assert sizes == {(4.0, 0.5)}
    assert set(marks.colour.tolist()) == {Paint.WHITE}
    assert marks.quality.min() == 1.0


def test_markings_of_the_file_are_painted_as_they_are(tmp_path: Path) -> None:
    marking = (
        '<markings><marking side="front" color="yellow" width="0.3" lineLength="1" spaceLength="0.5" startOffset="0.5" '
        'stopOffset="0"/></markings>'
    )
    marks = beside(tmp_path, thing("parkingSpace", marking, length=5, width=6, t=0)).marks
    assert set(marks.colour.tolist()) == {Paint.YELLOW}
    assert [round(extent(quad)[1], 2) for quad in marks.quads] == [1.0, 1.0, 1.0, 1.0]
    assert extent(marks.quads[0])[0] == pytest.approx(0.3)
    corners = '<cornerLocal id="a" u="0" v="0" z="0" height="4"/><cornerLocal id="b" u="5" v="0" z="0" height="4"/>'
    solid = (
        '<markings><marking color="white" width="0.2" lineLength="9" spaceLength="0" startOffset="0" stopOffset="1">'
    )
    by_corners = f'{solid}<cornerReference id="a"/><cornerReference id="b"/></marking></markings>'
    line = beside(tmp_path, thing("parkingSpace", f"<outlines><outline>{corners}</outline></outlines>{by_corners}"))
    assert extent(line.marks.quads)[:2] == (4.0, 0.2)


def test_a_parking_space_without_markings_has_a_border(tmp_path: Path) -> None:
    made = beside(tmp_path, thing("parkingSpace", length=5, width=2.5))
    assert extent(made.marks.quads)[:2] == (5.12, 2.62)
    assert len(made.uprights.quads) == 0


def test_a_gantry_spans_the_road(tmp_path: Path) -> None:
    made = beside(tmp_path, thing("gantry", t=0, width=12, height=6)).uprights
    assert extent(made.quads)[1:] == (12.3, 6.0)
    near = made.quads[np.abs(made.quads[:, :, 1]).max(axis=1) < 5.0]
    assert (near[..., 2] > 5.0).all()


def signal(kind: str, **more: object) -> str:
    words: dict[str, object] = {
        "id": "9",
        "type": kind,
        "s": 40,
        "t": -5,
        "zOffset": 2,
        "orientation": "+",
        "dynamic": "no",
        **more,
    }
    return f"<signal {attributes(words)}/>"


def fronts(made: Roadside) -> Points:
    """Return the directions in which the coloured faces of a sign look."""
    quads = made.uprights.quads[made.uprights.tag == Tag.TRAFFIC_SIGN].astype(float)
    colours = made.uprights.colour[made.uprights.tag == Tag.TRAFFIC_SIGN]
    normals = np.cross(quads[:, 1] - quads[:, 0], quads[:, 3] - quads[:, 0])
    grey = np.ptp(colours, axis=1) < 8.0
    shown = normals[~grey | (colours.min(axis=1) > 165.0)]
    return np.asarray(shown / np.linalg.norm(shown, axis=1, keepdims=True))


@pytest.mark.parametrize("kind", ["274", "206", "205", "306", "101", "c"])
@pytest.mark.parametrize(("orientation", "offset", "ahead"), [
    ("+", 0.0, -1.0), ("-", 0.0, 1.0), ("+", -math.pi, -1.0), ("-", math.pi, 1.0), ("+", 0.3, -math.cos(0.3)),
])  # fmt: skip
def test_a_sign_faces_the_traffic_that_it_is_meant_for(
    kind: str, orientation: str, offset: float, ahead: float, tmp_path: Path
) -> None:
    """Also where a program counts its heading from the road's direction, as RoadRunner does for CARLA's towns."""
    made = beside(tmp_path, signal(kind, orientation=orientation, hOffset=offset, width=0.8, height=0.8))
    assert np.allclose(fronts(made)[:, 0], ahead, atol=1e-5)
    board = made.uprights.quads[made.uprights.tag == Tag.TRAFFIC_SIGN]
    assert extent(board)[2] == pytest.approx(0.8, abs=0.06)
    assert float(board[..., 2].min()) == pytest.approx(2.0, abs=0.06)


@pytest.mark.parametrize("kind", ["²", "٣", "9" * 5000])
def test_a_sign_whose_type_is_not_a_number_is_a_board(kind: str, tmp_path: Path) -> None:
    board, unknown = (beside(tmp_path, signal(one)).uprights for one in ("unknown", kind))
    assert np.array_equal(unknown.quads, board.quads)


def test_a_signal_stands_on_a_post_unless_it_hangs_over_the_road(tmp_path: Path) -> None:
    beside_it, over_it = (beside(tmp_path, signal("274", t=t, zOffset=z)).uprights for t, z in ((-5, 2), (-1.75, 5.5)))
    assert (beside_it.tag == Tag.POLE).any()
    assert not (over_it.tag == Tag.POLE).any()


def test_a_traffic_light_has_three_lamps_green_below(tmp_path: Path) -> None:
    made = beside(tmp_path, signal("1000001", dynamic="yes", zOffset=0)).uprights
    height = {lamp: float(made.quads[made.lamp == lamp][..., 2].mean()) for lamp in (GREEN_LAMP, YELLOW_LAMP, RED_LAMP)}
    assert 2.0 < height[GREEN_LAMP] < height[YELLOW_LAMP] < height[RED_LAMP]
    assert made.signals == {"9": (-1,)}


@pytest.mark.parametrize(
    ("state", "lamps"),
    [
        ("red", {RED_LAMP}), ("GREEN", {GREEN_LAMP}), ("red_yellow", {RED_LAMP, YELLOW_LAMP}),
        ("off;on;off", {YELLOW_LAMP}), ("on;off;on", {RED_LAMP, GREEN_LAMP}), ("off", set()), ("", set()),
        ("go", {GREEN_LAMP}),
    ],
)  # fmt: skip
def test_states_are_read_as_words_or_lamp_by_lamp(state: str, lamps: set[int]) -> None:
    assert lit_lamps(state) == lamps


def test_a_stop_line_is_paint(tmp_path: Path) -> None:
    made = beside(tmp_path, signal("294", t=-1.75, width=3.5))
    assert len(made.uprights.quads) == 0
    assert extent(made.marks.quads)[:2] == (0.5, 3.5)


def test_absurd_numbers_are_bounded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(roadside, "MOST_PLACES", MOST_PLACES // 20)
    dense = '<repeat s="0" length="100" distance="0.0001" tStart="5" tEnd="5"/>'
    huge = thing("building", length=1e7, width=1e9, height=1e12)
    made = beside(tmp_path, huge, *(thing("pole", dense, id=k, length=0.1, width=0.1) for k in range(8))).uprights
    assert MOST_PLACES // 20 < len(made.quads) < MOST_PLACES // 2
    assert np.ptp(made.quads.reshape(-1, 3), axis=0).max() <= 1.5 * LARGEST


def test_objects_off_their_road_are_left_out(tmp_path: Path) -> None:
    assert len(beside(tmp_path, thing("pole", s=500), signal("274", s=-3)).uprights.quads) == 0


@pytest.mark.slow
def test_all_road_files_of_the_corpus_have_shapes(corpus: Path) -> None:
    """Whatever stands in them; what cannot be loaded as a network is another test's matter."""
    count = 0
    for path in sorted(corpus.rglob("*.xodr")):
        made = load_network(path, sink=Diagnostics())
        if made is not None:
            shapes = roadside_of(made)
            assert np.isfinite(shapes.uprights.quads).all(), path
            assert np.isfinite(shapes.marks.quads).all(), path
            count += len(shapes.uprights.quads) > 0
    assert count > 50
