"""What sensors deliver to CARLA's own client, in step with the ticks."""

from __future__ import annotations

import math
import queue
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from scenario_compiler.carla_server.sensors.bearings import on_globe, reference_of
from scenario_compiler.perception.labels import Tag
from tests.carla_server.conftest import LANDED, PATIENCE, STEP, Served
from tests.perception.test_terrain import tilted

pytestmark = [pytest.mark.slow, pytest.mark.apart]
"""Run by `make test-carla`."""

Spawn = Callable[..., Any]

AHEAD = 15.0
"""Distance between the two cars' origins, m."""


class Listening:
    """A sensor whose messages are kept."""

    def __init__(self, sensor: Any) -> None:
        self.sensor = sensor
        self._came: queue.Queue[Any] = queue.Queue()
        sensor.listen(self._came.put)

    def next(self) -> Any:
        """Return the next message."""
        return self._came.get(timeout=PATIENCE)

    def nothing(self) -> bool:
        """Return whether no message waits."""
        return self._came.empty()


@pytest.fixture
def scene(world: Any, spawn: Spawn) -> Iterator[tuple[Any, Any, Callable[..., Listening]]]:
    """A car, another one ahead of it, and what attaches sensors to the first."""
    import carla

    rear = spawn("vehicle.tesla.model3")
    for _ in range(LANDED):
        world.tick()
    at = rear.get_transform()
    way = at.get_forward_vector()
    place = carla.Transform(at.location + carla.Location(way.x * AHEAD, way.y * AHEAD, 0.2), at.rotation)
    front = spawn("vehicle.audi.tt", place, color="255,0,0")
    for _ in range(LANDED):
        world.tick()
    made: list[Listening] = []

    def attach(
        name: str, x: float = 0.0, z: float = 0.0, pitch: float = 0.0, yaw: float = 0.0, **given: object
    ) -> Listening:
        mounted = carla.Transform(carla.Location(x=x, z=z), carla.Rotation(pitch=pitch, yaw=yaw))
        made.append(Listening(spawn(name, mounted, rear, **given)))
        return made[-1]

    yield rear, front, attach
    for one in made:
        one.sensor.stop()
        one.sensor.destroy()


def pixels(image: Any) -> NDArray[np.uint8]:
    return np.frombuffer(image.raw_data, np.uint8).reshape(image.height, image.width, 4)


SMALL = {"image_size_x": 320, "image_size_y": 240}


def test_noise_starts_again_with_each_sensor(world: Any, spawn: Spawn) -> None:
    """As in CARLA, the seed alone decides: a repetition at another frame has the same noise."""
    runs = []
    for _ in range(2):
        receiver = Listening(spawn("sensor.other.gnss", noise_seed=7, noise_alt_stddev=1.0))
        for _ in range(3):
            world.tick()
        runs.append([receiver.next().altitude for _ in range(3)])
        receiver.sensor.stop()
        receiver.sensor.destroy()
        world.tick()
    assert runs[0] == runs[1]
    assert len(set(runs[0])) == 3


def test_a_cameras_first_image_comes_in_the_next_tick(world: Any, scene: Any) -> None:
    _, _, attach = scene
    camera = attach("sensor.camera.rgb", x=1.5, z=1.6, **SMALL)
    for _ in range(5):
        frame = world.tick()
        image = camera.next()
        assert (image.frame, image.width, image.height) == (frame, 320, 240)
    assert image.fov == 90.0
    shown = pixels(image)
    assert (shown[..., 3] == 255).all()
    assert shown[..., :3].std() > 10.0
    red = (shown[..., 2] > 100) & (shown[..., 1] < 60)
    assert red.sum() > 100  # the car ahead


