"""Paint that a scenario changes or adds: from the file to the camera's picture."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from scenario_compiler import open_world
from scenario_compiler.compiler import Compilation, compile_target
from scenario_compiler.diagnostics import Diagnostics, as_text
from scenario_compiler.perception.road_camera import RoadCamera, scene_of
from scenario_compiler.plan.model import Plan
from scenario_compiler.plan.painted import lines_beside, mark_stretches, secondary_lines
from scenario_compiler.roads import MarkStretch, Pose, SecondaryLine
from scenario_compiler.vocabulary.markings import SecondaryMarkings
from scenario_compiler.worlds import EntityState, Snapshot

HEAD = """<scenarios version="1"><scenario name="paint" map="town_grid" duration="5">
<parameter name="side" type="length" default="-1.5"/>
<ego speed="5"><start><lane road="1" lane="-1" s="100"/></start></ego>"""
LINE = '<secondary_markings road="1" from="90" to="160" t="$side"/>'


def compiled(folder: Path, body: str) -> Compilation:
    path = folder / "paint.xml"
    path.write_text(f"{HEAD}{body}</scenario></scenarios>", encoding="utf-8")
    sink = Diagnostics()
    done = compile_target(path, {}, sink)
    assert done is not None, [as_text(one) for one in sink]
    return done


def picture(done: Compilation) -> NDArray[np.int64]:
    """Return what the camera at the start sees, (height, width, 3), BGR."""
    painted = done.network.with_mark_quality(mark_stretches(done.plan))
    camera = RoadCamera(scene_of(painted, secondary_lines(done.plan)))
    pose = done.network.lane_pose("1", -1, 100.0)
    return camera.frame(pose, (), done.plan.weather, 0.0, 0).astype(np.int64)


def yellow(image: NDArray[np.int64]) -> NDArray[np.bool_]:
    return image[..., 2] - image[..., 0] > 70


def white(image: NDArray[np.int64]) -> NDArray[np.bool_]:
    return np.asarray((image.min(axis=-1) > 180) & (np.ptp(image, axis=-1) < 40), dtype=np.bool_)


def test_the_plan_carries_the_line_and_its_digest_knows_it(tmp_path: Path) -> None:
    without, done = compiled(tmp_path, ""), compiled(tmp_path, LINE)
    line = done.plan.secondary_markings[0]
    assert isinstance(line, SecondaryMarkings)
    assert (line.road, line.s_from, line.s_to, line.colour, line.type) == ("1", 90.0, 160.0, "yellow", "solid")
    assert [parameter.name for parameter in done.plan.parameters] == ["side"]
    assert secondary_lines(done.plan) == [SecondaryLine("1", 90.0, 160.0, -1.5, "yellow", False, 0.12, 1.0)]
    assert done.plan.digest != without.plan.digest
    assert Plan.model_validate_json(done.plan.model_dump_json()).secondary_markings == (line,)


def test_a_colour_alone_leaves_the_quality(tmp_path: Path) -> None:
    done = compiled(tmp_path, '<markings road="1" from="100" to="160" colour="orange"/>')
    assert mark_stretches(done.plan) == [MarkStretch("1", None, 100.0, 160.0, None, None, "orange")]


def test_a_secondary_line_lies_beside_the_old_paint(tmp_path: Path) -> None:
    before, after = picture(compiled(tmp_path, "")), picture(compiled(tmp_path, LINE))
    rows = slice(before.shape[0] * 2 // 3, None)
    assert not yellow(before).any()
    assert yellow(after[rows]).sum() > 200
    columns = np.nonzero(yellow(after))[1]
    paint = np.nonzero(white(before[rows]))[1]
    assert paint.min() < columns.min()
    assert columns.max() < paint.max()
    assert (white(after) & white(before)).sum() > 0.95 * white(before).sum()


def test_a_stretch_repaints_the_marks(tmp_path: Path) -> None:
    before = picture(compiled(tmp_path, ""))
    after = picture(compiled(tmp_path, '<markings road="1" from="90" to="160" colour="yellow"/>'))
    rows = slice(before.shape[0] * 2 // 3, None)
    old = white(before[rows])
    assert old.sum() > 200
    assert (yellow(after[rows]) & old).sum() > 0.9 * old.sum()


@pytest.mark.parametrize("attributes", ['t="0" type="double"', 't="0" colour="pink"', 't="0" quality="2"', ""])
def test_faulty_lines_are_reported(tmp_path: Path, attributes: str) -> None:
    path = tmp_path / "wrong.xml"
    body = f'<{SecondaryMarkings.tag()} road="1" from="90" to="160" {attributes}/>'
    path.write_text(f"{HEAD}{body}</scenario></scenarios>", encoding="utf-8")
    sink = Diagnostics()
    assert compile_target(path, {}, sink) is None
    assert sink.has_errors


ZONE = """<work_zone id="works" length="40" taper="10" across="1.2" spacing="5" sign_before="0" line="true">
<at>{at}</at></work_zone>"""


@pytest.mark.parametrize(
    ("at", "ends", "t"),
    [
        ('<lane road="1" lane="-1" s="120" offset="-1.6"/>', (130.0, 170.0), -1.75 - 1.6 + 1.2 + 0.4),
        ('<ahead_of entity="ego" distance="20" offset="-1.6"/>', (130.0, 170.0), -1.75 - 1.6 + 1.2 + 0.4),
        ('<lane road="1" lane="1" s="200" offset="1.6"/>', (150.0, 190.0), 1.75 + 1.6 - 1.2 - 0.4),
    ],
)
def test_the_line_of_a_work_zone_runs_along_its_cones(
    tmp_path: Path, at: str, ends: tuple[float, float], t: float
) -> None:
    done = compiled(tmp_path, ZONE.format(at=at))
    poses = [done.plan.derived[entity.id] for entity in done.plan.entities]
    (line,) = lines_beside(done.plan, done.network, [Pose(p.x, p.y, p.z, p.heading, 0.0, 0.0) for p in poses])
    assert (line.road, line.colour, line.broken) == ("1", "yellow", False)
    assert (line.s_from, line.s_to, line.t) == pytest.approx((*ends, t), abs=1e-6)


def test_the_camera_sees_the_line_of_a_work_zone(tmp_path: Path) -> None:
    zone = ZONE.format(at='<lane road="1" lane="-1" s="105" offset="-1.6"/>')
    seen = []
    for body in (zone, zone.replace(' line="true"', "")):
        done = compiled(tmp_path, body)
        world = open_world("kinematic", done.plan, done.network)
        poses = [done.plan.derived[entity.id] for entity in done.plan.entities]
        placed = tuple(Pose(p.x, p.y, p.z, p.heading, 0.0, 0.0) for p in poses)
        snapshot = Snapshot(0.0, 0, tuple(EntityState(True, True, pose) for pose in placed))
        world.reset(snapshot, 1)
        seen.append(int(yellow(world.observe(snapshot).image.astype(np.int64)).sum()))
    assert seen[0] > seen[1] + 50


def test_a_line_beside_an_unknown_entity_is_a_fault(tmp_path: Path) -> None:
    path = tmp_path / "paint.xml"
    path.write_text(f'{HEAD}<line_beside entity="nobody" to="9"/></scenario></scenarios>', encoding="utf-8")
    sink = Diagnostics()
    assert compile_target(path, {}, sink) is None
    assert [(one.code.id, one.place.line) for one in sink] == [("SC222", 3)]
