"""Each fault of a camera is measured as what it is, and what looks like one in a good image is not taken for one."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from scenario_compiler.engine.ego.camera_health import clipped_share, still_by_dead_rows
from scenario_compiler.perception.degradation import Degradation, Sensor
from scenario_compiler.perception.road_camera import RoadCamera
from scenario_compiler.perception.sensor_health import SensorHealth, SensorMonitor
from scenario_compiler.roads import load_network
from scenario_compiler.vocabulary.weather import weather_preset

MAP = Path(__file__).parents[2] / "maps" / "highway_loop" / "highway_loop.xodr"
WAY = 1.0
"""Way from one image to the next, m."""

WEATHERS = ("ClearNoon", "ClearNight", "HardRainSunset")


@cache
def drive(weather: str) -> tuple[np.ndarray, ...]:
    """Return the images of a clean camera along a road."""
    network = load_network(MAP)
    camera = RoadCamera(network)
    numbers = weather_preset(weather)
    assert numbers is not None
    return tuple(
        camera.frame(network.lane_pose("1", -1, 300.0 + WAY * k), [], numbers, 0.0, k).copy() for k in range(10)
    )


def watched(weather: str, state: Degradation, way: float = WAY) -> SensorHealth:
    """Return what is known of a camera after the drive."""
    monitor, sensor = SensorMonitor(), Sensor(1)
    found = [monitor.observe(sensor.deliver(image, state, k), way) for k, image in enumerate(drive(weather))]
    return found[-1]


@pytest.mark.parametrize("weather", WEATHERS)
def test_a_clean_camera_is_healthy_in_any_weather(weather: str) -> None:
    assert watched(weather, Degradation()).health > 0.99


@pytest.mark.parametrize("weather", WEATHERS)
@pytest.mark.parametrize(
    "state",
    [
        Degradation(sigma=60.0),
        Degradation(dark=0.99),
        Degradation(blur=9.0),
        Degradation(dirt=0.8),
        Degradation(dirt=1.0),
        Degradation(missing=True),
        Degradation(frozen=True),
    ],
)
def test_a_severe_fault_is_seen(weather: str, state: Degradation) -> None:
    assert watched(weather, state).health < 0.1


@pytest.mark.parametrize("weather", WEATHERS)
@pytest.mark.parametrize(
    "state", [Degradation(sigma=8.0), Degradation(dark=0.4), Degradation(blur=1.2), Degradation(dirt=0.25)]
)
def test_a_slight_fault_is_ignored(weather: str, state: Degradation) -> None:
    assert watched(weather, state).health > 0.85


@pytest.mark.parametrize("mean", [0.0, 0.3, 1.0, 2.0, 4.0])
def test_clipped_noise_has_the_standard_deviation_of_a_clipped_normal_variable(mean: float) -> None:
    drawn = np.random.default_rng(1).standard_normal(1_000_000)
    assert clipped_share(mean) == pytest.approx(np.maximum(drawn + mean, 0.0).std(), abs=0.005)


@pytest.mark.parametrize("share", [0.5, 0.8, 0.9, 0.97])
def test_blocks_of_eight_dead_rows_do_not_change(share: float) -> None:
    shares = []
    for seed in range(1, 7):
        monitor, sensor = SensorMonitor(), Sensor(seed)
        for k, image in enumerate(drive("ClearNoon")):
            found = monitor.observe(sensor.deliver(image, Degradation(dead_rows=share), k), WAY)
        shares.append(found.dirt)
    assert still_by_dead_rows(share) == pytest.approx(np.mean(shares), abs=0.12)


@pytest.mark.parametrize("weather", WEATHERS)
@pytest.mark.parametrize(
    "sigma", [pytest.param(2.0, marks=pytest.mark.slow), pytest.param(5.0, marks=pytest.mark.slow), 10.0]
)
def test_noise_neither_hides_blur_nor_is_taken_for_it(weather: str, sigma: float) -> None:
    assert watched(weather, Degradation(sigma=sigma)).blur < 3.5
    assert watched(weather, Degradation(sigma=sigma, blur=9.0)).blur > 6.0


def test_each_fault_is_measured_as_its_own_kind() -> None:
    assert watched("ClearNoon", Degradation(sigma=20.0)).noise == pytest.approx(20.0, abs=1.5)
    assert watched("ClearNoon", Degradation(blur=5.0)).blur == pytest.approx(6.0, abs=1.5)
    assert watched("ClearNoon", Degradation(dirt=0.5)).dirt == pytest.approx(0.42, abs=0.08)
    assert watched("ClearNoon", Degradation(dark=0.5)).tones == pytest.approx(110.0, abs=8.0)
    assert watched("ClearNoon", Degradation(frozen=True)).frozen


def test_a_standing_car_does_not_take_equal_images_for_frozen_ones() -> None:
    assert watched("ClearNoon", Degradation(frozen=True), way=0.0).health > 0.99


def test_images_that_change_again_are_healthy_again() -> None:
    monitor, images = SensorMonitor(), drive("ClearNoon")
    assert monitor.observe(images[0], WAY).health > 0.99
    assert monitor.observe(images[0], WAY).health == 0.0
    assert monitor.observe(images[1], WAY).health > 0.99


def test_more_dirt_grows_from_where_there_was_some() -> None:
    image = drive("ClearNoon")[0]
    little, more = (Sensor(1).deliver(image, Degradation(dirt=share), 0) for share in (0.2, 0.5))
    touched, all_touched = ((one != image).any(axis=2) for one in (little, more))
    assert not (touched & ~all_touched).any()
    assert 0.15 < touched.mean() < all_touched.mean() < 0.65


def test_a_frozen_sensor_repeats_what_it_delivered_last() -> None:
    sensor, images = Sensor(1), drive("ClearNoon")
    first = sensor.deliver(images[0], Degradation(sigma=10.0), 0)
    assert np.array_equal(sensor.deliver(images[1], Degradation(sigma=10.0, frozen=True), 1), first)
    assert not sensor.deliver(images[2], Degradation(missing=True), 2).any()