def test_a_camera_shows_what_carries_it_from_outside(world: Any, scene: Any) -> None:
    _, _, attach = scene
    inside = attach("sensor.camera.instance_segmentation", x=0.3, z=1.2, **SMALL)
    behind = attach("sensor.camera.instance_segmentation", x=-6.0, z=3.0, pitch=-15.0, **SMALL)
    rear, front, _ = scene
    world.tick()
    ids = []
    for one in (inside, behind):
        shown = pixels(one.next()).astype(int)
        ids.append(set(np.unique(shown[..., 1] + 256 * shown[..., 0]).tolist()))
    assert front.id in ids[0]
    assert rear.id not in ids[0]
    assert rear.id in ids[1]


def test_depth_and_kinds_are_of_the_same_scene(world: Any, scene: Any) -> None:
    rear, front, attach = scene
    depth = attach("sensor.camera.depth", x=2.0, z=0.8, **SMALL)
    kinds = attach("sensor.camera.semantic_segmentation", x=2.0, z=0.8, **SMALL)
    world.tick()
    raw = pixels(depth.next()).astype(np.float64)
    metres = (raw[..., 2] + 256.0 * raw[..., 1] + 65536.0 * raw[..., 0]) / (2.0**24 - 1) * 1000.0
    tags = pixels(kinds.next())[..., 2]
    car = tags == Tag.CAR
    gap = AHEAD - 2.0 - front.bounding_box.extent.x
    assert np.median(metres[car]) == pytest.approx(gap, abs=0.6)
    assert {Tag.CAR, Tag.ROAD, Tag.ROAD_LINE, Tag.SKY} <= set(np.unique(tags).tolist())
    assert metres[tags == Tag.SKY].min() > 900.0
    del rear


def test_normals_are_given_in_the_axes_of_the_world(world: Any, scene: Any) -> None:
    rear, _, attach = scene
    normals = attach("sensor.camera.normals", x=2.0, z=0.8, **SMALL)
    kinds = attach("sensor.camera.semantic_segmentation", x=2.0, z=0.8, **SMALL)
    world.tick()
    red_green_blue = pixels(normals.next())[..., 2::-1].astype(float) / 127.5 - 1.0
    tags = pixels(kinds.next())[..., 2]
    assert np.median(red_green_blue[tags == Tag.ROAD], axis=0) == pytest.approx([0.0, 0.0, 1.0], abs=0.01)
    ahead = rear.get_transform().get_forward_vector()
    assert np.median(red_green_blue[tags == Tag.CAR], axis=0)[:2] == pytest.approx([-ahead.x, -ahead.y], abs=0.2)


def test_a_car_that_drives_sees_the_road_flow_apart(world: Any, scene: Any) -> None:
    """At 8 m/s, the image spreads from its middle; the flow of a picture without a motion is zero."""
    import carla

    rear, _, attach = scene
    camera = attach("sensor.camera.optical_flow", x=2.0, z=1.4, **SMALL)
    depth = attach("sensor.camera.depth", x=2.0, z=1.4, **SMALL)
    world.tick()
    image = camera.next()
    found = np.frombuffer(image.raw_data, np.float32).reshape(image.height, image.width, 2)
    assert (image.width, image.height, image.fov) == (320, 240, 90.0)
    assert np.abs(found).max() < 1e-3
    rear.enable_constant_velocity(carla.Vector3D(8.0, 0.0, 0.0))
    for _ in range(3):
        world.tick()
        image, far = camera.next(), depth.next()
    raw = pixels(depth.next() if not depth.nothing() else far).astype(np.float64)
    metres = (raw[..., 2] + 256.0 * raw[..., 1] + 65536.0 * raw[..., 0]) / (2.0**24 - 1) * 1000.0
    found = np.frombuffer(image.raw_data, np.float32).reshape(240, 320, 2)
    columns, rows = np.meshgrid(np.arange(320) - 160.0, np.arange(240) - 120.0)
    expected = np.stack([columns / 160.0, -rows / 120.0], axis=2) / (metres / (8.0 * STEP) + 1.0)[..., None]
    road = (rows > 60) & (np.abs(columns) > 60)
    assert np.abs(found - expected)[road].max() < 0.01
    assert image.get_color_coded_flow().width == 320


