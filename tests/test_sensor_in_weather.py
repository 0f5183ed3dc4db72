"""The shorter the forward sensor's range (fog, rain, night, noise), the later the request."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import pytest

from tests.studies.study import compiled, runs, time_of

CONFLICT = """<scenarios version="1"><scenario name="obstacle" map="motorway" duration="14" control_every="2"
  summary="A car stands in the lane, 200 m ahead">
<weather sun_altitude_angle="{sun}" fog_density="{fog}" fog_distance="0" precipitation="{rain}"/>
<ego speed="20"><start><spawn_point name="middle_lane"/></start><camera sensor_noise="{noise}"/>
  <forward_sensor kind="{kind}" range="160"/></ego>
<static id="parked"><at><ahead_of entity="ego" distance="200"/></at></static>{then}
<takeover budget="7"><cause kind="path_blocked"/><driver preset="absent"/></takeover></scenario></scenarios>"""
STEP = 0.1
"""Time between two control steps, s."""


def request(folder: Path, kind: str = "camera", then: str = "", **weather: float) -> float:
    """Return the time of the request before a standing car, s."""
    numbers = {"sun": 45.0, "fog": 0.0, "rain": 0.0, "noise": 0.0, **weather}
    recording, outcome = next(runs(compiled(folder, CONFLICT.format(kind=kind, then=then, **numbers)), range(1, 2)))
    assert outcome.cause == "path_blocked"
    return time_of(recording, "request")


@pytest.mark.parametrize("kind", ["camera", "lidar"])
def test_a_sweep_over_fog_moves_the_request_later(kind: str, tmp_path: Path) -> None:
    """The time to the obstacle at the request falls from the budget to that of what is seen in the thickest fog."""
    found = [request(tmp_path, kind, fog=fog) for fog in range(0, 101, 10)]
    assert all(later >= sooner for sooner, later in pairwise(found))
    assert all(later > sooner for sooner, later in pairwise(found[2:]))
    assert found[-1] - found[0] > 4.0


def test_with_a_radar_the_request_is_the_same_in_the_thickest_fog(tmp_path: Path) -> None:
    assert request(tmp_path, "radar", fog=100.0) == pytest.approx(request(tmp_path, "radar"), abs=STEP + 1e-6)


def test_rain_night_and_the_cameras_noise_move_the_request_later(tmp_path: Path) -> None:
    clear = request(tmp_path)
    for later in (request(tmp_path, rain=100.0), request(tmp_path, sun=-30.0), request(tmp_path, noise=30.0)):
        assert later > clear + STEP
    assert request(tmp_path, "radar", sun=-30.0, noise=30.0) == pytest.approx(request(tmp_path, "radar"), abs=1e-6)


def test_the_sensor_follows_the_weather_while_it_changes(tmp_path: Path) -> None:
    """Fog that comes up before the obstacle is in range has the same effect as constant fog."""
    fog = (
        '<when><time after="0.5"/><do><weather sun_altitude_angle="45" fog_density="80" fog_distance="0" '
        'precipitation="0" over_time="1"/></do></when>'
    )
    assert request(tmp_path, then=fog) == pytest.approx(request(tmp_path, fog=80.0), abs=STEP + 1e-6)
    late = fog.replace('after="0.5"', 'after="13"')
    assert request(tmp_path, then=late) == pytest.approx(request(tmp_path), abs=1e-6)


@pytest.mark.parametrize("change", ['cloudiness="50"', 'sun_azimuth_angle="90"', 'precipitation="0"'])
def test_a_change_of_the_weather_keeps_the_numbers_that_it_leaves_out(tmp_path: Path, change: str) -> None:
    """The fog stays when only the clouds or the sun's azimuth change; without its number it ended."""
    then = f'<when><time after="0.5"/><do><weather {change} over_time="1"/></do></when>'
    assert request(tmp_path, fog=80.0, then=then) == request(tmp_path, fog=80.0) > request(tmp_path) + 1.0
