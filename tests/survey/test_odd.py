"""The conditions of a scenario as tags: each is set if the plan or its map has it, and only then."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from scenario_compiler.compiler import Compilation, Overrides, compile_target
from scenario_compiler.diagnostics import Diagnostics, as_text
from scenario_compiler.survey.odd import TERMS, Tags, tags_of
from scenario_compiler.survey.openlabel import ONTOLOGY, openlabel_of

EGO = '<ego speed="12"><start><spawn_point name="{start}"/></start></ego>'


def compiled(folder: Path, body: str = "", *, start: str = "main_street", **attributes: str) -> Compilation:
    """Return the plan of a scenario with a body."""
    given = {"map": "town_grid", "duration": "20", **attributes}
    head = " ".join(f'{name}="{value}"' for name, value in given.items())
    path = folder / "odd.xml"
    path.write_text(
        f'<scenarios version="1"><scenario name="odd" {head}>{EGO.format(start=start)}{body}</scenario></scenarios>',
        encoding="utf-8",
    )
    sink = Diagnostics()
    done = compile_target(path, {}, sink, overrides=Overrides(perception="ideal"))
    assert done is not None, [as_text(one) for one in sink]
    return done


def tags(folder: Path, body: str = "", **options: str) -> Tags:
    """Return the tags of a scenario with a body."""
    done = compiled(folder, body, **options)
    return tags_of(done.plan, done.network)


def test_the_road_is_that_of_the_map(tmp_path: Path) -> None:
    town, motorway = tags(tmp_path), tags(tmp_path, map="highway_loop", start="straight")
    assert {"TransversePavements", "TransverseUndivided", "TravelDirectionRight", "LaneTypeTraffic"} <= set(town)
    assert town["LaneSpecificationLaneCount"] == (("lanes in the direction of travel", 1.0),)
    assert town["LaneSpecificationDimensions"] == (("width, m", 3.5),)
    assert "RoadTypeMotorway" in motorway
    assert not {"RoadTypeMotorway", "RoadTypeSlip"} & set(town)
    assert not {"TransversePavements", "TransverseUndivided"} & set(motorway)
    assert motorway["LaneSpecificationLaneCount"] == (("lanes in the direction of travel", 2.0),)


def test_a_route_through_a_junction_crosses_an_intersection(tmp_path: Path) -> None:
    places = """<start><spawn_point name="main_street"/></start>
      <destination><lane road="2" lane="-1" s="120"/></destination>"""
    path = tmp_path / "through.xml"
    path.write_text(
        '<scenarios version="1"><scenario name="s" map="town_grid">'
        f'<ego speed="9">{places}</ego></scenario></scenarios>',
        encoding="utf-8",
    )
    done = compile_target(path, {}, Diagnostics(), overrides=Overrides(perception="ideal"))
    assert done is not None
    assert any(done.network.road(leg.road).junction for leg in done.plan.route)
    assert "JunctionIntersection" in tags_of(done.plan, done.network)
    assert "JunctionIntersection" not in tags(tmp_path)


@pytest.mark.parametrize(
    ("weather", "there", "absent"),
    [
        ("ClearNoon", {"IlluminationDay"}, {"WeatherRain", "LowLightNight", "SurfaceConditionWet", "WeatherWind"}),
        ("HardRainNight", {"WeatherRain", "LowLightNight", "SurfaceConditionStandingWater"}, {"IlluminationDay"}),
        ("DustStorm", {"ParticulatesDust", "WeatherWind", "IlluminationCloudiness"}, {"WeatherRain"}),
        ("WetNoon", {"SurfaceConditionWet"}, {"WeatherRain"}),
        ("ClearNight", {"LowLightNight", "ParticulatesWater"}, {"IlluminationDay", "DaySunElevation"}),
    ],
)
def test_weather_and_light_are_those_of_the_preset(
    tmp_path: Path, weather: str, there: set[str], absent: set[str]
) -> None:
    found = set(tags(tmp_path, weather=weather))
    assert there <= found
    assert not absent & found


def test_others_and_their_actions(tmp_path: Path) -> None:
    body = """
      <static id="cone" model="static.prop.constructioncone"><at><lane road="1" lane="-1" s="200"/></at></static>
      <dynamic id="bus" model="vehicle.mitsubishi.fusorosa" speed="6">
        <start><lane road="1" lane="-1" s="90"/></start>
        <when><time after="3"/><do><speed to="0" over_time="2"/></do></when>
        <when><time after="4"/><do><lane_change by="1" over_time="3"/></do></when>
      </dynamic>
      <dynamic id="rider" model="vehicle.bh.crossbike" speed="3">
        <start><lane road="1" lane="1" s="300"/></start>
      </dynamic>
      <traffic vehicles="4" clear="30"/>"""
    found = tags(tmp_path, body)
    expected = {
        "VehicleBus", "VehicleCycle", "HumanCyclist", "VehicleCar", "TemporaryStructureRoadWorks", "MotionDrive",
        "MotionStop", "MotionDecelerate", "MotionLaneChangeLeft",
    }  # fmt: skip
    assert expected <= set(found)
    assert found["TrafficAgentDensity"] == (("vehicles", 4.0),)
    assert found["SubjectVehicleSpeed"] == (("desired speed, m/s", 12.0),)
    assert not {"MotionAccelerate", "MotionLaneChangeRight", "VehicleTruck", "HumanPedestrian"} & set(found)


def test_the_automated_vehicle_is_not_one_of_the_others(tmp_path: Path) -> None:
    assert not {"VehicleCar", "MotionDrive"} & set(tags(tmp_path))


def test_tags_come_in_the_trees_order_and_none_twice() -> None:
    names = [term.tag for term in TERMS]
    assert len(names) == len(set(names))


def test_openlabel_has_tags_with_their_data(tmp_path: Path) -> None:
    done = compiled(tmp_path, weather="HardRainNoon")
    found = tags_of(done.plan, done.network) | {"LaneSpecificationDimensions": (("width, m", 3.5), ("width, m", 3.0))}
    document = json.loads(openlabel_of("a/odd.xml", "odd", done.plan.digest, found))["openlabel"]
    assert document["metadata"]["schema_version"] == "1.0.0"
    assert document["metadata"]["tagged_file"] == "a/odd.xml"
    assert document["ontologies"] == {"0": {"uri": ONTOLOGY}}
    written = {one["type"]: one.get("tag_data") for one in document["tags"].values()}
    assert set(written) == {"scenarioName", "scenarioUniqueReference", *found}
    assert {one["ontology_uid"] for one in document["tags"].values()} == {"0"}
    assert written["scenarioName"] == {"text": [{"type": "value", "val": "odd"}]}
    assert written["LaneTypeTraffic"] is None
    assert written["SubjectVehicleSpeed"] == {"num": [{"name": "desired speed, m/s", "type": "value", "val": 12.0}]}
    assert written["LaneSpecificationDimensions"] == {"vec": [{"name": "width, m", "type": "range", "val": [3.0, 3.5]}]}
