import numpy as np
import pytest

from scenario_compiler.perception.camera import Camera
from scenario_compiler.perception.lane_detector import Boundary, LaneResult
from scenario_compiler.perception.overlay import DRIVER, GREEN, PURPLE, Caption, compose, encode_png, outline_box
from scenario_compiler.roads import Pose

VIEW = np.full((DRIVER.height, DRIVER.width, 3), 90, np.uint8)
CAMERA = np.full((256, 512, 3), 70, np.uint8)
LANE = LaneResult(
    Boundary(1.75, 0.0, 0.0, 0.95, 0.95, 0.95, (5.0, 28.0)), Boundary(-1.75, 0.0, 0.0, 0.9, 0.9, 0.9, (5.0, 28.0)),
    1.0, 0.4, 0.95, 0.9, 3.5,
)  # fmt: skip
CAPTION = Caption(12.5, 13.9, "request", ["map town"], ["WEAK left lane"], ["TAKE OVER"])
PATH = np.stack([np.arange(5.0, 25.0), np.zeros(20)], axis=1)


def has(image: np.ndarray, colour: tuple[int, int, int]) -> bool:
    return bool((np.abs(image.astype(int) - colour).max(axis=2) < 12).any())


def test_the_picture_shows_lanes_path_and_inset_and_leaves_its_sources_alone() -> None:
    picture = compose(VIEW, CAMERA, LANE, PATH, CAPTION)
    assert picture.shape == VIEW.shape
    assert has(picture, GREEN)
    assert has(picture, PURPLE)
    inset = picture[10:170, -330:-10]
    assert has(inset, GREEN)
    assert (VIEW == 90).all()
    assert (CAMERA == 70).all()


@pytest.mark.parametrize(("width", "height"), [(64, 4096), (4096, 32), (64, 32)])
def test_the_inset_of_a_narrow_or_flat_camera_fits_into_the_picture(width: int, height: int) -> None:
    bright = np.full((height, width, 3), 250, np.uint8)
    picture = compose(VIEW, bright, None, None, CAPTION, sensor=Camera(width=width, height=height))
    rows, columns = np.nonzero((picture[: VIEW.shape[0] // 2 + 10, -330:] == 250).all(axis=2))
    assert rows.min() >= 8
    assert len(np.unique(rows)) <= VIEW.shape[0] // 2
    assert len(np.unique(columns)) <= VIEW.shape[1] // 3


def test_the_path_lies_where_the_drivers_camera_sees_it() -> None:
    picture = compose(VIEW, CAMERA, None, PATH, CAPTION)
    u, v = DRIVER.project_ground(10.0 + Camera().x - DRIVER.x, 0.0)
    assert has(picture[round(float(v)) - 2 : round(float(v)) + 3, round(float(u)) - 3 : round(float(u)) + 4], PURPLE)


def test_a_long_message_is_broken_into_rows_that_can_be_read() -> None:
    """A row is darkened over its whole height, and 36 pixels high in a view that is 960 pixels wide."""
    plain = compose(VIEW, CAMERA, None, None, Caption(0.0, 0.0, ""))

    def height(message: str) -> float:
        picture = compose(VIEW, CAMERA, None, None, Caption(0.0, 0.0, "", alarms=[message]))
        changed = (picture != plain).any(axis=2)
        assert not changed[:, :8].any()
        assert not changed[:, -8:].any()
        return float(changed.any(axis=1).sum()) / (VIEW.shape[1] / 960)

    assert height("Take over now") == pytest.approx(36, abs=3)
    assert height("Take over now: the path ahead is blocked, brake or go around it") == pytest.approx(36, abs=3)
    assert height("Take over now, because the path ahead is blocked by road works. " * 3) == pytest.approx(
        2 * 36, abs=3
    )


def test_without_a_detection_nothing_is_drawn() -> None:
    picture = compose(VIEW, CAMERA, None, None, Caption(0.0, 0.0, "automated"))
    assert not has(picture, PURPLE)
    assert not has(picture[200:], GREEN)


@pytest.mark.parametrize("path", [np.empty((0, 2)), np.array([[np.nan, 0.0], [1e9, 1e9], [-5.0, 0.0]])])
def test_strange_paths_do_no_harm(path: np.ndarray) -> None:
    assert compose(VIEW, CAMERA, LANE, path, CAPTION).shape == VIEW.shape


@pytest.mark.parametrize(("x", "y", "seen"), [(30.0, 0.0, True), (30.0, 60.0, False), (-30.0, 0.0, False)])
def test_a_box_is_outlined_where_the_picture_has_it(x: float, y: float, seen: bool) -> None:
    picture = VIEW.copy()
    corner = outline_box(
        picture, DRIVER.view(Pose(0, 0, 0, 0, 0, 0)), Pose(x, y, 0, 0, 0, 0), (4.0, 1.8, 1.5, 1.4), GREEN
    )
    assert (corner is not None, has(picture, GREEN)) == (seen, seen)


def test_a_png_is_the_same_each_time() -> None:
    picture = compose(VIEW, CAMERA, LANE, PATH, CAPTION)
    first = encode_png(picture)
    assert first.startswith(b"\x89PNG")
    assert first == encode_png(compose(VIEW, CAMERA, LANE, PATH, CAPTION))
