"""Common faults of road files: each rule on made files, on the quality checkers' files, and on every real one."""

from __future__ import annotations

import functools
from pathlib import Path

import pytest

from scenario_compiler.diagnostics import CODES, Diagnostics, Severity
from scenario_compiler.document import read_document
from scenario_compiler.roads import load_network
from scenario_compiler.roads.check import CHECKS, check_file, check_network, unread
from scenario_compiler.roads.describe import describe_network
from tests.roads.make import LINE, lane, road, section
from tests.work import counted

WIDTH = '<width sOffset="0" a="3.5" b="0" c="0" d="0"/>'
NARROW = '<width sOffset="0" a="3.4" b="0" c="0" d="0"/>'
LEVEL = 'id="-1" type="driving" level="true"'
DENIED = '<access sOffset="1" rule="deny" restriction="bus"/>'
ALLOWED = '<access sOffset="1" rule="allow" restriction="taxi"/>'
BORDER = '<borders><border outlineId="1"><cornerReference id="1"/></border></borders>'
TWO_PIECES = (
    '<geometry s="0" x="0" y="0" hdg="0" length="50"><line/></geometry>'
    '<geometry s="{s}" x="{x}" y="0" hdg="{h}" length="50"><line/></geometry>'
)
OBJECT = '<object id="1" s="{s}" t="{t}" zOffset="0" type="tree" {more}</object>'


def codes(path: Path) -> set[str]:
    sink = Diagnostics()
    check_file(path, sink)
    return {one.code.id for one in sink}


def write(folder: Path, *parts: str, minor: int = 7) -> Path:
    path = folder / "made.xodr"
    header = f'<OpenDRIVE><header revMajor="1" revMinor="{minor}"/>'
    path.write_text(header + "\n".join(parts) + "</OpenDRIVE>", encoding="utf-8")
    return path


def linked(number: int, before: str = "", after: str = "", width: str = WIDTH) -> str:
    """Return a lane that is linked to the lanes named."""
    inside = "".join(f'<predecessor id="{one}"/>' for one in before.split())
    inside += "".join(f'<successor id="{one}"/>' for one in after.split())
    return lane(number, f"<link>{inside}</link>{width}")


def to_road(tag: str, number: str, contact: str) -> str:
    return f'<{tag} elementType="road" elementId="{number}" contactPoint="{contact}"/>'


def to_junction(tag: str, number: str) -> str:
    return f'<{tag} elementType="junction" elementId="{number}"/>'


def pair(
    x: float = 100.0, hdg: float = 0.0, contact: str = "start", more: str = "", width: str = WIDTH
) -> tuple[str, str]:
    """Return two roads, the second behind the first, with their lanes linked."""
    plan = f'<geometry s="0" x="{x}" y="0" hdg="{hdg}" length="100.0"><line/></geometry>'
    first = section(linked(1, after="1"), linked(-1, after="-1"))
    second = section(linked(1, before="1", width=width), linked(-1, before="-1"))
    return (
        road("1", lanes=first, link=to_road("successor", "2", contact)),
        road("2", plan=plan, lanes=second, link=to_road("predecessor", "1", "end"), more=more),
    )


def crossing(
    contact: str = "start", links: str = '<laneLink from="-1" to="-1"/>', inner: str = "5", extra: str = ""
) -> tuple[str, ...]:
    """Return a road that leads into a junction, a road in it, and the junction."""
    plan = '<geometry s="0" x="100" y="0" hdg="0" length="20"><line/></geometry>'
    connection = f'<connection id="0" incomingRoad="1" connectingRoad="2" contactPoint="{contact}">{links}</connection>'
    return (
        road("1", link=to_junction("successor", "5")),
        road(
            *("2", 20.0, plan, section(right=linked(-1, before="-1")), to_road("predecessor", "1", "end")),
            f'junction="{inner}"',
        ),
        f'<junction id="5" name="">{connection}{extra}</junction>',
    )


def curve(more: str) -> str:
    return road(plan=f'<geometry s="0" x="0" y="0" hdg="0" length="100.0"><paramPoly3 {more}/></geometry>')


