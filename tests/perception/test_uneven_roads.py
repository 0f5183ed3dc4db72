"""Where the road ahead is no plane, the map's heights, banks and widths say where the boundaries are."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from scenario_compiler.engine.simulation import Outlook
from scenario_compiler.perception.calibration.truth import Truth
from scenario_compiler.perception.course import Course
from scenario_compiler.perception.lane_detector import ClassicalLaneDetector, LaneResult, LaneState
from scenario_compiler.perception.road_camera import RoadCamera
from scenario_compiler.perception.route_ahead import WayPoint
from scenario_compiler.perception.scene import Scene
from scenario_compiler.roads import Network
from scenario_compiler.roads.mesh import road_marks, road_surface
from tests.engine.test_outlook import outlook_at_the_start
from tests.perception.scenery import CLEAR
from tests.roads.make import lane, network, road, section

DETECTOR = ClassicalLaneDetector()

FILE = """<scenarios version="1"><scenario name="uneven" map="made.xodr" duration="2" summary="An uneven road">
  <ego speed="5"><start><lane road="1" lane="{lane}" s="{s}"/></start></ego>
</scenario></scenarios>"""

SOLID = '<roadMark sOffset="0" type="solid" width="0.15" color="white"/>'
WIDTH = '<width sOffset="0" a="{a}" b="{b}" c="0" d="0"/>'
BEND = '<geometry s="0" x="0" y="0" hdg="0" length="{length}"><arc curvature="{curvature}"/></geometry>'


def crest(begin: float, radius: float, fall: float) -> str:
    """Return an elevation that is level, changes its grade with a radius, and then falls by so much a metre."""
    length, half = radius * fall, -0.5 / radius
    return (
        '<elevationProfile><elevation s="0" a="0" b="0" c="0" d="0"/>'
        f'<elevation s="{begin}" a="0" b="0" c="{half}" d="0"/>'
        f'<elevation s="{begin + length}" a="{half * length * length}" b="{-fall}" c="0" d="0"/></elevationProfile>'
    )


def twisted(begin: float, rise: float) -> str:
    """Return a superelevation that grows by so much a metre, rad/m."""
    return (
        '<lateralProfile><superelevation s="0" a="0" b="0" c="0" d="0"/>'
        f'<superelevation s="{begin}" a="0" b="{rise}" c="0" d="0"/></lateralProfile>'
    )


def made(folder: Path, more: str = "", curvature: float = 0.0, width: str = WIDTH.format(a=3.5, b=0)) -> Network:
    """Return a road of 120 m with a painted lane each way."""
    lanes = section(lane(1, width + SOLID), lane(-1, width + SOLID), centre=SOLID)
    return network(folder, road("1", 120.0, BEND.format(length=120.0, curvature=curvature), lanes, more=more))


def outlook(folder: Path, number: int, s: float) -> Outlook:
    """Return what the ego's controller receives at a place of road 1."""
    path = folder / "uneven.xml"
    path.write_text(FILE.format(lane=number, s=s), encoding="utf-8")
    return outlook_at_the_start(path)


def seen(folder: Path, net: Network, s: float, told: bool) -> tuple[Truth, LaneResult]:
    """Return truth and result in lane -1 after four images at a place, with the map or with the images alone."""
    pose = net.road_pose("1", s, -1.75)
    camera = RoadCamera(Scene(road_surface(net), road_marks(net)))
    view = camera.view(pose)
    image = camera.frame(pose, [], CLEAR, 0.0, 0)
    ahead = outlook(folder, -1, s)
    foot = camera.box_offset + DETECTOR.camera.x
    points = zip(ahead.way, ahead.widths, ahead.heights, ahead.banks, strict=True)
    way = [WayPoint(x - foot, y, *of_map) for (x, y), *of_map in points]
    state = LaneState()
    for _ in range(4):
        found = DETECTOR.detect(image, replace(state, way=Course.along(way) if told else None))
        state = state.after(found)
    along = np.arange(s - 5.0, s + 40.0, 0.5)
    borders = [np.array([net.road_pose("1", float(at), t)[:3] for at in along]) for t in (0.0, -3.5)]
    return Truth.of(view, borders[0], borders[1], (1.0, 1.0)), found


@pytest.mark.parametrize("number", [-1, 1])
def test_the_route_knows_how_the_road_rises(tmp_path: Path, number: int) -> None:
    made(tmp_path, crest(55.0, 200.0, 0.08) + twisted(50.0, 0.004))
    ahead = outlook(tmp_path, number, 50.0)
    sense = 1.0 if number < 0 else -1.0
    k = np.arange(len(ahead.way))
    s = 50.0 + sense * k
    rise = np.where(s < 55.0, 0.0, np.where(s < 71.0, -((s - 55.0) ** 2) / 400.0, -0.64 - 0.08 * (s - 71.0)))
    twist = np.maximum(s - 50.0, 0.0) * 0.004
    assert np.array(ahead.heights) == pytest.approx(rise - sense * 1.75 * np.sin(twist), abs=0.01)
    assert np.array(ahead.banks) == pytest.approx(sense * twist, abs=0.002)


def test_the_route_knows_how_wide_its_lane_is(tmp_path: Path) -> None:
    made(tmp_path, width=WIDTH.format(a=3.0, b=0.02))
    ahead = outlook(tmp_path, -1, 40.0)
    assert np.array(ahead.widths) == pytest.approx(3.0 + 0.02 * (40.0 + np.arange(len(ahead.widths))))


@pytest.mark.parametrize("curvature", [0.0, -1.0 / 18.0])
def test_behind_a_crest_boundaries_are_where_the_map_has_the_road(tmp_path: Path, curvature: float) -> None:
    net = made(tmp_path, crest(40.0, 120.0, 0.1), curvature)
    wrong = {
        told: [
            max(truth.error(0, found.left), truth.error(1, found.right))
            for truth, found in (seen(tmp_path, net, s, told) for s in (34.0, 38.0, 44.0))
        ]
        for told in (True, False)
    }
    assert max(wrong[True]) < 0.25
    assert max(wrong[False]) > 0.25


def test_the_tilt_is_that_against_the_ground_ahead(tmp_path: Path) -> None:
    """With the map's heights or without, a result says how the camera is tilted against what lies before it."""
    net = made(tmp_path, crest(40.0, 400.0, 0.06))
    for told in (True, False):
        truth, found = seen(tmp_path, net, 34.0, told)
        assert math.degrees(found.tilt.pitch) == pytest.approx(math.degrees(truth.tilt), abs=0.3)


def test_in_a_twisted_bend_boundaries_are_where_the_map_has_the_road(tmp_path: Path) -> None:
    net = made(tmp_path, twisted(40.0, 0.006), 1.0 / 50.0)
    for s in (36.0, 44.0):
        truth, found = seen(tmp_path, net, s, told=True)
        assert max(truth.error(0, found.left), truth.error(1, found.right)) < 0.25
