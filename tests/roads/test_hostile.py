"""Hostile input gets a diagnostic, with bounded work and memory."""

from __future__ import annotations

import tracemalloc
from pathlib import Path

import pytest

from scenario_compiler.diagnostics import CompileError, Diagnostics
from scenario_compiler.roads import LanePosition, Network, load_network
from scenario_compiler.roads.travel import HOP_LIMIT, advance, distance_to_lane_end
from tests.roads.make import lane, network, road, section
from tests.work import counted

ENTITY = '<!DOCTYPE x [<!ENTITY a "{}">]><OpenDRIVE>&a;</OpenDRIVE>'
MOST_LINES = 40_000_000
"""Lines of Python that may be run to read one file: 14 million for the longest roads, some thousands for most."""


def load(folder: Path, text: str) -> tuple[Network | None, set[str]]:
    path = folder / "hostile.xodr"
    path.write_text(text, encoding="utf-8")
    sink = Diagnostics()
    made, lines = counted(lambda: load_network(path, cache=False, sink=sink))
    assert lines < MOST_LINES
    return made, {d.code.id for d in sink}


def whole(*roads: str) -> str:
    return "<OpenDRIVE>" + "".join(roads) + "</OpenDRIVE>"


@pytest.mark.parametrize(
    ("text", "code"),
    [
        (ENTITY.format("b"), "SC103"),
        ('<!DOCTYPE x [<!ENTITY a SYSTEM "file:///etc/passwd">]><OpenDRIVE>&a;</OpenDRIVE>', "SC103"),
        ("<OpenDRIVE " + " ".join(f'a{i}="1"' for i in range(40_000)) + "/>", "SC103"),
        ("<OpenDRIVE><road>", "SC102"),
        ("<roads/>", "SC301"),
        (whole(), "SC301"),
        (whole(road(length=0.0)), "SC303"),
        (whole("<road/>"), "SC303"),
    ],
)
def test_unreadable_files_are_errors(tmp_path: Path, text: str, code: str) -> None:
    made, codes = load(tmp_path, text)
    assert made is None
    assert code in codes
    with pytest.raises(CompileError):
        load_network(tmp_path / "hostile.xodr", cache=False)


def test_a_missing_file_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(CompileError, match="SC101"):
        load_network(tmp_path / "none.xodr")


@pytest.mark.parametrize(
    ("length", "said"),
    [
        ("1e300", "length is 1e+300, beyond the limit of 1e+07; the road is left out"),
        ("nan", "length is nan, not a finite number; the road is left out"),
        ("long", "length is 'long', not a number; the road is left out"),
        ("-3", "the road's length is not positive; it is left out"),
    ],
)
def test_a_road_without_a_usable_length_is_left_out_with_the_reason(tmp_path: Path, length: str, said: str) -> None:
    path = tmp_path / "hostile.xodr"
    path.write_text(whole(road().replace('length="100.0"', f'length="{length}"', 1), road("2")), encoding="utf-8")
    sink = Diagnostics()
    assert load_network(path, cache=False, sink=sink) is not None
    assert [one.message for one in sink] == [said]


@pytest.mark.parametrize("number", ["NaN", "inf", "-inf", "1e300", "1e400", "x", ""])
def test_invalid_numbers_are_replaced(tmp_path: Path, number: str) -> None:
    good = road()
    for old in ('x="0"', 'hdg="0"', 'a="3.5"', 'sOffset="0"', 'length="100.0"', 's="0"'):
        name = old.split("=")[0]
        made, codes = load(tmp_path, whole(good.replace(old, f'{name}="{number}"'), road("2")))
        assert made is not None
        assert codes & {"SC303", "SC305"}
        for place in made.locate(10.0, 1.0):
            made.lane_pose(place.road, place.lane, place.s)
        made.locate_many([10.0], [1.0])


def test_extreme_but_finite_numbers_do_no_harm(tmp_path: Path) -> None:
    wild = '<width sOffset="0" a="1e11" b="-1e11" c="1e11" d="-1e11"/>'
    spiral = (
        '<geometry s="0" x="1e11" y="-1e11" hdg="1e11" length="2e5"><spiral curvStart="-1e6" curvEnd="1e6"/></geometry>'
    )
    made, codes = load(tmp_path, whole(road(length=2e5, plan=spiral, lanes=section(lane(1, wild), lane(-1)))))
    assert made is not None
    assert "SC309" in codes
    made.lane_pose("1", 1, 1e5)
    made.locate(0.0, 0.0, nearest=True)


def test_very_many_faults_are_cut_short(tmp_path: Path) -> None:
    widths = '<width sOffset="0" a="x" b="0" c="0" d="0"/>' * 5000
    path = tmp_path / "made.xodr"
    path.write_text(whole(road(lanes=section(lane(1, widths), lane(-1)))), encoding="utf-8")
    sink = Diagnostics()
    load_network(path, cache=False, sink=sink)
    assert len(sink.found) < 200
    assert "SC307" in {one.code.id for one in sink}