ONE_SIDED = 'singleSide="true"'
SIGN_AT_60 = '<speed sOffset="60" max="10"/>'
ASIDE = '<laneOffset s="0" a="0" b="0" c="0" d="0"/><laneOffset s="50.00001" a="3.5" b="0" c="0" d="0"/>'
STRAIGHT = 'aU="0" bU="1" cU="0" dU="0" aV="0" bV="0" cV="0" dV="0" pRange="arcLength"'
TWO_LANES = section(lane(1), lane(-1) + lane(-2))


TAPER = '<width sOffset="0" a="3.5" b="-0.035" c="0" d="0"/>'
TWO_TYPES = '<type s="0" type="town"/><type s="60" type="motorway"/><planView'
FAST_AT_60 = '<speed sOffset="60" max="36"/>'
HALF = '<width sOffset="0" a="1.75" b="0" c="0" d="0"/>'


def merging(width: str) -> str:
    """Return a road with two lanes of a width that merge into one."""
    before = linked(-1, after="-1", width=width) + linked(-2, after="-1", width=width)
    return road(lanes=section("", before) + section("", linked(-1, "-1 -2"), s=50))


@pytest.mark.parametrize(
    "parts",
    [
        (road(),),
        pair(),
        crossing(),
        (curve(STRAIGHT),),
        (
            road(
                lanes=section(linked(1, after="1"), linked(-1, after="-1"))
                + section(linked(1, "1"), linked(-1, "-1"), s=50)
            ),
        ),
        (
            road(
                lanes=section(linked(1, after="1"), attributes=ONE_SIDED)
                + section("", linked(-1, after="-1") + lane(-2, WIDTH + SIGN_AT_60), attributes=ONE_SIDED)
                + section(lane(2) + linked(1, "1"), s=40, attributes=ONE_SIDED)
                + section("", linked(-1, "-1"), s=70, attributes=ONE_SIDED)
            ),
        ),
        (
            road("1", link=to_junction("successor", "5"), lanes=section(lane(1), lane(-1) + lane(-2, TAPER))),
            *crossing()[1:],
        ),
        (road(lanes=section(lane(1), lane(-1, WIDTH + FAST_AT_60))).replace("<planView", TWO_TYPES),),
        (merging(HALF),),
        (merging(WIDTH),),
        (road(lanes=ASIDE + section("", linked(-1, after="-2")) + section("", lane(-1) + linked(-2, "-1"), s=50)),),
    ],
)
def test_good_files_have_no_finding(tmp_path: Path, parts: tuple[str, ...]) -> None:
    assert codes(write(tmp_path, *parts)) - {"SC320", "SC322", "SC323", "SC324", "SC325"} == set()


def test_reversed_lanes_are_driven_the_other_way(tmp_path: Path) -> None:
    lanes = section(lane(1), lane(-1) + lane(-2).replace("<lane ", '<lane direction="reversed" '))
    first = road("1", link=to_junction("successor", "5"), lanes=lanes)
    signal = '<signals><signal id="1" s="10" t="4" zOffset="2" type="274" subtype="1" dynamic="no" orientation="{}">'
    for orientation, expected in (("-", set()), ("+", {"SC357"})):
        signed = first.replace("</road>", signal.format(orientation) + validity(-2, -2) + "</signal></signals></road>")
        found = codes(write(tmp_path, signed, *crossing()[1:], minor=8))
        assert found & {"SC341", "SC357"} == expected


def narrowing(a: float, b: float) -> str:
    return section(lane(1), lane(-1, f'<width sOffset="0" a="{a}" b="{b}" c="0" d="0"/>'))


def with_lane(inside: str, kind: str = "driving") -> str:
    return road(lanes=section(lane(1), lane(-1, WIDTH + inside, kind)))


def with_object(s: float = 10, t: float = 5, more: str = 'orientation="+" radius="1">') -> str:
    thing = OBJECT.format(s=s, t=t, more=more)
    return road().replace("</road>", f"<objects>{thing}</objects></road>")


