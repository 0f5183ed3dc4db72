"""Tools for authors: the list of the library, new conflicts, the preview of a plan, the gallery."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np
import pytest

from scenario_compiler.compiler import Compilation, compile_target
from scenario_compiler.diagnostics import Diagnostics, as_text
from scenario_compiler.listing import Listed, list_library
from scenario_compiler.plan.model import Plan, RouteLeg, StartPose
from scenario_compiler.report.gallery import Card, Moment, shrunk, start_picture, write_gallery
from scenario_compiler.report.happenings import happenings_of, last_known_time
from scenario_compiler.report.preview import SPACING, draw_preview, draw_route, labels_of, section_of, way_ahead
from scenario_compiler.resources import library_conflicts, library_folder
from scenario_compiler.roads import Network, load_network
from scenario_compiler.roads.lane_types import is_drivable
from scenario_compiler.roads.positions import LanePosition
from scenario_compiler.source.authoring import new_conflict
from scenario_compiler.validation import validate_file
from scenario_compiler.vocabulary.actions import MessageAction
from scenario_compiler.vocabulary.conditions import SimulationTimeCondition
from scenario_compiler.vocabulary.storyboard import (
    Act,
    ConditionGroup,
    Event,
    Maneuver,
    ManeuverGroup,
    Story,
    StoryAction,
    Storyboard,
    Trigger,
    TriggerCondition,
)
from tests.recording.made import plan_of

LIBRARY = library_folder()
TEMPLATES = [one for one in list_library(LIBRARY / "templates", Diagnostics()) if one.kind == "template"]


def _compiled(target: str) -> Compilation:
    sink = Diagnostics()
    compilation = compile_target(target, {}, sink)
    assert compilation is not None, [as_text(one) for one in sink]
    return compilation


@pytest.fixture(scope="module")
def swerving() -> Compilation:
    return _compiled(f"{LIBRARY / 'conflicts/r157_situations.xml'}#swerving_leader")


@pytest.fixture(scope="module")
def crossing() -> Compilation:
    return _compiled(f"{LIBRARY / 'conflicts/r157_situations.xml'}#pedestrian")


def test_the_list_has_the_whole_library_in_order() -> None:
    sink = Diagnostics()
    rows = list(list_library(LIBRARY, sink))
    assert not list(sink)
    assert sum(row.kind == "conflict" for row in rows) >= 40
    assert sum(row.kind == "template" for row in rows) >= 20
    assert all(row.summary and row.source for row in rows)
    (ramp,) = [row for row in rows if row.name == "ramp_blocked"]
    assert (ramp.map, ramp.gold) == ("highway_loop", "5")
    assert [one.name for one in ramp.parameters] == ["spacing"]
    assert rows == list(list_library(LIBRARY, Diagnostics()))
    assert library_conflicts() == {row.name: row.file for row in rows if row.kind == "conflict"}


def test_a_listed_conflict_can_be_run_by_its_target() -> None:
    rows = [row for row in list_library(LIBRARY / "conflicts/road_narrows.xml", Diagnostics())]
    assert [_compiled(row.target).plan.name for row in rows] == ["road_narrows"]


def test_an_unreadable_file_is_reported_and_skipped(tmp_path: Path) -> None:
    (tmp_path / "a.xml").write_text("<scenarios", encoding="utf-8")
    (tmp_path / "b.xml").write_text(
        '<scenarios version="1"><template name="mine" summary="Mine"/></scenarios>', encoding="utf-8"
    )
    sink = Diagnostics()
    assert [row.name for row in list_library(tmp_path, sink)] == ["mine"]
    assert [one.code.id for one in sink] == ["SC102"]


def test_openscenario_is_listed_with_what_it_varies(tmp_path: Path) -> None:
    road = '<RoadNetwork><LogicFile filepath="../maps/bends.xodr"/></RoadNetwork>'
    (tmp_path / "it.xosc").write_text(
        '<OpenSCENARIO><FileHeader revMajor="1" revMinor="2" date="2026-01-01T00:00:00" description="It" author="Us"/>'
        f"{road}<Entities/><Storyboard/></OpenSCENARIO>",
        encoding="utf-8",
    )
    single = (
        '<DeterministicSingleParameterDistribution parameterName="{}">{}</DeterministicSingleParameterDistribution>'
    )
    listed = single.format("gap", '<DistributionSet><Element value="1"/><Element value="2"/></DistributionSet>')
    car = single.format("car", '<DistributionSet><Element value="a,b"/><Element value="c"/></DistributionSet>')
    (tmp_path / "values.xosc").write_text(
        '<OpenSCENARIO><FileHeader revMajor="1" revMinor="2" date="2026-01-01T00:00:00" description="" author=""/>'
        '<ParameterValueDistribution><ScenarioFile filepath="it.xosc"/>'
        f"<Deterministic>{listed}{car}</Deterministic></ParameterValueDistribution></OpenSCENARIO>",
        encoding="utf-8",
    )
    sink = Diagnostics()
    plain, values = list_library(tmp_path, sink)
    assert not list(sink)
    assert (plain.name, plain.map, plain.summary, plain.source, plain.varied) == ("it", "bends", "It", "Us", ())
    assert (values.name, values.map, values.summary) == ("values", "bends", "varies it.xosc")
    assert values.varied == (("gap", "values(1, 2)"), ("car_number 0", "car = a,b"), ("car_number 1", "car = c"))


def test_a_conflict_is_listed_with_what_it_varies(tmp_path: Path) -> None:
    (tmp_path / "it.xml").write_text(
        '<scenarios version="1"><scenario name="it" map="town_grid"><parameter name="gap" type="time" default="2"/>'
        '<vary><uniform parameter="gap" least="1" greatest="3"/></vary></scenario></scenarios>',
        encoding="utf-8",
    )
    (row,) = list_library(tmp_path, Diagnostics())
    assert row.varied == (("gap", "uniform(1, 3)"),)


@pytest.mark.parametrize("template", TEMPLATES, ids=lambda row: row.name)
def test_a_new_conflict_is_valid(template: Listed, tmp_path: Path) -> None:
    path = tmp_path / "mine.xml"
    path.write_text(new_conflict("mine", template.name, template.summary, template.parameters), encoding="utf-8")
    sink = Diagnostics()
    validate_file(path, sink)
    assert [as_text(one) for one in sink] == []
    text = path.read_text(encoding="utf-8")
    for parameter in template.parameters:
        assert f"<!-- {parameter.name} (" in text


def test_the_preview_shows_actors_and_triggers(swerving: Compilation, tmp_path: Path) -> None:
    for name in ("first.svg", "second.svg"):
        draw_preview(swerving.plan, swerving.network, tmp_path / name)
    first = (tmp_path / "first.svg").read_text(encoding="utf-8")
    assert first == (tmp_path / "second.svg").read_text(encoding="utf-8")
    assert "swerving_leader1.leader" in first
    assert "5.5 s" in first
    draw_preview(swerving.plan, swerving.network, tmp_path / "it.png")
    image = cv2.imread(str(tmp_path / "it.png"))
    assert image is not None
    assert image.std() > 10.0


def test_triggers_are_described_in_words(swerving: Compilation, crossing: Compilation) -> None:
    assert [one.time for one in happenings_of(swerving.plan)] == [3.0, 5.5, 8.0, 10.5]
    (crosses,) = happenings_of(crossing.plan)
    assert crosses.time is None
    assert crosses.trigger == "time gap of ego to crossing_pedestrian1.walker below 3 s"
    assert crosses.label.startswith("crossing_pedestrian1.walker: speed to 1.4 m/s and lane change by 5")


def test_openscenario_triggers_are_described_up_to_the_last_known_time() -> None:
    plan = _compiled(str(Path(__file__).parent / "benchmarks/scripted.xosc")).plan
    told = list(happenings_of(plan))
    assert told[1].label == "cutting: Speed to 26 m/s over 4 s sinusoidal"
    assert told[1].trigger == (
        "TimeHeadway of first to cutting > 0.9 s freespace and SimulationTime > 9 s or SimulationTime > 14 s"
    )
    assert told[-1].label == "end of the run"
    assert told[-1].trigger == "SimulationTime > 30 s or Collision of first with ahead"
    assert plan.duration == 600.0
    assert last_known_time(plan) == 16.0


@pytest.mark.parametrize(
    ("act", "event", "stop", "times", "last"),
    [
        (2.0, None, None, [2.0], 30.0),
        (2.0, 5.0, 9.0, [5.0, 9.0], 9.0),
        (6.0, 5.0, None, [6.0], 30.0),
    ],
)
def test_an_event_comes_after_its_act_begins(
    crossing: Compilation, act: float, event: float | None, stop: float | None, times: list[float], last: float
) -> None:
    done = Event(name="it", start=_at(event), actions=(StoryAction(name="it", action=MessageAction(text="go")),))
    group = ManeuverGroup(name="it", maneuvers=(Maneuver(name="it", events=(done,)),))
    board = Storyboard(
        stories=(Story(name="it", acts=(Act(name="it", start=_at(act), groups=(group,)),)),), stop=_at(stop)
    )
    plan = crossing.plan.model_copy(update={"storyboard": board, "duration": 30.0})
    assert [one.time for one in happenings_of(plan)] == times
    assert last_known_time(plan) == last


def _at(time: float | None) -> Trigger | None:
    if time is None:
        return None
    condition = TriggerCondition(condition=SimulationTimeCondition(after=time))
    return Trigger(groups=(ConditionGroup(conditions=(condition,)),))


def test_a_row_is_labelled_once() -> None:
    names = ["ego", "works1.cones.1", "works1.cones.2", "ramp1.queue.1.car", "ramp1.queue.2.car"]
    assert labels_of(names) == {"ego": "ego", "works1.cones.1": "works1.cones", "ramp1.queue.1.car": "ramp1.queue.car"}


def test_the_section_holds_every_start(crossing: Compilation) -> None:
    window = section_of(crossing.plan, crossing.network)
    for pose in crossing.plan.derived.values():
        assert window.x_min < pose.x < window.x_max
        assert window.y_min < pose.y < window.y_max


def test_the_path_ahead_follows_the_route(crossing: Compilation, tmp_path: Path) -> None:
    way = np.array(way_ahead(crossing.plan, crossing.network))
    length = np.hypot(*np.diff(way, axis=0).T).sum()
    assert length == pytest.approx(sum(abs(leg.s_to - leg.s_from) for leg in crossing.plan.route), rel=0.01)
    draw_route(crossing.plan, crossing.network, tmp_path / "route.svg")
    assert f"route of {length:.0f} m" in (tmp_path / "route.svg").read_text(encoding="utf-8")


def road_files(repository: Path) -> list[Path]:
    towns = Path(os.environ.get("SCENARIO_COMPILER_CORPUS", repository / "none")) / "Scenic/assets/maps/CARLA"
    return [*sorted(repository.glob("maps/*/*.xodr")), *sorted(towns.glob("*.xodr"))]


def starts_of(network: Network) -> Iterator[LanePosition]:
    """Yield the entry, the middle and the exit of each section of each lane that motor traffic may use."""
    n = network.tables
    for row, section in enumerate(n.lane_section):
        if n.lane_id[row] and is_drivable(n.lane_type[row]):
            begin, end = n.section_s[section], n.section_end[section]
            for s in (begin, 0.5 * (begin + end), math.nextafter(end, begin)):
                yield LanePosition(network.road_ids[n.section_road[section]], n.lane_id[row], s)


def ways_on(network: Network, plan: Plan) -> Iterator[tuple[Plan, LanePosition]]:
    """Yield plans straight on from every start, and plans with a route from some to others."""
    starts = list(starts_of(network))
    for start in starts:
        pose = network.lane_pose(start.road, start.lane, start.s)
        derived = {plan.entities[0].id: StartPose(x=pose.x, y=pose.y, z=pose.z, heading=pose.heading)}
        yield plan.model_copy(update={"route": (), "derived": derived}), start
    for k, start in enumerate(starts[::29]):
        route = network.route(start, starts[(k * 7919) % len(starts)])
        if route is not None:
            legs = tuple(RouteLeg(road=one.road, lane=one.lane, s_from=one.s_from, s_to=one.s_to) for one in route.legs)
            yield plan.model_copy(update={"route": legs}), start


@pytest.mark.slow
def test_every_lane_of_a_town_has_a_path_ahead_without_gaps(repository: Path) -> None:
    """Also where a route changes lanes at the border of two lane sections that number their lanes differently."""
    for file in road_files(repository):
        network = load_network(file)
        assert network is not None
        for plan, start in ways_on(network, plan_of("ego")):
            way = np.array(way_ahead(plan, network))
            steps = np.hypot(*np.diff(way, axis=0).T) if len(way) > 1 else np.zeros(1)
            assert steps.max() < 4 * SPACING, (file.name, start)


def test_a_picture_of_another_kind_is_refused(crossing: Compilation, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"\.jpg"):
        draw_preview(crossing.plan, crossing.network, tmp_path / "it.jpg")


def test_the_gallery_is_small_and_always_the_same(crossing: Compilation, tmp_path: Path) -> None:
    picture = start_picture(crossing.plan, crossing.network)
    assert picture == start_picture(crossing.plan, crossing.network)
    assert len(picture) < 60_000
    moment = Moment("takeover request after 3 s", "path blocked", picture)
    cards = [Card("UN R157", "a<b", "It crosses", "A source", "scenario-compiler run a", "town", moment)]
    write_gallery(cards, tmp_path / "gallery.html")
    page = (tmp_path / "gallery.html").read_text(encoding="utf-8")
    assert "a&lt;b" in page
    assert "data:image/png;base64," in page
    assert "http" not in page


def test_shrinking_takes_means() -> None:
    image = np.zeros((6, 9, 3), np.uint8)
    image[:3, :3] = 200
    assert shrunk(image, 3)[:, :, 0].tolist() == [[200, 0, 0], [0, 0, 0]]
