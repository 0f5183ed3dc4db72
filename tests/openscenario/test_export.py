"""Exported files: valid in their version, and read back they run as the plan that they were made from."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from lxml import etree

from scenario_compiler.compiler import Compilation, Overrides, compile_target
from scenario_compiler.diagnostics import Diagnostics, Severity, as_text
from scenario_compiler.document import parse_document
from scenario_compiler.openscenario.export.files import export_files
from scenario_compiler.openscenario.export.kept import SAID
from scenario_compiler.openscenario.output import VERSIONS, Version
from scenario_compiler.openscenario.structure import check_structure
from scenario_compiler.plan.model import Plan
from scenario_compiler.plan.store import write_plan
from scenario_compiler.recording.recording import Recording
from scenario_compiler.runtime import open_world, run
from scenario_compiler.structure.schemas import find_schema
from scenario_compiler.vocabulary.grammar import grammar_of
from scenario_compiler.vocabulary.scenario import Scenario
from tests.asam import schemas_of_wheel
from tests.command import call

LIBRARY = Path(__file__).resolve().parents[2] / "library" / "conflicts"
SAMPLE = (
    "obstacle_ahead.xml#obstacle_ahead",
    "obstacle_variants.xml#cutting_in",
    "in_traffic.xml#jaywalker",
    "in_traffic.xml#van_in_traffic",
    "sensor_failure.xml#sensor_failure",
    "weather_and_works.xml#rain_begins",
)
"""Conflicts with a storyboard, a path, traffic, failures, weather."""

ALL = tuple(
    f"{path.name}#{scenario.get('name')}"
    for path in sorted(LIBRARY.glob("*.xml"))
    for scenario in etree.parse(str(path)).getroot().iterfind("scenario")
)
EITHER = [pytest.param(one, marks=() if one in SAMPLE else pytest.mark.slow) for one in ALL]


def compiled(target: str | Path) -> Compilation:
    sink = Diagnostics()
    compilation = compile_target(target, {}, sink, overrides=Overrides(perception="ideal"))
    assert compilation is not None, [as_text(one) for one in sink]
    return compilation


def exported(compilation: Compilation, folder: Path, version: Version) -> Path:
    """Write a plan and everything beside it as OpenSCENARIO; only warnings may be told."""
    sink = Diagnostics()
    path = folder / f"exported_{version[1]}.xosc"
    files = export_files(compilation.plan, compilation.network, path, version, sink, compilation.scenario)
    assert not sink.has_errors
    for file, content in files.items():
        file.write_bytes(content)
    return path


def recorded(compilation: Compilation) -> Recording:
    return run(compilation.plan, open_world("kinematic", compilation.plan, compilation.network))


def assert_same_course(one: Recording, other: Recording) -> None:
    """Entities, times and events agree, trajectories within 1e-6."""
    assert other.header.entities == one.header.entities
    assert np.array_equal(other.t, one.t)
    assert other.stop_reason == one.stop_reason
    assert [event[:3] for event in _told(other)] == [event[:3] for event in _told(one)]
    for column in ("x", "y", "z", "h", "v"):
        before, after = np.nan_to_num(getattr(one, column)), np.nan_to_num(getattr(other, column))
        assert np.abs(after - before).max() < 1e-6, column


def _told(recording: Recording) -> list[tuple[object, ...]]:
    return [(event.t, event.kind, event.entity) for event in recording.events]


@pytest.fixture(scope="session")
def schemas() -> Path:
    """Folder of ASAM's schemas of OpenSCENARIO XML."""
    return schemas_of_wheel("asam-qc-openscenarioxml", "qc_openscenario")


@pytest.mark.parametrize("target", EITHER)
def test_exported_file_has_the_structure_of_its_version(target: str, tmp_path: Path) -> None:
    compilation = compiled(LIBRARY / target)
    for version in VERSIONS:
        exported(compilation, tmp_path, version)
        for path in tmp_path.glob("*.xosc"):
            sink = Diagnostics()
            document = parse_document(path.read_bytes(), str(path), sink)
            assert document is not None
            check_structure(document, sink)
            assert [as_text(one) for one in sink] == []