def with_signal(more: str, inside: str = "") -> str:
    signal = f'<signal id="1" s="10" t="4" zOffset="2" type="274" subtype="1" {more}>{inside}</signal>'
    return road().replace("</road>", f"<signals>{signal}</signals></road>")


TO_NOWHERE = '<connection id="1" incomingRoad="1" contactPoint="start"/>'
AGAIN = '<connection id="1" incomingRoad="1" connectingRoad="2" contactPoint="start"/>'
INSIDE_OUT = '<connection id="1" incomingRoad="2" connectingRoad="1" contactPoint="start"/>'
UNORDERED = '<laneLink from="-2" to="-1"/><laneLink from="-1" to="-1"/>'
STEP = '<elevationProfile><elevation s="0" a="0.5" b="0" c="0" d="0"/></elevationProfile>'
STEPS = STEP.replace("</", '<elevation s="50" a="1" b="0" c="0" d="0"/></')
BRIDGE = '<objects><bridge id="1" s="90" length="20" type="steel"/></objects>'
BULGE = '<width sOffset="0" a="1" b="-0.1" c="0.001" d="0"/>'
LATE = '<width sOffset="1" a="3.5" b="0" c="0" d="0"/>'
BACK = '<speed sOffset="20" max="10"/><speed sOffset="10" max="20"/>'
SLOW = '<speed sOffset="0" max="10"/>'
FAST_TYPE = '<type s="0" type="motorway"/><planView'
SIGN = 'dynamic="no" orientation="+"'


def along(before: str, after: str) -> str:
    """Return a road with two lane sections: the left lane of each, with a right one."""
    return road(lanes=section(before, lane(-1)) + section(after, lane(-1), s=50))


def validity(first: int, last: int) -> str:
    return f'<validity fromLane="{first}" toLane="{last}"/>'