def test_an_event_camera_tells_where_it_becomes_darker_and_brighter(world: Any, scene: Any) -> None:
    import carla

    rear, _, attach = scene
    camera = attach("sensor.camera.dvs", x=2.0, z=1.4, positive_threshold=0.2, negative_threshold=0.2, **SMALL)
    world.tick()
    world.tick()
    assert camera.nothing()  # nothing has moved
    rear.enable_constant_velocity(carla.Vector3D(8.0, 0.0, 0.0))
    world.tick()
    before = world.get_snapshot().timestamp.elapsed_seconds - STEP
    told = camera.next()
    events = np.frombuffer(told.raw_data, np.dtype([("x", "<u2"), ("y", "<u2"), ("t", "<i8"), ("pol", "?")]))
    assert (told.width, told.height, len(told)) == (320, 240, len(events))
    assert events["x"].max() < 320
    assert events["y"].max() < 240
    assert (np.diff(events["t"]) >= 0).all()
    assert (before * 1e9 - 1000 < events["t"]).all()
    assert (events["t"] <= (before + STEP) * 1e9 + 1000).all()
    assert {True, False} == set(events["pol"].tolist())
    assert (told[0].x, told[0].y, told[0].t, told[0].pol) == tuple(events[0].tolist())
    image = np.zeros((240, 320), bool)
    image[events["y"], events["x"]] = True
    assert image[120:].mean() > 0.01  # the road
    assert not image[:60].any()  # the sky


def test_a_sensor_with_a_tick_of_its_own_delivers_seldom(world: Any, scene: Any) -> None:
    _, _, attach = scene
    slow = attach("sensor.other.imu", sensor_tick=0.2)
    frames: list[int] = []
    for _ in range(17):
        world.tick()
    while len(frames) < 4:
        frames.append(slow.next().frame)
    assert np.diff(frames).tolist() == [4, 4, 4]


def test_lidar_sees_road_and_car_where_they_are(world: Any, scene: Any) -> None:
    rear, front, attach = scene
    lidar = attach("sensor.lidar.ray_cast", z=2.0, range=60, points_per_second=400_000, rotation_frequency=20)
    world.tick()
    measured = lidar.next()
    points = np.frombuffer(measured.raw_data, np.float32).reshape(-1, 4)
    assert measured.channels == 32
    assert sum(measured.get_point_count(k) for k in range(32)) == len(points)
    road = points[np.abs(points[:, 2] + 2.0) < 0.02]
    assert len(road) > 0.5 * len(points)
    ahead = points[(np.abs(points[:, 1]) < 0.9) & (points[:, 0] > 8.0) & (points[:, 0] < 16.0) & (points[:, 2] > -1.8)]
    assert ahead[:, 0].min() == pytest.approx(AHEAD - front.bounding_box.extent.x, abs=0.05)
    distance = np.linalg.norm(points[:, :3], axis=1)
    assert np.allclose(points[:, 3], np.exp(-0.004 * distance), atol=1e-3)
    del rear


def test_semantic_lidar_names_what_it_meets(world: Any, scene: Any) -> None:
    _, front, attach = scene
    lidar = attach("sensor.lidar.ray_cast_semantic", z=2.0, range=60, points_per_second=400_000, rotation_frequency=20)
    world.tick()
    found = [(one.object_idx, one.object_tag, one.cos_inc_angle) for one in lidar.next()]
    kinds = {one[:2] for one in found}
    assert {(front.id, int(Tag.CAR)), (0, int(Tag.ROAD)), (0, int(Tag.TERRAIN))} <= kinds
    assert {tag for number, tag in kinds if number == 0} <= {Tag.ROAD, Tag.TERRAIN, Tag.SIDEWALK}
    assert all(0.0 <= cosine <= 1.0 for _, _, cosine in found)