@pytest.mark.parametrize("target", EITHER)
def test_exported_file_follows_the_schema_of_its_version(target: str, tmp_path: Path, schemas: Path) -> None:
    compilation = compiled(LIBRARY / target)
    for version in VERSIONS:
        schema = find_schema(schemas, "OpenSCENARIO", version[1])
        assert schema is not None
        exported(compilation, tmp_path, version)
        for path in tmp_path.glob(f"*_{version[1]}*.xosc"):
            etree.XMLSchema(etree.parse(str(schema))).assertValid(etree.parse(str(path)))


@pytest.mark.parametrize("target", EITHER)
def test_exported_file_runs_as_the_plan_does(target: str, tmp_path: Path) -> None:
    compilation = compiled(LIBRARY / target)
    before = recorded(compilation)
    for version in (VERSIONS[0], VERSIONS[-1]):
        again = compiled(exported(compilation, tmp_path, version))
        assert again.plan.takeover == compilation.plan.takeover
        assert again.plan.controller == compilation.plan.controller
        assert again.plan.criteria == compilation.plan.criteria
        assert_same_course(before, recorded(again))


ADDED = """<scenarios version="1"><scenario name="added" map="town_grid" duration="4">
  <parameter name="pace" type="speed" default="7"/>
  <ego speed="5"><start><lane road="1" lane="-1" s="20"/></start></ego>
  <static id="box"><at><lane road="1" lane="-1" s="130"/></at></static>
  <dynamic id="later" speed="$pace"><follow time_gap="1"/><when><time after="1"/><do>
    <add_entity entity="later"><lane road="1" lane="-1" s="80"/></add_entity>
  </do></when></dynamic>
</scenario></scenarios>"""


@pytest.mark.parametrize("version", VERSIONS)
def test_an_actor_that_is_added_keeps_its_speed_and_its_following(tmp_path: Path, version: Version) -> None:
    path = tmp_path / "added.xml"
    path.write_text(ADDED, encoding="utf-8")
    compilation = compiled(path)
    before = recorded(compilation)
    assert before.v[-1, 2] > 3.0
    assert_same_course(before, recorded(compiled(exported(compilation, tmp_path, version))))


@pytest.mark.parametrize("target", EITHER)
def test_no_text_looks_like_a_parameter(target: str, tmp_path: Path) -> None:
    """Esmini 3.6 evaluates `$` in the text of a CustomCommandAction, and ends where it has no meaning."""
    compilation = compiled(LIBRARY / target)
    for version in VERSIONS:
        root = etree.parse(str(exported(compilation, tmp_path, version))).getroot()
        assert not [one.text for one in root.iter() if "$" in (one.text or "")]


def test_parameters_stay_open(tmp_path: Path) -> None:
    path = exported(compiled(LIBRARY / "obstacle_ahead.xml#obstacle_ahead"), tmp_path, (1, 3))
    properties = etree.parse(str(path)).getroot().iter("Property")
    assert not any("$" in str(one.get("value")) for one in properties), "other programs would look for a parameter"
    sink = Diagnostics()
    moved = compile_target(path, {"distance": "150"}, sink, overrides=Overrides(perception="ideal"))
    meant = compile_target(
        LIBRARY / "obstacle_ahead.xml#obstacle_ahead",
        {"distance": "150"},
        sink,
        overrides=Overrides(perception="ideal"),
    )
    assert moved is not None
    assert meant is not None
    assert_same_course(recorded(meant), recorded(moved))