CASES: dict[str, list[tuple[str, ...]]] = {
    "SC333": [
        pair(contact="end"),
        (road("1", link=to_road("successor", "2", "start")), road("2")),
        (road(link=to_junction("successor", "5")), '<junction id="5" name=""/>'),
    ],
    "SC313": [(road(attributes='junction="7"'),)],
    "SC334": [(*pair(), road("3", link=to_road("successor", "2", "start"))), pair(contact="")],
    "SC335": [
        (along(linked(1, after="3"), lane(1)),),
        (road(lanes=section(linked(1, after="1"), lane(-1))),),
        (
            road(
                lanes=section(linked(1, after="2"), lane(-1))
                + section("", lane(-1), 30.0, ONE_SIDED)
                + section(lane(1), "", 60.0, ONE_SIDED)
            ),
        ),
    ],
    "SC336": [(along(linked(1, after="1"), lane(1)),)],
    "SC337": [pair(width='<width sOffset="0" a="0" b="0.1" c="0" d="0"/>')],
    "SC338": [crossing(contact="end"), crossing(inner="-1"), crossing(extra=TO_NOWHERE)],
    "SC339": [crossing(links='<laneLink from="-4" to="-1"/>')],
    "SC340": [crossing(links=UNORDERED)],
    "SC341": [crossing(links='<laneLink from="1" to="-1"/>')],
    "SC342": [crossing(extra=AGAIN)],
    "SC343": [crossing(extra=INSIDE_OUT)],
    "SC344": [
        pair(x=100.02),
        pair(width=NARROW),
        (along(linked(1, after="1"), linked(1, "1", width=NARROW)),),
        (along(linked(1, after="1"), linked(1, "1")).replace("<lanes>", f"<lanes>{ASIDE}"),),
        (road(lanes=ASIDE + section(lane(1), lane(-1))),),
        (merging(HALF.replace("1.75", "1.5")),),
        (with_lane(NARROW.replace('sOffset="0"', 'sOffset="50"')),),
        (road(plan=TWO_PIECES.format(s=50, x=51, h=0)),),
    ],
    "SC345": [
        pair(hdg=0.1),
        tuple(one.replace('x="100" y="0" hdg="0"', 'x="100" y="0" hdg="0.1"') for one in crossing()),
        (road(plan=TWO_PIECES.format(s=50, x=50, h=0.1)),),
    ],
    "SC346": [(road(lanes=narrowing(1.0, -0.02)),), (road(lanes=section(lane(1), lane(-1, BULGE))),)],
    "SC347": [(curve(STRAIGHT.replace("arcLength", "normalized")),)],
    "SC348": [(curve(STRAIGHT.replace('aV="0"', 'aV="1"')),)],
    "SC349": [
        (road(lanes=section(lane(1), lane(-1), s=1)),),
        (road(lanes=section(lane(1), lane(-1)) + section(lane(1), lane(-1))),),
        (road(lanes=section(lane(1), lane(-1)) + section(lane(1), lane(-1), s=200)),),
    ],
    "SC350": [(road(lanes=section(lane(1), lane(-2))),)],
    "SC351": [
        (road(lanes=section(lane(1), lane(-1, ""))),),
        (road(lanes=section(lane(1), lane(-1, LATE))),),
        (with_lane(BACK),),
        (with_lane('<speed sOffset="101" max="10"/>'),),
    ],
    "SC352": [(with_lane("", "none"),)],
    "SC353": [
        (road(lanes=TWO_LANES.replace(LEVEL.replace("true", "false"), LEVEL)),),
        tuple(one.replace('level="false"', 'level="true"', i) for i, one in enumerate(pair())),
    ],
    "SC354": [(with_lane(DENIED + ALLOWED),)],
    "SC355": [(with_object(s=101),), (with_object(t=51),), (road().replace("</road>", f"{BRIDGE}</road>"),)],
    "SC356": [
        (with_object(more='orientation="+">'),),
        (with_object(more='orientation="+" radius="60">'),),
        (with_signal(f'{SIGN} width="9"'),),
    ],
    "SC357": [
        (with_signal(SIGN, validity(-3, -1)),),
        (with_signal(SIGN.replace("+", "-"), validity(-1, -1)),),
        (with_signal(SIGN, validity(0, 0)),),
    ],
    "SC358": [(with_lane(SLOW).replace("<planView", FAST_TYPE),)],
    "SC359": [(with_object(more=f'orientation="+" radius="1">{BORDER}'),)],
    "SC360": [(with_object(more='radius="1">'),)],
    "SC361": [(with_signal(SIGN).replace('"274"', '"multiBoard"'),)],
    "SC363": [pair(more=STEP), (road(more=STEPS),)],
    "SC364": [(road(plan=LINE.format(length=90)),), (road(plan=TWO_PIECES.format(s=51, x=50, h=0)),)],
}
"""Files for each code, as parts."""


@pytest.mark.parametrize(("code", "parts"), [(code, parts) for code, all_of_it in CASES.items() for parts in all_of_it])
def test_a_fault_is_found(tmp_path: Path, code: str, parts: tuple[str, ...]) -> None:
    assert code in codes(write(tmp_path, *parts))


def test_a_value_that_the_structure_forbids_is_reported_once(tmp_path: Path) -> None:
    sink = Diagnostics()
    check_file(write(tmp_path, road(lanes=section(right=linked(-1, after="-1.0")))), sink)
    (found,) = [one for one in sink if "-1.0" in one.message]
    assert found.code.id == "SC323"


def test_every_rule_has_a_case() -> None:
    modules = {check.__module__ for check in CHECKS}
    assert modules <= {
        f"scenario_compiler.roads.check.{name}"
        for name in ("links", "junctions", "joints", "shapes", "traffic", "objects")
    }
    rules = {code for code in CODES if "SC333" <= code <= "SC364"}
    assert rules == set(CASES) - {"SC313"}
    assert all(CODES[code].severity is not Severity.ERROR for code in rules)
    assert all("xodr:1." in CODES[code].explanation for code in rules - {"SC345", "SC363"})


