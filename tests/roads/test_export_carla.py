"""Files for CARLA's clients: parts that they cannot use are replaced, the rest stays, and no lane is a dead end."""

from __future__ import annotations

import difflib
import json
import math
import re
import subprocess
import sys
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from lxml import etree

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.document import Document, parse_document
from scenario_compiler.roads.export_carla import JOINT_LENGTH, export_for_carla
from scenario_compiler.roads.network import Network, load_network
from scenario_compiler.roads.shorten import shorten_road
from scenario_compiler.roads.text_edits import TextEdits
from tests.roads import make

CUSTOM_MAP = "aisa-toolkit/custommap/HRI_custommap.xodr"

MARKED = '<roadMark sOffset="{}" type="solid" color="white"/>'

PROBE = """
import json, sys
import carla
world = carla.Map("map", open(sys.argv[1], encoding="utf-8").read())
points = world.generate_waypoints(2.0)
ends = sorted({(w.road_id, w.lane_id) for w in points if not w.next(2.5)})
jumps = [w.transform.location.distance(n.transform.location) for w in points for n in w.next(1.0)]
print(json.dumps({"points": len(points), "ends": ends, "jump": max(jumps, default=0.0)}))
"""


INTO_DIRECT = '<{}essor elementType="junction" elementId="7"/>'
BEYOND = '<geometry s="0" x="50" y="0" hdg="0" length="50"><line/></geometry>'
DIRECT = (
    '<junction id="7" type="direct"><connection id="0" incomingRoad="1" linkedRoad="2" contactPoint="start">'
    '<laneLink from="-1" to="-1"/></connection></junction>'
)


def export(path: Path) -> tuple[Network, bytes]:
    document = parse_document(path.read_bytes(), str(path), Diagnostics())
    network = load_network(path, cache=False)
    assert document is not None
    assert network is not None
    return network, export_for_carla(document, network)