def test_a_billion_repeats_are_reported_and_bounded(tmp_path: Path) -> None:
    thing = (
        '<objects><object id="1" type="pole" s="0" t="0"><repeat s="0" length="1e6" distance="0.001" tStart="1" '
        'tEnd="3" zOffsetStart="0" zOffsetEnd="0"/></object></objects>'
    )
    made, codes = load(tmp_path, whole(road(more=thing)))
    assert made is not None
    assert codes == {"SC314"}
    repeat = made.model().objects[0].repeats[0]
    assert repeat.count() == 1_000_000_001
    assert len(list(repeat.places())) == 10_000


def test_a_wrong_repeat_is_reported_in_a_file_without_a_usable_road(tmp_path: Path) -> None:
    thing = '<objects><object id="1" s="0" t="0"><repeat s="x" length="1" distance="1"/></object></objects>'
    made, codes = load(tmp_path, whole(road(length=0.0, more=thing)))
    assert made is None
    assert codes == {"SC301", "SC303", "SC305"}


def test_very_long_roads_have_bounded_tables(tmp_path: Path) -> None:
    made, _ = load(tmp_path, whole(*(road(str(i), length=1e7) for i in range(4))))
    assert made is not None
    assert len(made.tables.chunk_s) < 200_000


@pytest.mark.parametrize("shape", ['<arc curvature="1e6"/>', '<spiral curvStart="-1e6" curvEnd="1e6"/>'])
def test_very_many_tight_curves_have_bounded_tables(tmp_path: Path, shape: str) -> None:
    plan = "".join(f'<geometry s="{i}" x="0" y="0" hdg="0" length="1">{shape}</geometry>' for i in range(1500))
    path = tmp_path / "hostile.xodr"
    path.write_text(whole(road(length=1500.0, plan=plan)), encoding="utf-8")
    made = load_network(path, cache=False, sink=Diagnostics())
    assert made is not None
    assert len(made.tables.piece_s) < 300_000
    assert len(made.tables.chunk_s) < 600_000


def test_a_spiral_too_short_for_its_curvatures_is_read(tmp_path: Path) -> None:
    plan = (
        '<geometry s="0" x="0" y="0" hdg="0" length="1e-320"><spiral curvStart="0.5" curvEnd="1"/></geometry>'
        '<geometry s="0" x="0" y="0" hdg="0" length="10"><line/></geometry>'
    )
    made, codes = load(tmp_path, whole(road(length=10.0, plan=plan)))
    assert made is not None
    assert codes == set()
    assert made.road_pose("1", 10.0, 0.0).x == pytest.approx(10.0)


@pytest.mark.parametrize("contact", ["", 'contactPoint="start"'])
@pytest.mark.parametrize(("length", "curvature", "whole_length"), [("1e-300", 1.0, 1e7), ("1e-320", 1e-12, 10.0)])
def test_a_short_spiral_at_the_end_of_a_long_road_is_read(
    tmp_path: Path, length: str, curvature: float, whole_length: float, contact: str
) -> None:
    shape = f'<spiral curvStart="{curvature}" curvEnd="0"/>'
    plan = f'<geometry s="0" x="0" y="0" hdg="0" length="{length}">{shape}</geometry>'
    link = f'<successor elementType="road" elementId="1" {contact}/>'
    made, codes = load(tmp_path, whole(road(length=whole_length, plan=plan, link=link)))
    assert made is not None
    assert codes == set()
    assert made.tables.piece_k == [curvature]


def test_links_in_a_circle_end(tmp_path: Path) -> None:
    around = (
        '<predecessor elementType="road" elementId="1" contactPoint="end"/>'
        '<successor elementType="road" elementId="1" contactPoint="start"/>'
    )
    made = network(tmp_path, road(length=0.001, link=around))
    n = made.tables
    *_, left = advance(n, 0, -1, 0.0, 1e6, -1)
    assert left > 1e6 - 2e-3 * HOP_LIMIT
    assert distance_to_lane_end(n, 0, -1, 0.0, 1e6, -1) < 2e-3 * HOP_LIMIT
    assert made.route(LanePosition("1", -1, 0.0005), LanePosition("1", -1, 0.0001)) is not None


def test_a_connection_that_is_repeated_is_kept_once(tmp_path: Path) -> None:
    """A connection without lanes joins all lanes of its roads; the memory would be that of a million links."""
    many = section("", "".join(lane(-k, inside="") for k in range(1, 1001)))
    first = road("1", lanes=many, link='<successor elementType="junction" elementId="9"/>')
    connection = '<connection incomingRoad="1" connectingRoad="2" contactPoint="start"/>'
    path = tmp_path / "hostile.xodr"
    path.write_text(whole(first, road("2", lanes=many), f'<junction id="9">{connection * 1000}</junction>'))
    tracemalloc.start()
    made = load_network(path, cache=False, sink=Diagnostics())
    _, most = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert made is not None
    assert len(made.tables.link_lane) == 2 * 1000
    assert most < 20e6


def test_a_road_may_link_to_itself_and_to_junctions_that_are_not_there(tmp_path: Path) -> None:
    link = '<predecessor elementType="junction" elementId="9"/><successor elementType="junction"/>'
    made, codes = load(tmp_path, whole(road(link=link)))
    assert made is not None
    assert codes == {"SC313"}