def test_findings_have_places_and_are_bounded(tmp_path: Path) -> None:
    many = "".join(linked(-1 - i, after="99") for i in range(300))
    path = write(tmp_path, road(lanes=section(lane(1), many)))
    sink = Diagnostics()
    check_file(path, sink)
    lost = [one for one in sink if one.code.id == "SC335"]
    assert len(lost) == 100
    assert all(one.place.line and one.place.column for one in lost)
    assert "200 more findings of SC335 are not listed" in [one.message for one in sink]


def test_without_a_network_only_the_file_is_checked(tmp_path: Path) -> None:
    path = write(tmp_path, road(length=0.0, lanes=section(lane(1), lane(-2))))
    sink = Diagnostics()
    document = read_document(path, sink)
    assert document is not None
    check_network(document, None, sink)
    assert "SC350" in {one.code.id for one in sink}


QC = "qc-opendrive/tests/data/"
MSL = "sl-5-9-openmsl-qc-opendrive/tests/data/"
MSL_EXAMPLES = "sl-5-9-openmsl-qc-opendrive/openmsl_qc_opendrive/examples/Semantic/"
WAITING = "not_implemented_yet/rule_"

RULES = [
    ("SC338", QC + "junction_connection_linkage/", "*"),
    ("SC344", QC + "road_geometry_contact_point/", "*"),
    ("SC347", QC + "road_geometry_param_poly3_length_match/", "*"),
    ("SC354", QC + "road_lane_access_no_mix_of_deny_or_allow/", "*"),
    ("SC353", QC, "road_lane_level_true_one_side*/*"),
    ("SC336", QC + "road_lane_link_lanes_across_lane_sections/", "*"),
    ("SC320 SC322 SC325", QC + "valid_schema/", "*18*"),
    ("SC339", MSL + "junction_connection_lane_link_id/", "*"),
    ("SC340", MSL + "junction_connection_lane_linkage_order/", "*"),
    ("SC348", MSL + "road_geometry_parampoly3_attributes/", "*"),
    ("SC350", MSL + "road_lane_id_order/", "*"),
    ("SC352", MSL + "road_lane_type_none/", "*"),
    ("SC349", MSL + "road_lanesection_s/", "*"),
    ("SC355", MSL + "road_object_position/", "*"),
    ("SC356", MSL + "road_object_size/", "*"),
    ("SC357", MSL + "road_signal_object_lane_linkage/", "*"),
    ("SC358", MSL + "road_type_vs_speed_limit/", "*"),
    ("SC330", QC + WAITING, "104*"),
    ("SC322", QC + WAITING, "178*"),
    ("SC360", QC + WAITING, "242*"),
    ("SC325", QC + WAITING, "2[4-6][3-7]*"),
    ("SC359", QC + WAITING, "284*"),
    ("SC330", QC + WAITING, "28[56]*"),
    ("SC330", QC + WAITING, "305*"),
    ("SC328", QC + WAITING, "325*"),
    ("SC330", QC + WAITING, "371*"),
    ("SC324", QC + WAITING, "64*"),
]
"""The codes (one of them) that a checker's rule has here, and its files: invalid ones have them, valid ones do not."""

EXAMPLES = {
    "check_driving_lanes_continue_in_junction": "SC341",
    "check_lane_vaild_sOffset": "SC351",
    "check_lane_valid_width": "SC346",
    "check_lanes_order": "SC350",
    "check_lanesection_valid_s": "SC349",
    "check_object_position": "SC355",
    "check_object_size": "SC356",
    "check_road_linkage": "SC313",
    "check_road_linkage_backward": "SC333",
    "check_signal_position": "SC355",
    "check_signal_size": "SC356",
}
"""openMSL's examples of faults."""

FAULTY = ("invalid", "close_match", "negative", "road_object_size_outline_v1_5")
"""What the names of files with a fault hold."""


@pytest.mark.parametrize(("rule", "folder", "pattern"), RULES)
def test_agrees_with_the_quality_checkers(corpus: Path, rule: str, folder: str, pattern: str) -> None:
    head, _, start = folder.rpartition("/")
    files = sorted((corpus / head).glob(start + pattern))
    assert files
    for path in files:
        faulty = any(word in path.name for word in FAULTY)
        assert bool(codes(path) & set(rule.split())) == faulty, path.name