def test_changes_in_the_exported_file_take_effect(tmp_path: Path) -> None:
    """An action that was kept word for word, and one that was not, are both changed in the file."""
    path = exported(compiled(LIBRARY / "obstacle_variants.xml#cutting_in"), tmp_path, (1, 3))
    text = path.read_text(encoding="utf-8")
    assert '<RelativeTargetLane entityRef="cut_in1.car" value="-1"/>' in text
    text = text.replace('<RelativeTargetLane entityRef="cut_in1.car" value="-1"/>', '<AbsoluteTargetLane value="-1"/>')
    text = text.replace('<AbsoluteTargetSpeed value="13.9"/>', '<AbsoluteTargetSpeed value="12.5"/>')
    path.write_text(text, encoding="utf-8")
    plan = compiled(path).plan
    group = plan.storyboard.stories[0].acts[0].groups[0]
    actions = [one.action for maneuver in group.maneuvers for event in maneuver.events for one in event.actions]
    assert "lane_change_to" in {action.tag() for action in actions}
    assert plan.ego.speed == 12.5


def test_blueprints_are_the_names_of_vehicles(tmp_path: Path) -> None:
    path = exported(compiled(LIBRARY / "obstacle_ahead.xml#obstacle_ahead"), tmp_path, (1, 0))
    root = etree.parse(str(path)).getroot()
    ego = root.find("Entities/ScenarioObject[@name='ego']/Vehicle")
    assert ego is not None
    assert ego.get("name") == "vehicle.audi.tt"
    assert ego.find("Properties/Property[@name='type'][@value='ego_vehicle']") is not None
    assert root.find("RoadNetwork/LogicFile").get("filepath") == "town_grid.xodr"  # type: ignore[union-attr]


def test_parts_that_cannot_be_expressed_are_reported() -> None:
    compilation = compiled(LIBRARY / "in_traffic.xml#van_in_traffic")
    for version, more in (((1, 0), "<ParameterValueDistribution> is not known before 1.1"), ((1, 3), "<triangular>")):
        sink = Diagnostics()
        export_files(compilation.plan, compilation.network, Path("out.xosc"), version, sink, compilation.scenario)
        told = [one.message for one in sink]
        assert {one.code.id for one in sink} == {"SC783"}
        assert all(one.severity is Severity.WARNING for one in sink)
        assert any(more in one for one in told), told
        assert "background traffic is kept as properties" in told


def test_a_plan_is_exported_like_its_scenario(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    target = LIBRARY / "sensor_failure.xml#sensor_failure"
    compilation = compiled(target)
    write_plan(compilation.plan, tmp_path / "plan.json")
    for source, out in ((str(target), "a"), (str(tmp_path / "plan.json"), "b")):
        more = [] if source.endswith(".json") else ["--perception", "ideal"]
        assert call("export", source, "-o", tmp_path / out / "out.xosc", *more) == 0
    assert (tmp_path / "a" / "out.xosc").read_bytes() == (tmp_path / "b" / "out.xosc").read_bytes()
    assert "out.xosc" in capsys.readouterr().out


def test_every_part_of_a_plan_is_written_or_kept() -> None:
    """A part that is added to scenarios and plans under one name is kept by itself; any other has to be seen to."""
    kept = {rule.field for rule in grammar_of(Scenario).children} & set(Plan.model_fields) - set(SAID)
    elsewhere = {
        "summary",
        "forward_sensor",
        "odometry",
        "step",
        "control_every",
        "duration",
        "entities",
        "camera",
        "controller",
        "destination",
    }
    not_kept = {"format", "name", "map", "perception", "route", "derived", "origins", "digest"}
    assert set(Plan.model_fields) == kept | set(SAID) | elsewhere | not_kept


def test_files_that_differ_are_not_written_over(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    target, out = str(LIBRARY / "sensor_failure.xml#sensor_failure"), tmp_path / "out.xosc"
    out.write_text("mine", encoding="utf-8")
    for more, code in (((), 2), (("--force",), 0), ((), 0)):
        assert call("export", target, "-o", out, *more) == code
    assert "--force" in capsys.readouterr().err