def test_a_lidar_on_a_banked_slope_sees_the_plane_that_it_stands_on(server: Served) -> None:
    import carla

    grade, bank = 0.06, 0.05
    client = server.client()
    there = client.generate_opendrive_world(tilted(grade, bank))
    settings = there.get_settings()
    settings.synchronous_mode, settings.fixed_delta_seconds = True, STEP
    there.apply_settings(settings)
    try:
        library = there.get_blueprint_library()
        place = there.get_map().get_waypoint(carla.Location(100.0, 10.0, 0.0)).transform
        place.location.z += 1.0
        car = there.spawn_actor(library.find("vehicle.tesla.model3"), place)
        for _ in range(15):
            there.tick()
        blueprint = library.find("sensor.lidar.ray_cast_semantic")
        for key, value in {"range": 40, "points_per_second": 100_000, "rotation_frequency": 20}.items():
            blueprint.set_attribute(key, str(value))
        lidar = Listening(there.spawn_actor(blueprint, carla.Transform(carla.Location(z=2.0)), attach_to=car))
        there.tick()
        measured = lidar.next()
        points = np.array([[one.point.x, one.point.y, one.point.z] for one in measured])
        tags = np.array([one.object_tag for one in measured])
        cosines = np.array([one.cos_inc_angle for one in measured])
        matrix = np.array(measured.transform.get_matrix())
        x, y, z = matrix[:3, :3] @ points.T + matrix[:3, 3:]
        road_only = (np.abs(y) < 29.0) & (np.abs(x - 100.0) < 95.0)
        assert road_only.sum() > 500
        assert np.abs(z - grade * x + math.tan(bank) * y)[road_only].max() < 5e-3
        assert (tags[road_only] == Tag.ROAD).all()
        distance = np.linalg.norm(points, axis=1)
        normal = np.array([-grade, math.tan(bank), 1.0]) / math.sqrt(1.0 + grade**2 + math.tan(bank) ** 2)
        ways = matrix[:3, :3] @ (points / distance[:, None]).T
        assert np.abs(cosines + normal @ ways)[road_only].max() < 1e-3
        lidar.sensor.stop()
    finally:
        client.load_world("town_grid")


def test_a_lidar_can_be_told_whom_not_to_see(world: Any, spawn: Spawn) -> None:
    import carla

    car = spawn("vehicle.tesla.model3", 0)
    world.tick()
    at = car.get_transform()
    ahead = at.get_forward_vector()
    mounted = carla.Transform(at.location + carla.Location(8.0 * ahead.x, 8.0 * ahead.y, 1.0))
    lidar = Listening(
        spawn("sensor.lidar.ray_cast_semantic", mounted, points_per_second=100_000, rotation_frequency=20)
    )
    world.tick()
    assert car.id in {one.object_idx for one in lidar.next()}
    if not hasattr(lidar.sensor, "set_ignored_vehicles"):
        lidar.sensor.stop()
        return  # clients of 0.9.15 cannot tell it
    lidar.sensor.set_ignored_vehicles([car.id])
    world.tick()
    assert car.id not in {one.object_idx for one in lidar.next()}
    lidar.sensor.set_ignored_vehicles([])
    world.tick()
    assert car.id in {one.object_idx for one in lidar.next()}
    lidar.sensor.stop()


def test_radar_measures_how_fast_it_comes_nearer(world: Any, scene: Any) -> None:
    import carla

    rear, front, attach = scene
    radar = attach("sensor.other.radar", x=2.5, z=0.7, horizontal_fov=10, vertical_fov=4, points_per_second=20_000)
    rear.enable_constant_velocity(carla.Vector3D(8.0, 0.0, 0.0))
    world.tick()
    radar.next()
    world.tick()
    found = list(radar.next())
    gap = AHEAD - 2.5 - front.bounding_box.extent.x - 2 * 8.0 * 0.05
    car = [one for one in found if abs(one.depth - gap) < 0.6]
    assert car
    assert np.median([one.velocity for one in car]) == pytest.approx(-8.0, abs=0.1)
    assert max(abs(one.azimuth) for one in found) <= math.radians(5.0) + 1e-6