@pytest.mark.parametrize("name", EXAMPLES)
def test_agrees_with_openmsl_s_examples(corpus: Path, name: str) -> None:
    assert EXAMPLES[name] in codes(corpus / f"{MSL_EXAMPLES}{name}.xodr")


@pytest.mark.parametrize("name", ["no_static_invalid", "no_vms_invalid", "valid"])
def test_boards(corpus: Path, name: str) -> None:
    path = corpus / f"{QC}{WAITING}341_road_signal_boards_multi_board_have_sub_boards_{name}.xodr"
    assert ("SC361" in codes(path)) == ("invalid" in name)


MOST_LINES, MOST_LINES_A_BYTE = 100_000, 10
"""Lines of Python that may be run to check a file: 42 000 for the smallest, 4 a byte for large ones."""


def check_one(path: Path, sink: Diagnostics) -> None:
    check_file(path, sink)
    document = read_document(path, Diagnostics())
    assert document is not None
    unread(document)


def check_all(files: list[Path]) -> None:
    for path in files:
        sink = Diagnostics()
        _, lines = counted(functools.partial(check_one, path, sink))
        assert lines < MOST_LINES + MOST_LINES_A_BYTE * path.stat().st_size, path.name
        assert all(one.place.line or one.code.id == "SC307" for one in sink), path.name


LARGE = 300_000


@pytest.mark.parametrize("every", [4, pytest.param(1, marks=pytest.mark.slow)])
def test_every_file_of_the_corpus_is_checked(corpus: Path, every: int) -> None:
    files = [path for path in sorted(corpus.rglob("*.xodr")) if path.stat().st_size <= LARGE]
    assert len(files) > 250
    check_all(files[::every])


@pytest.mark.slow
def test_every_large_file_of_the_corpus_is_checked(corpus: Path) -> None:
    check_all([path for path in sorted(corpus.rglob("*.xodr")) if path.stat().st_size > LARGE])


def test_the_packaged_maps_are_sound(repository: Path) -> None:
    maps = sorted((repository / "maps").glob("*/*.xodr"))
    assert maps
    for path in maps:
        sink = Diagnostics()
        check_file(path, sink)
        assert [f"{one.code.id} {one.place.line} {one.message}" for one in sink] == []


def test_a_namespace_is_dropped(tmp_path: Path) -> None:
    path = write(tmp_path, *pair(x=100.02))
    path.write_text(
        path.read_text(encoding="utf-8").replace("<OpenDRIVE>", '<OpenDRIVE xmlns="a.b">'), encoding="utf-8"
    )
    assert {"SC320", "SC344"} <= codes(path)


def test_a_network_is_summed_up(tmp_path: Path) -> None:
    made = load_network(write(tmp_path, *crossing()), cache=False)
    assert made is not None
    found = describe_network(made)
    assert (found.name, found.version, found.roads, found.roads_in_junctions) == ("made", "1.7", 2, 1)
    assert (found.length, found.length_outside_junctions) == (120.0, 100.0)
    assert found.lanes == {"driving": 3}
    assert found.lane_length == {"driving": 220.0}
    assert found.junctions == {"default": 1}
    assert found.bounds == pytest.approx((0.0, -3.5, 120.0, 3.5), abs=1e-5)


def test_a_spiral_is_one_geometry(tmp_path: Path) -> None:
    spirals = (
        '<geometry s="0" x="0" y="0" hdg="0" length="50"><spiral curvStart="0" curvEnd="0.05"/></geometry>'
        '<geometry s="50" x="43" y="19" hdg="1.25" length="50"><spiral curvStart="0.05" curvEnd="0"/></geometry>'
    )
    made = load_network(write(tmp_path, road(plan=spirals)), cache=False)
    assert made is not None
    assert len(made.tables.piece_s) > 2
    assert describe_network(made).geometries == {"spiral": 2}