def ask_carla(folder: Path, data: bytes) -> dict[str, object]:
    """Load a file with the installed client in a process of its own: a file that it cannot use may kill it."""
    pytest.importorskip("carla")
    path = folder / "exported.xodr"
    path.write_bytes(data)
    done = subprocess.run([sys.executable, "-c", PROBE, str(path)], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr[-500:]
    found: dict[str, object] = json.loads(done.stdout.splitlines()[-1])
    return found


def reload(folder: Path, data: bytes) -> Network:
    path = folder / "again.xodr"
    path.write_bytes(data)
    network = load_network(path, cache=False)
    assert network is not None
    return network


def drivable_ends(network: Network) -> list[tuple[str, int]]:
    """(road, lane) of driving lanes that lead nowhere."""
    n = network.tables
    found = []
    for row, lane in enumerate(n.lane_id):
        road = n.section_road[n.lane_section[row]]
        end = 1 if (lane < 0) == (n.road_rule[road] > 0) else 0
        if lane != 0 and n.lane_type[row] == 0 and n.lane_link[2 * row + end] == n.lane_link[2 * row + end + 1]:
            found.append((network.road_ids[road], lane))
    return found


def test_a_map_with_direct_junctions_has_no_dead_end(corpus: Path, tmp_path: Path) -> None:
    _, data = export(corpus / CUSTOM_MAP)
    found = ask_carla(tmp_path, data)
    assert found["ends"] == []
    assert isinstance(found["jump"], float)
    assert found["jump"] < 1.5  # 1.43 on the outside of the tightest curve, in the file as it is


@pytest.mark.parametrize(
    ("lane", "marks"),
    [
        ('<lane id="-1" type="driving"/>', [("0", "none")]),
        ('<lane id="-1" type="driving"></lane>', [("0", "none")]),
        ('<lane id="-1" type="driving">' + MARKED.format(5) + "</lane>", [("0", "none"), ("5", "solid")]),
        (
            '<lane id="-1" type="driving">\n  {width}\n  ' + MARKED.format(5) + "</lane>",
            [("0", "none"), ("5", "solid")],
        ),
        ('<lane id="-1" type="driving">{width}<speed sOffset="0" max="9"/></lane>', [("0", "none")]),
        ('<lane id="-1" type="driving">{width}' + MARKED.format(0) + "</lane>", [("0", "solid")]),
    ],
)
def test_each_lane_has_a_road_mark_at_its_start(tmp_path: Path, lane: str, marks: list[tuple[str, str]]) -> None:
    lane = lane.replace("{width}", '<width sOffset="0" a="3.5" b="0" c="0" d="0"/>')
    path = tmp_path / "road.xodr"
    path.write_text(
        '<OpenDRIVE><header revMajor="1" revMinor="6"/><road id="1" length="90" junction="-1"><planView>'
        '<geometry s="0" x="0" y="0" hdg="0" length="90"><line/></geometry></planView><lanes><laneSection s="0">'
        f'<center><lane id="0" type="none" level="false"/></center><right>{lane}</right></laneSection></lanes></road>'
        "</OpenDRIVE>",
        encoding="utf-8",
    )
    _, data = export(path)
    found = {str(one.get("id")): one for one in etree.fromstring(data).iter("lane")}
    assert [(one.get("sOffset"), one.get("type")) for one in found["-1"].iterfind("roadMark")] == marks
    assert [one.get("type") for one in found["0"]] == ["none"]
    order = [str(one.tag) for one in found["-1"]]
    assert order == sorted(order, key=["width", "roadMark", "speed"].index)


def test_direct_junctions_become_default_ones_with_connecting_roads(corpus: Path, tmp_path: Path) -> None:
    before, data = export(corpus / CUSTOM_MAP)
    root = etree.fromstring(data)
    assert [one.get("type") for one in root.iterfind("junction")] == ["default"] * 7
    assert not root.xpath("//connection[@linkedRoad or not(@connectingRoad)]")
    added = [one for one in root.iterfind("road") if one.get("id") not in before.road_ids]
    assert {one.get("junction") for one in added} == {"9", "12", "14", "17", "22", "28", "-1"}
    for road in added:
        assert float(road.get("length", "0")) == pytest.approx(JOINT_LENGTH)
        assert [one.tag for one in road.iterfind("link/*")] == ["predecessor", "successor"]
        links = [
            [one.tag for one in lane.iterfind("link/*")] for lane in road.iterfind(".//lane") if lane.get("id") != "0"
        ]
        assert all(found == ["predecessor", "successor"] for found in links)
    assert drivable_ends(reload(tmp_path, data)) == []


@pytest.mark.parametrize("odd", ["nan", "-inf", "1e400"])
def test_a_lane_beside_the_joint_may_have_an_id_that_is_not_an_integer(tmp_path: Path, odd: str) -> None:
    lanes = make.section("", make.lane(-1) + make.lane(-2).replace("-2", odd))
    first = make.road("1", 50.0, lanes=lanes, link=INTO_DIRECT.format("succ"))
    second = make.road("2", 50.0, BEYOND, make.section("", make.lane(-1)), INTO_DIRECT.format("predec"))
    make.network(tmp_path, first, second, DIRECT)
    _, data = export(tmp_path / "made.xodr")
    assert len(etree.fromstring(data).findall("road")) == 3


def test_new_roads_lie_where_the_old_surface_was(corpus: Path, tmp_path: Path) -> None:
    before, data = export(corpus / CUSTOM_MAP)
    after = reload(tmp_path, data)
    added = [one for one in after.road_ids if one not in before.road_ids]
    assert added
    for road in added:
        for lane in after.lanes_at(road, 0.5 * JOINT_LENGTH):
            pose = after.lane_pose(road, lane.lane, 0.5 * JOINT_LENGTH)
            held = before.locate(pose.x, pose.y)
            assert any(abs(place.offset) < 1e-6 for place in held), (road, lane)
            assert any(
                before.lane_width(p.road, p.lane, p.s) == pytest.approx(lane.t_left - lane.t_right) for p in held
            )


def test_joints_of_new_roads_are_closed(corpus: Path, tmp_path: Path) -> None:
    before, data = export(corpus / CUSTOM_MAP)
    after = reload(tmp_path, data)
    n = after.tables
    for road in [after.road_index(one) for one in after.road_ids if one not in before.road_ids]:
        for row in range(n.section_lane[n.road_section[road]], n.section_lane[n.road_section[road] + 1]):
            for end in (0, 1):
                for link in range(n.lane_link[2 * row + end], n.lane_link[2 * row + end + 1]):
                    other = n.link_lane[link]
                    far = n.section_road[n.lane_section[other]]
                    here = after.lane_pose(after.road_ids[road], n.lane_id[row], end * n.road_length[road])
                    there = after.lane_pose(
                        after.road_ids[far], n.lane_id[other], n.link_contact[link] * n.road_length[far]
                    )
                    assert math.dist(here[:2], there[:2]) < 2e-4 + 0.5 * _width_step(after, road, row, other)


def _width_step(after: Network, road: int, row: int, other: int) -> float:
    """How much the widths of two linked lanes differ, m: the file itself joins lanes of unlike widths."""
    n = after.tables
    far = n.section_road[n.lane_section[other]]
    widths = (after.lane_width(after.road_ids[road], n.lane_id[row], 0.0), n.lane_id[other])
    return abs(widths[0] - max(after.lane_width(after.road_ids[far], widths[1], s) for s in (0.0, n.road_length[far])))


def test_all_other_lines_stay_as_they_are(corpus: Path) -> None:
    path = corpus / CUSTOM_MAP
    _, data = export(path)
    before, after = path.read_text(encoding="utf-8").splitlines(), data.decode().splitlines()
    kept = sum(
        block.size for block in difflib.SequenceMatcher(None, before, after, autojunk=False).get_matching_blocks()
    )
    assert kept > 0.95 * len(before)


@pytest.mark.parametrize("name", ["Town01", "Town04"])
def test_a_map_of_carla_is_left_alone(corpus: Path, name: str) -> None:
    path = corpus / "Scenic/assets/maps/CARLA" / f"{name}.xodr"
    assert export(path)[1] == path.read_bytes().replace(b"\r\n", b"\n")


@pytest.mark.parametrize("name", ["town_grid", "signal_crossing"])
def test_packaged_maps_have_no_dead_ends_in_carla(repository: Path, tmp_path: Path, name: str) -> None:
    _, data = export(repository / "maps" / name / f"{name}.xodr")
    found = ask_carla(tmp_path, data)
    assert found["ends"] == []
    assert isinstance(found["jump"], float)
    assert found["jump"] < 1.5


LOOP_LANE = '<lane id="{id}" type="driving">{link}<width sOffset="0" a="3" b="0" c="0" d="0"/></lane>'


def loop(stated: str) -> bytes:
    """A circle of 50 m radius but for 20 m of it, where one connecting road a direction closes it.

    Args:
        stated: A link that the lanes of the circle's road state at its end, where a junction lies.
    """
    gap = 20.0 / 50.0
    roads = ((10, "-1", gap, math.tau - gap), (11, "5", 0.0, gap), (12, "5", 0.0, gap))
    texts = []
    for number, junction, begin, turn in roads:
        back = number == 12  # the connecting road of the other direction
        angle = begin + turn if back else begin
        heading, curvature = (angle + math.pi, "-0.02") if back else (angle, "0.02")
        place = f'x="{50 * math.sin(angle)!r}" y="{-50 * math.cos(angle)!r}" hdg="{heading!r}"'
        if junction == "-1":
            link = "".join(f'<{side} elementType="junction" elementId="5"/>' for side in ("predecessor", "successor"))
            lanes = [LOOP_LANE.format(id=one, link=stated) for one in ("1", "-1")]
        else:
            ends = ("start", "end") if back else ("end", "start")
            sides = zip(("predecessor", "successor"), ends, strict=True)
            link = "".join(f'<{side} elementType="road" elementId="10" contactPoint="{end}"/>' for side, end in sides)
            lane = "1" if back else "-1"
            own = f'<link><predecessor id="{lane}"/><successor id="{lane}"/></link>'
            lanes = ["", LOOP_LANE.format(id="-1", link=own)]
        left, right = (
            f"<{side}>{one}</{side}>" if one else "" for side, one in zip(("left", "right"), lanes, strict=True)
        )
        texts.append(
            f'<road id="{number}" junction="{junction}" length="{50 * turn!r}"><link>{link}</link><planView>'
            f'<geometry s="0" {place} length="{50 * turn!r}"><arc curvature="{curvature}"/></geometry></planView>'
            f'<lanes><laneSection s="0">{left}<center><lane id="0" type="none"/></center>{right}</laneSection></lanes>'
            "</road>"
        )
    joined = "".join(
        f'<connection id="{k}" incomingRoad="10" connectingRoad="{11 + k}" contactPoint="start">'
        f'<laneLink from="{lane}" to="-1"/></connection>'
        for k, lane in enumerate(("-1", "1"))
    )
    header = '<?xml version="1.0" encoding="UTF-8"?>\n<OpenDRIVE><header revMajor="1" revMinor="6"/>\n'
    return (header + "\n".join(texts) + f'\n<junction id="5" name="">{joined}</junction>\n</OpenDRIVE>\n').encode()


@pytest.mark.parametrize("stated", ["", "<link/>", '<link><successor id="-1"/></link>'])
def test_a_road_that_comes_back_to_its_junction_continues(tmp_path: Path, stated: str) -> None:
    path = tmp_path / "loop.xodr"
    path.write_bytes(loop(stated))
    assert ask_carla(tmp_path, path.read_bytes())["ends"] != []
    before, data = export(path)
    after = reload(tmp_path, data)
    (added,) = (one for one in after.road_ids if one not in before.road_ids)
    assert after.road("10").length + after.road(added).length == pytest.approx(before.road("10").length)
    assert drivable_ends(after) == []
    found = ask_carla(tmp_path, data)
    assert found["ends"] == []
    assert isinstance(found["jump"], float)
    assert found["jump"] < 1.1
    assert export(tmp_path / "exported.xodr")[1] == data


def test_a_connection_that_is_added_has_a_free_number(tmp_path: Path) -> None:
    one = re.sub('<connection id="1".*?</connection>', "", loop("").decode()).replace(
        'id="0" incoming', 'id="²" incoming'
    )
    (tmp_path / "loop.xodr").write_text(one, encoding="utf-8")
    _, data = export(tmp_path / "loop.xodr")
    assert re.findall('<connection id="(.*?)"', data.decode()) == ["²", "1"]


LANE = """<lane id="{id}" type="driving"><link>{link}</link>
<width sOffset="0" a="3" b="0" c="0" d="0"/><roadMark sOffset="0" type="solid" color="white"/></lane>"""


def ring(roads: int, linked: bool = True) -> bytes:
    """A circle of 50 m radius of some roads; without `linked` only the successors of lanes are filed."""
    texts = []
    for k in range(roads):
        angle, length = 2 * math.pi * k / roads, 2 * math.pi * 50 / roads
        before, after = 10 + (k - 1) % roads, 10 + (k + 1) % roads
        left, right = (
            LANE.format(
                id=i, link=f'{f"<predecessor id={i!r}/>" if linked else ""}<successor id="{i}"/>'.replace("'", '"')
            )
            for i in ("1", "-1")
        )
        left, right = (text.replace("<predecessor id=1/>", "") for text in (left, right))
        texts.append(
            f'<road id="{10 + k}" junction="-1" length="{length!r}"><link>'
            f'<predecessor elementType="road" elementId="{before}" contactPoint="end"/>'
            f'<successor elementType="road" elementId="{after}" contactPoint="start"/></link><planView>'
            f'<geometry s="0" x="{50 * math.sin(angle)!r}" y="{-50 * math.cos(angle)!r}" hdg="{angle!r}" '
            f'length="{length!r}"><arc curvature="0.02"/></geometry></planView><lanes><laneSection s="0">'
            f'<left>{left}</left><center><lane id="0" type="none">{MARKED.format(0)}</lane></center>'
            f"<right>{right}</right></laneSection></lanes></road>"
        )
    header = '<?xml version="1.0" encoding="UTF-8"?>\n<OpenDRIVE><header revMajor="1" revMinor="6"/>\n'
    return (header + "\n".join(texts) + "\n</OpenDRIVE>\n").encode()


@pytest.mark.parametrize("linked", [True, False])
@pytest.mark.parametrize("roads", [1, 2, 3])
def test_a_ring_of_few_roads_goes_round(tmp_path: Path, roads: int, linked: bool) -> None:
    path = tmp_path / "ring.xodr"
    path.write_bytes(ring(roads, linked))
    _, data = export(path)
    again = reload(tmp_path, data)
    assert len(again.road_ids) == max(3, roads)
    assert drivable_ends(again) == []
    assert ask_carla(tmp_path, data)["ends"] == []
    if roads == 3 and linked:
        assert data == path.read_bytes()


@pytest.mark.parametrize(
    ("file", "reason"),
    [
        ("esmini/resources/xodr/soderleden.xodr", "direct junction, its connecting road read as road 0"),
        (
            "OSC-NCAP-scenarios/OpenDRIVE/NCAP/X-Intersection_NCAP.xodr",
            "junction and road share an id; dead lane links",
        ),
        ("maliput_xodr/resources/intersection/intersection_3m_width.xodr", "no connection into some connecting roads"),
        ("GT-OpenSCENARIOEditor/test-fixtures/opendrive-v1.9/GT_23_virtual_junction_17.xodr", "virtual connection"),
    ],
)
def test_traps_are_taken_out(corpus: Path, tmp_path: Path, file: str, reason: str) -> None:
    network, data = export(corpus / file)
    carla_ends = {(str(road), lane) for road, lane in ask_carla(tmp_path, data)["ends"]}  # type: ignore[attr-defined]
    assert carla_ends <= set(drivable_ends(network)), reason


def test_junction_ids_that_roads_have_are_renamed_everywhere(corpus: Path) -> None:
    _, data = export(corpus / "OSC-NCAP-scenarios/OpenDRIVE/NCAP/X-Intersection_NCAP.xodr")
    root = etree.fromstring(data)
    roads, junctions = ({one.get("id") for one in root.iterfind(tag)} for tag in ("road", "junction"))
    assert not roads & junctions
    assert {one.get("junction") for one in root.iterfind("road")} == {"-1", *junctions}
    assert {one.get("elementId") for one in root.iterfind("road/link/*[@elementType='junction']")} == junctions


WIDTHS = """
import sys
import carla
world = carla.Map("map", open(sys.argv[1], encoding="utf-8").read())
points = [way for distance in (0.5, 1.0, 1.7, 2.0, 3.0) for way in world.generate_waypoints(distance)]
print(min(one.lane_width for way in points for one in (way, *way.next(3.0), *way.previous(3.0))))
"""


@pytest.mark.parametrize("exported", [False, True])
def test_no_lane_has_a_negative_width(repository: Path, tmp_path: Path, exported: bool) -> None:
    """In the file as it is, the client computes widths below 0 where lanes begin and end."""
    pytest.importorskip("carla")
    file = repository / "maps/highway_loop/highway_loop.xodr"
    path = tmp_path / "map.xodr"
    path.write_bytes(export(file)[1] if exported else file.read_bytes())
    done = subprocess.run([sys.executable, "-c", WIDTHS, path], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr[-500:]
    assert (float(done.stdout.splitlines()[-1]) >= 0.0) == exported


SHAPES = {
    "line": "<line/>",
    "arc": '<arc curvature="-0.02"/>',
    "spiral": '<spiral curvStart="0.0" curvEnd="0.03"/>',
    "poly3": '<poly3 a="0" b="0" c="0.004" d="0.00002"/>',
    "normalized": '<paramPoly3 pRange="normalized" aU="0" bU="40" cU="1" dU="-2" aV="0" bV="0" cV="4" dV="1"/>',
    "arcLength": '<paramPoly3 pRange="arcLength" aU="0" bU="1" cU="0" dU="-0.0001" aV="0" bV="0" cV="0.003" dV="0"/>',
}

CURVES = {"poly3", "normalized", "arcLength"}
"""The shapes whose parameter is found from s, to less than 1 mm."""

SHAPED = """<OpenDRIVE><header revMajor="1" revMinor="6"/><road id="1" junction="-1" length="40.0">
<planView><geometry s="0" x="3" y="-2" hdg="0.7" length="40.0">{shape}</geometry></planView>
<elevationProfile><elevation s="0" a="1" b="0.02" c="0.003" d="-0.0001"/>
<elevation s="20" a="1.8" b="0.02" c="0" d="0"/></elevationProfile>
<lateralProfile><superelevation s="0" a="0.01" b="0.001" c="0" d="0"/></lateralProfile>
<lanes><laneOffset s="0" a="0.5" b="0.01" c="0.001" d="0"/><laneSection s="0">
<center><lane id="0" type="none"/></center><right><lane id="-1" type="driving">
<width sOffset="0" a="3" b="0.05" c="0" d="-0.00001"/><width sOffset="12" a="3.5" b="0" c="0" d="0"/>
<roadMark sOffset="0" type="solid" color="white" width="0.12"/></lane></right></laneSection>
<laneSection s="30"><center><lane id="0" type="none"/></center><right><lane id="-1" type="driving">
<width sOffset="0" a="3.5" b="0" c="0" d="0"/></lane></right></laneSection></lanes></road></OpenDRIVE>"""


@pytest.mark.parametrize("shape", SHAPES)
@given(at_start=st.floats(0.0, 5.0), at_end=st.floats(0.0, 5.0))
def test_the_rest_of_a_shortened_road_lies_where_it_was(shape: str, at_start: float, at_end: float) -> None:
    text = SHAPED.format(shape=SHAPES[shape])
    document, before = read(text)
    edits = TextEdits(document)
    shorten_road(edits, document.root[1], before.tables, 0, at_start, at_end)
    _, after = read(edits.result())
    assert after.tables.road_length[0] == pytest.approx(40.0 - at_start - at_end, abs=1e-12)
    for s in (0.0, 3.0, 11.0, 17.5, 24.9, after.tables.road_length[0]):
        here, there = after.lane_pose("1", -1, s), before.lane_pose("1", -1, s + at_start)
        assert tuple(here) == pytest.approx(tuple(there), abs=1e-3 if shape in CURVES else 1e-9)


def read(text: str) -> tuple[Document, Network]:
    from scenario_compiler.roads.elements import RoadFile
    from scenario_compiler.roads.parse import read_network

    sink = Diagnostics()
    document = parse_document(text.encode(), "text.xodr", sink)
    assert document is not None
    parsed = read_network(RoadFile("text.xodr", text.encode()), sink)
    assert parsed is not None
    return document, Network("text.xodr", "", parsed)


def test_edits_keep_quotes_comments_and_encoding() -> None:
    text = "<?xml version='1.0'?>\n<a  b = 'x>y'><!-- <c/> --><c d='1'  /><e>é</e></a>\n"
    document = parse_document(text.encode(), "text.xml", Diagnostics())
    assert document is not None
    edits = TextEdits(document)
    edits.set(document.root, "b", "2 & 3")
    edits.set(document.root[1], "f", "new")
    edits.remove(document.root[2])
    assert edits.result() == "<?xml version='1.0'?>\n<a  b = \"2 &amp; 3\"><!-- <c/> --><c f=\"new\" d='1'  /></a>\n"