def test_an_obstacle_ahead_is_reported_with_its_distance(world: Any, scene: Any) -> None:
    _, front, attach = scene
    near = attach("sensor.other.obstacle", x=2.4, z=0.8, distance=30)
    far = attach("sensor.other.obstacle", x=2.4, z=0.8, distance=5)
    world.tick()
    event = near.next()
    assert event.other_actor.id == front.id
    gap = AHEAD - 2.4 - front.bounding_box.extent.x
    assert event.distance == pytest.approx(gap - 0.5, abs=0.05)  # until a sphere of 0.5 m touches, as Unreal's sweeps
    world.tick()
    assert far.nothing()


def test_gnss_agrees_with_the_clients_own_map(world: Any, scene: Any) -> None:
    rear, _, attach = scene
    gnss = attach("sensor.other.gnss")
    world.tick()
    told = gnss.next()
    expected = world.get_map().transform_to_geolocation(rear.get_location())
    assert (told.latitude, told.longitude) == pytest.approx((expected.latitude, expected.longitude), abs=1e-8)


GEOREFERENCES = (
    "",
    "+lat_0=4.9000000000000000e+1 +lon_0=8.0000000000000000e+0",
    "+proj=tmerc +lat_0=-37.4168716 +lon_0=.5 +k=1 +x_0=0 +y_0=0 +datum=WGS84 +units=m +no_defs",
    "+proj=utm +zone=32 +datum=WGS84",
    "+proj=merc +lon_0=8",
    "+lat_0=49,+lon_0=8",
)


@pytest.mark.parametrize("georeference", GEOREFERENCES)
def test_every_georeference_is_read_as_the_client_reads_it(georeference: str, client_version: str) -> None:
    """Among them that of CARLA's own towns, whose numbers have an exponent."""
    import carla

    text = tilted(0.0, 0.0).replace(
        '<header revMajor="1" revMinor="6"/>',
        f'<header revMajor="1" revMinor="6"><geoReference><![CDATA[{georeference}]]></geoReference></header>',
    )
    of_client = carla.Map("straight", text)
    for x, y in ((0.0, 0.0), (800.0, -300.0)):
        expected = of_client.transform_to_geolocation(carla.Location(x=x, y=y))
        told = on_globe(client_version, reference_of(georeference), x, y)
        assert told == pytest.approx((expected.latitude, expected.longitude), abs=1e-8)


def test_an_imu_away_from_the_origin_feels_the_turn_there(world: Any, scene: Any) -> None:
    """As CARLA computes it: by the sensor's own places, two steps apart."""
    import carla

    rear, _, attach = scene
    imu = attach("sensor.other.imu", x=6.0)
    places: list[NDArray[np.float64]] = []
    for _ in range(40):
        rear.apply_control(carla.VehicleControl(throttle=0.5, steer=0.4))
        world.tick()
        told = imu.next()
        at = told.transform
        places.append(np.array([at.location.x, at.location.y]))
    gained = (places[-1] - 2.0 * places[-2] + places[-3]) / STEP**2
    ahead, right = at.get_forward_vector(), at.get_right_vector()
    expected = (gained @ [ahead.x, ahead.y], gained @ [right.x, right.y])
    assert abs(expected[1]) > 1.0
    assert (told.accelerometer.x, told.accelerometer.y) == pytest.approx(expected, abs=0.15)


def test_imu_feels_gravity_acceleration_and_turns(world: Any, scene: Any) -> None:
    import carla

    rear, _, attach = scene
    imu = attach("sensor.other.imu")
    rear.apply_control(carla.VehicleControl(throttle=0.5, steer=0.1))
    for _ in range(10):
        world.tick()
        told = imu.next()
    assert told.accelerometer.z == pytest.approx(9.81, abs=1e-3)
    assert told.accelerometer.x == pytest.approx(1.75, abs=0.15)
    assert told.gyroscope.z == pytest.approx(math.radians(rear.get_angular_velocity().z), abs=1e-4)
    assert told.gyroscope.z > 0.0
    compass = math.radians(rear.get_transform().rotation.yaw + 90.0) % math.tau  # north is -y
    assert told.compass == pytest.approx(compass, abs=1e-3)


