"""The run as a whole: step, duration, camera, weather, the ego's route and the road marks."""

from __future__ import annotations

import math

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.moves.camera import FAILURE_CODES
from scenario_compiler.engine.program.builder import ProgramBuilder
from scenario_compiler.vocabulary.actions import WeatherAction
from scenario_compiler.vocabulary.lane_keeping import LANE_KEEPING
from scenario_compiler.vocabulary.sensors import Failure, Perception, SensorKind
from scenario_compiler.vocabulary.weather import Weather, weather_numbers, written_numbers

PERCEPTION_CODES: dict[Perception, int] = {
    "ideal": op.PERCEPTION_IDEAL,
    "camera": op.PERCEPTION_CAMERA,
    "surrogate": op.PERCEPTION_SURROGATE,
}
SENSOR_CODES: dict[SensorKind, int] = {
    "camera": op.SENSOR_CAMERA,
    "radar": op.SENSOR_RADAR,
    "lidar": op.SENSOR_LIDAR,
}
LOW_BEAM = 100.0
"""Distance at which headlights give 5 lux, m: in the tests of the Insurance Institute for Highway Safety, which measure
it, 330 feet on a straight road are good.
"""


def add_run(draft: ProgramBuilder) -> None:
    """Write the run's numbers, its camera and weather, and the ego's route."""
    plan, p, k = draft.plan, draft.program, draft.numbers
    k[slot.K_STEP] = plan.step
    k[slot.K_DURATION] = plan.duration
    k[slot.K_NOISE] = plan.camera.sensor_noise
    _add_forward_sensor(draft)
    k[slot.K_PLACE_ERROR] = plan.odometry.place_error
    k[slot.K_HEADING_ERROR] = plan.odometry.heading_error
    k[slot.K_GYRO_BIAS] = plan.odometry.gyro_bias
    k[slot.K_GYRO_NOISE] = plan.odometry.gyro_noise
    k[slot.K_DISTANCE_ERROR] = plan.odometry.distance_error
    for failure in plan.camera.failures:
        add_failure(draft, failure, waits=False)
    add_weather(draft, plan.weather)
    p.control_every[0] = plan.control_every
    images = plan.camera.control_steps(plan.step * plan.control_every)
    p.image_every[0] = plan.control_every * max(round(images), 1)
    p.perception[0] = PERCEPTION_CODES[plan.perception]
    if plan.destination is not None:
        p.destination_road[0] = draft.network.road_index(plan.destination.road)
        p.destination_lane[0] = plan.destination.lane
        k[slot.K_DESTINATION_S] = plan.destination.s
        k[slot.K_DESTINATION_OFFSET] = plan.destination.offset
    _add_lane_keeping(draft)
    for leg in plan.route:
        road = draft.network.road_index(leg.road)
        if not p.route_road or p.route_road[-1] != road:
            p.route_road.append(road)
    p.route_count[0] = len(p.route_road)


def _add_lane_keeping(draft: ProgramBuilder) -> None:
    """Write the parameters of the automation `lane_detection`, which also drives without a camera.

    Properties of another controller count where they have the same names and are positive numbers.
    """
    controller = draft.plan.controller
    own = {} if controller is None else {one.name: _positive(one.value) for one in controller.properties}
    for place, (name, usual) in enumerate(LANE_KEEPING.items()):
        draft.numbers[slot.K_LOOK_AHEAD_TIME + place] = own.get(name) or usual


def _positive(text: str) -> float | None:
    """Return a positive finite number; None for any other text."""
    try:
        number = float(text)
    except ValueError:
        return None
    return number if 0.0 < number < math.inf else None


def _add_forward_sensor(draft: ProgramBuilder) -> None:
    """Write the sensor with which the automation detects objects ahead."""
    sensor, k = draft.plan.forward_sensor, draft.numbers
    draft.program.forward_sensor[0] = SENSOR_CODES[sensor.kind]
    k[slot.K_SENSOR_RANGE] = sensor.range
    k[slot.K_FIELD_OF_VIEW] = sensor.field_of_view
    k[slot.K_HEADLIGHTS] = LOW_BEAM if sensor.headlights is None else sensor.headlights
    k[slot.K_SENSOR_NOISE] = 0.0 if sensor.noise is None else sensor.noise


def add_failure(draft: ProgramBuilder, failure: Failure, *, waits: bool) -> int:
    """Append a camera failure, which `waits` for its action or counts from the start; return its row."""
    p = draft.program
    duration = -1.0 if failure.duration is None else failure.duration
    p.failure_kind.append(FAILURE_CODES[failure.kind])
    p.failure_waits.append(1 if waits else 0)
    angles = (failure.yaw, failure.pitch, failure.roll)
    p.failure_const.append(draft.block(failure.onset, duration, failure.ramp, failure.strength, *angles))
    p.failure_count[0] = len(p.failure_kind)
    return p.failure_count[0] - 1


def add_weather(draft: ProgramBuilder, weather: Weather) -> int:
    """Append a weather; return its row. A change of the weather keeps the numbers that are `KEPT`."""
    p = draft.program
    numbers = written_numbers(weather) if isinstance(weather, WeatherAction) else weather_numbers(weather)
    p.weather_const.append(draft.block(*numbers))
    p.weather_count[0] = len(p.weather_const)
    return p.weather_count[0] - 1


def add_markings(draft: ProgramBuilder) -> None:
    """Append the stretches where the road marks differ from the map's."""
    p = draft.program
    for stretch in draft.plan.markings:
        begin = -1.0 if stretch.quality is None else stretch.quality
        end = begin if stretch.quality_to is None else stretch.quality_to
        p.stretch_road.append(draft.network.road_index(stretch.road))
        p.stretch_lane.append(op.ALL_MARKS if stretch.lane is None else stretch.lane)
        p.stretch_const.append(draft.block(stretch.s_from, stretch.s_to, begin, end, stretch.coverage))
    p.stretch_count[0] = len(p.stretch_road)
