"""A change of the weather is exported with what it changes: its other parts stay as they are in other programs too."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from lxml import etree

from scenario_compiler.compiler import Compilation, Overrides, compile_target
from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.openscenario.export.files import export_files
from scenario_compiler.openscenario.output import VERSIONS, Version
from scenario_compiler.structure.schemas import find_schema
from tests.asam import schemas_of_wheel

NIGHT = """<scenarios version="1"><scenario name="night" map="highway_loop" weather="{weather}" duration="5">
  <ego speed="15"><start><spawn_point name="track"/></start></ego>
  <when><time after="2"/><do><weather {change}/></do></when>
  <takeover/>
</scenario></scenarios>"""


def compiled(path: Path) -> Compilation:
    compilation = compile_target(path, {}, Diagnostics(), overrides=Overrides(perception="ideal"))
    assert compilation is not None
    return compilation


def exported(
    folder: Path, change: str, version: Version, weather: str = "ClearNight"
) -> tuple[etree._Element, etree._Element, list[str]]:
    """Return the environments of the start and of the change in an exported file, and what was lost in the change."""
    source = folder / "night.xml"
    source.write_text(NIGHT.format(change=change, weather=weather), encoding="utf-8")
    compilation, sink = compiled(source), Diagnostics()
    path = folder / "night.xosc"
    for file, content in export_files(
        compilation.plan, compilation.network, path, version, sink, compilation.scenario
    ).items():
        file.write_bytes(content)
    start, changed = etree.parse(str(path)).getroot().iter("Environment")
    return start, changed, [one.message for one in sink if "weather" in one.message]


def parts(environment: etree._Element) -> dict[str, dict[str, str]]:
    """Return the attributes of <Weather> and of its children, by the tag."""
    weather = environment.find("Weather")
    return {} if weather is None else {str(one.tag): dict(one.attrib) for one in (weather, *weather)}


@pytest.mark.parametrize("version", VERSIONS[1:])
def test_only_the_changed_parts_are_written(tmp_path: Path, version: Version) -> None:
    _, rain, lost = exported(tmp_path, 'precipitation="60"', version)
    assert parts(rain) == {
        "Weather": {},
        "Precipitation": {"precipitationType": "rain", "precipitationIntensity": "30"},
    }
    road = rain.find("RoadCondition")
    assert road is not None
    assert "wetness" not in road.attrib
    assert lost == []
    assert parts(exported(tmp_path, 'wetness="100"', version)[1]) == {}
    assert parts(exported(tmp_path, 'cloudiness="100"', version)[1]).keys() == {"Weather"}
    assert parts(exported(tmp_path, 'wind_intensity="50"', version)[1]).keys() == {"Weather", "Wind"}
    assert parts(exported(tmp_path, 'fog_density="50"', version)[1]).keys() == {"Weather", "Fog"}


def test_the_sun_needs_both_angles_and_dusk_keeps_its_own(tmp_path: Path) -> None:
    _, dusk, lost = exported(tmp_path, 'sun_altitude_angle="5"', (1, 2))
    assert float(parts(dusk)["Sun"]["elevation"]) == pytest.approx(math.radians(5.0))
    assert lost == []
    _, turned, lost = exported(tmp_path, 'sun_azimuth_angle="60"', (1, 2))
    assert parts(turned) == {}
    assert lost == ["sun_azimuth_angle of the weather cannot be expressed without sun_altitude_angle"]
    _, farther, lost = exported(tmp_path, 'fog_distance="20"', (1, 2))
    assert parts(farther) == {}
    assert lost == ["fog_distance of the weather cannot be expressed without fog_density"]


def test_wetness_is_the_nearest_to_the_number_that_is_given(tmp_path: Path) -> None:
    for change, word in (('wetness="40"', "moist"), ('wetness="80"', "wetWithPuddles"), ('wetness="0"', "dry")):
        _, wet, _ = exported(tmp_path, change, (1, 2))
        assert wet.find("RoadCondition").get("wetness") == word  # type: ignore[union-attr]


def test_a_preset_is_written_as_a_whole(tmp_path: Path) -> None:
    _, rain, lost = exported(tmp_path, 'preset="HardRainNoon"', (1, 2))
    assert parts(rain).keys() == {"Weather", "Sun", "Fog", "Precipitation", "Wind"}
    assert lost == []


@pytest.mark.parametrize("version", VERSIONS)
def test_the_weather_at_the_start_is_whole_and_read_back_as_it_was(tmp_path: Path, version: Version) -> None:
    """Numbers that the scenario leaves to the map are those of a clear noon."""
    path = tmp_path / "night.xosc"
    start, _, _ = exported(tmp_path, 'precipitation="60"', version)
    wind = {"Wind"} if version > (1, 0) else set()
    assert parts(start).keys() == {"Weather", "Sun", "Fog", "Precipitation"} | wind
    before = compiled(tmp_path / "night.xml")
    again = compiled(path)
    assert again.plan.weather == before.plan.weather
    assert [action for _, action in again.plan.storyboard.actions()] == [
        action for _, action in before.plan.storyboard.actions()
    ]


def test_before_1_1_the_schema_requires_the_whole_weather_which_is_reported(tmp_path: Path) -> None:
    _, rain, lost = exported(tmp_path, 'precipitation="60"', (1, 0))
    assert parts(rain).keys() == {"Weather", "Sun", "Fog", "Precipitation"}
    kept = "cloudiness, sun_altitude_angle, fog_density"
    assert lost == [f"1.0 has no change of a part of the weather: {kept} are those of a clear noon"]


@pytest.mark.parametrize("change", ['precipitation="60"', 'wetness="40"', 'fog_density="50" cloudiness="90"'])
@pytest.mark.parametrize("version", VERSIONS)
def test_a_part_of_the_weather_follows_the_schema(tmp_path: Path, change: str, version: Version) -> None:
    exported(tmp_path, change, version)
    folder = schemas_of_wheel("asam-qc-openscenarioxml", "qc_openscenario")
    schema = find_schema(folder, "OpenSCENARIO", version[1])
    assert schema is not None
    etree.XMLSchema(etree.parse(str(schema))).assertValid(etree.parse(str(tmp_path / "night.xosc")))