def test_leaving_the_lane_is_reported(world: Any, scene: Any) -> None:
    import carla

    rear, _, attach = scene
    invasion = attach("sensor.other.lane_invasion")
    world.tick()
    at = rear.get_transform()
    right = at.get_right_vector()
    world.tick()
    rear.set_transform(carla.Transform(at.location - carla.Location(right.x * 2.5, right.y * 2.5, 0.0), at.rotation))
    for _ in range(3):
        world.tick()
    assert invasion.next().crossed_lane_markings


def test_a_camera_of_nobody_sees_too(world: Any, spawn: Spawn, scene: Any) -> None:
    import carla

    rear, _, _ = scene
    at = rear.get_location()
    above = carla.Transform(at + carla.Location(z=25.0), carla.Rotation(pitch=-90.0))
    camera = Listening(spawn("sensor.camera.semantic_segmentation", above, **SMALL))
    world.tick()
    tags = pixels(camera.next())[..., 2]
    camera.sensor.stop()
    assert tags[118:123, 158:163].tolist() == [[int(Tag.CAR)] * 5] * 5


def test_too_large_an_image_is_refused(spawn: Spawn) -> None:
    import carla

    with pytest.raises(RuntimeError, match="pixels"):
        spawn("sensor.camera.rgb", carla.Transform(), image_size_x=30_000, image_size_y=30_000)


@pytest.mark.parametrize(
    ("name", "tag"),
    [
        ("vehicle.audi.tt", Tag.CAR),
        ("vehicle.mercedes.sprinter", Tag.TRUCK),
        ("vehicle.carlamotors.firetruck", Tag.TRUCK),
        ("vehicle.mitsubishi.fusorosa", Tag.BUS),
        ("vehicle.vespa.zx125", Tag.MOTORCYCLE),
        ("vehicle.bh.crossbike", Tag.BICYCLE),
        ("walker.pedestrian.0003", Tag.PEDESTRIAN),
        ("static.prop.streetbarrier", Tag.DYNAMIC),
        ("static.prop.warningconstruction", Tag.DYNAMIC),
        ("static.prop.bench01", Tag.STATIC),
        ("static.prop.kiosk_01", Tag.BUILDING),
    ],
)
def test_a_thing_has_one_tag_whoever_is_asked(world: Any, spawn: Spawn, name: str, tag: Tag) -> None:
    """The actor itself, the pictures, the semantic lidar and the rays of clients."""
    import carla

    low = carla.Transform(carla.Location(x=1000.0, y=1000.0, z=1.0), carla.Rotation(yaw=30.0))
    ahead = low.get_forward_vector()
    there = carla.Location(low.location.x + 8.0 * ahead.x, low.location.y + 8.0 * ahead.y, 0.3)
    thing = spawn(name, carla.Transform(there, carla.Rotation(yaw=70.0)))
    cameras = {
        kind: Listening(spawn(f"sensor.camera.{kind}_segmentation", low, **SMALL)) for kind in ("semantic", "instance")
    }
    lidar = Listening(
        spawn("sensor.lidar.ray_cast_semantic", low, points_per_second=200_000, upper_fov=5, lower_fov=-10)
    )
    for _ in range(LANDED):
        world.tick()
        seen = {kind: camera.next() for kind, camera in cameras.items()}
        cloud = lidar.next()
    instance = pixels(seen["instance"])
    own = instance[..., 1] + 256 * instance[..., 0].astype(int) == thing.id
    tags = set(np.unique(pixels(seen["semantic"])[own][:, 2]).tolist())
    assert tags - {int(Tag.RIDER)} == {int(tag)}
    assert (pixels(seen["semantic"])[..., 2] == instance[..., 2]).all()
    assert {point.object_tag for point in cloud if point.object_idx == thing.id} == {int(tag)}
    assert thing.semantic_tags == [int(tag)]
    assert int(world.project_point(low.location, there - low.location, 20.0).label) == int(tag)
    for one in (*cameras.values(), lidar):
        one.sensor.stop()
        one.sensor.destroy()
