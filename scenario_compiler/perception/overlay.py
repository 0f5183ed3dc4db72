"""The picture in reports and videos: the driver's view, the camera's image, the detected lane and messages.

Detected boundaries are green, darker with less confidence; the predicted path is purple.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import ArrayLike, NDArray

from scenario_compiler.legible import legible
from scenario_compiler.perception.camera import Camera, View, vehicle_axes
from scenario_compiler.perception.lane_detector import LaneResult
from scenario_compiler.roads.positions import Pose

Image = NDArray[np.uint8]
Colour = tuple[int, int, int]

DRIVER = Camera(width=960, height=480, fov=np.deg2rad(70.0).item(), x=0.3, z=1.35, pitch=np.deg2rad(-4.0).item())
"""The camera of the driver's view."""

NEAR = 1.0
"""Distance along the optical axis from which boxes are outlined, m."""

GREEN, FAINT, PURPLE = (60, 230, 60), (60, 110, 60), (210, 40, 190)
WHITE, AMBER, RED = (240, 240, 240), (40, 190, 255), (60, 60, 240)
_FONT = cv2.FONT_HERSHEY_SIMPLEX
_STATE_COLOURS = {
    "automated": GREEN,
    "warning": AMBER,
    "request": RED,
    "escalation": RED,
    "manual": WHITE,
    "minimum_risk": RED,
    "collision": RED,
}


SMALLEST = 0.7
"""Least size of a message, relative to that of a short one; longer messages are broken into rows."""

LEAST_SCALE = 0.7
"""Least size of the writing, relative to that in a picture 960 pixels wide; smaller writing is not readable in videos.
"""


@dataclass(frozen=True)
class Caption:
    """The text on the picture.

    Attributes:
        time: Time of the run, s.
        speed: m/s.
        state: State of the takeover, such as "automated", "request", "manual".
        notes: Lines of information.
        warnings: Messages of warnings.
        alarms: Messages of requests.
    """

    time: float
    speed: float
    state: str
    notes: Sequence[str] = ()
    warnings: Sequence[str] = ()
    alarms: Sequence[str] = ()


def compose(
    view_image: Image,
    camera_image: Image,
    lane: LaneResult | None,
    path: ArrayLike | None,
    caption: Caption,
    *,
    sensor: Camera | None = None,
) -> Image:
    """Return the composed picture, with the size of `view_image`; the arguments are not changed.

    Args:
        view_image: The driver's view (`DRIVER`), BGR.
        camera_image: The lane detector's image, BGR.
        lane: The detected lane, in the sensor's ground frame.
        path: (n, 2) points of the predicted path, in the sensor's ground frame, m.
        caption: The text.
        sensor: The camera of `camera_image`, the default camera if None.
    """
    sensor = sensor if sensor is not None else Camera()
    picture, inset = view_image.copy(), camera_image.copy()
    apart = sensor.x - DRIVER.x, sensor.y - DRIVER.y
    for image, camera, shift in ((picture, DRIVER, apart), (inset, sensor, (0.0, 0.0))):
        draw_seen(image, camera, lane, path, shift)
    _set_in(picture, inset)
    _write(picture, lane, caption)
    return picture


def draw_lanes(image: Image, lane: LaneResult, camera: Camera) -> Image:
    """Return the camera's image with the detected boundaries; the image itself is not changed."""
    drawn = image.copy()
    _draw_boundaries(drawn, camera, lane, (0.0, 0.0))
    return drawn


def draw_seen(
    image: Image, camera: Camera, lane: LaneResult | None, path: ArrayLike | None, shift: tuple[float, float] = (0, 0)
) -> None:
    """Draw the detected boundaries and the path into the picture of a camera.

    Args:
        image: The picture, which is changed.
        camera: Its camera.
        lane: The detected lane, in the sensor's ground frame.
        path: (n, 2) points of the path, in the same frame, m.
        shift: Position of the sensor ahead and to the left of the picture's camera, m.
    """
    if path is not None:
        points = np.asarray(path, np.float64).reshape(-1, 2) + shift
        _polyline(image, camera, points[:, 0], points[:, 1], PURPLE)
    if lane is not None:
        _draw_boundaries(image, camera, lane, shift)


def draw_on_ground(image: Image, camera: Camera, points: Sequence[tuple[float, float]], colour: Colour) -> None:
    """Draw a line on the ground through points (x ahead, y left) of the camera's ground frame, m."""
    _polyline(image, camera, [x for x, _ in points], [y for _, y in points], colour)


def annotate(image: Image, caption: Caption) -> None:
    """Write a caption into a picture."""
    _write(image, None, caption)


def outline_box(
    image: Image, view: View, pose: Pose, box: tuple[float, float, float, float], colour: Colour
) -> tuple[int, int] | None:
    """Outline a box in the picture of a camera; return the outline's upper left corner, pixels.

    None if the box is behind the camera or outside its picture.

    Args:
        image: The picture, which is changed.
        view: The camera in the world.
        pose: Pose of the box's reference point.
        box: Its length, width and height, and the distance of its centre ahead of the reference point, m.
        colour: Colour of the line.
    """
    length, width, height, center = box
    axes = vehicle_axes(pose)
    along = np.array([center - length / 2, center + length / 2])
    offsets = np.stack(np.meshgrid(along, (-width / 2, width / 2), (0.0, height), indexing="ij"), axis=-1)
    corners = view.to_camera(np.array([pose.x, pose.y, pose.z]) + offsets.reshape(-1, 3) @ axes.T)
    if corners[:, 2].min() < NEAR:
        return None
    camera = view.camera
    pixels = corners[:, :2] / corners[:, 2:] * camera.focal + (camera.width / 2.0, camera.height / 2.0)
    hull = cv2.convexHull(np.round(pixels).astype(np.int32).reshape(-1, 1, 2))
    cv2.polylines(image, [hull], True, colour, max(2, image.shape[1] // 480), cv2.LINE_AA)
    (left, top), (right, bottom) = hull.reshape(-1, 2).min(axis=0).tolist(), hull.reshape(-1, 2).max(axis=0).tolist()
    inside = right >= 0 and bottom >= 0 and left < camera.width and top < camera.height
    return (left, top) if inside else None


def write_above(image: Image, corner: tuple[int, int], text: str, colour: Colour) -> None:
    """Write a text above an outline with the given upper left corner, as far as the picture has room."""
    text, scale = legible(text), max(0.42, 0.5 * image.shape[1] / 960.0)
    wide = cv2.getTextSize(text, _FONT, scale, 1)[0][0]
    left = min(max(corner[0], 4), max(4, image.shape[1] - wide - 4))
    _text(image, text, (left, max(corner[1] - 6, 14)), colour, scale)


def encode_webp(image: Image) -> bytes:
    """Return the image as a WebP file; with one version of OpenCV equal images give equal bytes."""
    return _encoded(image, ".webp", cv2.IMWRITE_WEBP_QUALITY, 60)


def encode_jpeg(image: Image) -> bytes:
    """Return the image as a JPEG file, which is made five times as fast as a WebP file and is twice as large."""
    return _encoded(image, ".jpg", cv2.IMWRITE_JPEG_QUALITY, 80)


def encode_png(image: Image) -> bytes:
    """Return the image as a PNG file; with one version of OpenCV equal images give equal bytes."""
    return _encoded(image, ".png", cv2.IMWRITE_PNG_COMPRESSION, 6)


def _encoded(image: Image, suffix: str, setting: int, value: int) -> bytes:
    """Return the image as a file of the format with this suffix, with one setting of OpenCV's encoder."""
    good, data = cv2.imencode(suffix, image, [setting, value])
    if not good:
        raise ValueError(f"an image of shape {image.shape} cannot be encoded")
    return data.tobytes()


def _draw_boundaries(image: Image, camera: Camera, lane: LaneResult, shift: tuple[float, float]) -> None:
    for boundary, p in ((lane.left, lane.p_left), (lane.right, lane.p_right)):
        ahead = np.arange(5.0, max(boundary.x_range[1], 12.0) + 0.1, 0.5)
        colour = GREEN if p >= 0.3 else FAINT
        x, y = boundary.points(ahead)
        course, pitch, z = boundary.course, lane.tilt.pitch, np.zeros_like(x)
        if course is not None:
            pitch, z = pitch - course.grade, course.height(ahead, boundary.across(ahead))
        _polyline(image, camera, x + shift[0], y + shift[1], colour, pitch, z)


def _polyline(
    image: Image,
    camera: Camera,
    x: ArrayLike,
    y: ArrayLike,
    colour: Colour,
    pitch: float = 0.0,
    z: ArrayLike = 0.0,
) -> None:
    """Draw a line on the ground or above it, against which the camera is tilted up by `pitch`, rad."""
    u, v = camera.project_ground(x, y, pitch, z)
    points = np.stack([u, v], axis=1)
    points = points[np.isfinite(points).all(axis=1) & (np.asarray(x, np.float64) > 1.0)]
    fixed = np.clip(np.round(points * 8.0), -(2**18), 2**18).astype(np.int32)
    thickness = max(2, image.shape[1] // 300)
    if len(fixed) > 1:
        cv2.polylines(image, [fixed], False, colour, thickness, cv2.LINE_AA, 3)


def _set_in(picture: Image, inset: Image) -> None:
    """Insert the camera's image into the upper right corner, a third of the picture wide, at most half of it high."""
    scale = min(picture.shape[1] // 3 / inset.shape[1], picture.shape[0] // 2 / inset.shape[0])
    width, height = (max(round(scale * size), 1) for size in inset.shape[1::-1])
    small = cv2.resize(inset, (width, height), interpolation=cv2.INTER_AREA)
    top, left = 10, picture.shape[1] - width - 10
    cv2.rectangle(picture, (left - 2, top - 2), (left + width + 1, top + height + 1), WHITE, 1)
    picture[top : top + height, left : left + width] = small


def _write(picture: Image, lane: LaneResult | None, caption: Caption) -> None:
    lines: list[tuple[str, Colour]] = [
        *(
            [(caption.state.replace("_", " ").upper(), _STATE_COLOURS.get(caption.state, WHITE))]
            if caption.state
            else []
        ),
        (f"t {caption.time:6.2f} s   v {caption.speed:5.1f} m/s ({caption.speed * 3.6:.0f} km/h)", WHITE),
    ]
    if lane is not None:
        confidence = f"left {lane.p_left:.2f}   right {lane.p_right:.2f}   sensor {lane.sensor_health:.2f}"
        lines.append((confidence, _confidence_colour(lane)))
    lines += [(legible(note), WHITE) for note in caption.notes]
    height, width = picture.shape[:2]
    scale = max(width / 960.0, LEAST_SCALE)
    pitch = round(24 * scale)
    _darken(picture[6 : 6 + pitch * len(lines) + round(14 * scale), 6 : 6 + round(390 * scale)], 0.45)
    for k, (text, colour) in enumerate(lines):
        _text(picture, text, (round(14 * scale), round(26 * scale) + k * pitch), colour, 0.55 * scale)
    messages = [(text, AMBER) for text in caption.warnings] + [(text, RED) for text in caption.alarms]
    rows = [
        (row, colour, size) for text, colour in messages for row, size in _rows(legible(text), 0.9 * scale, width - 32)
    ]
    for k, (text, colour, fitted) in enumerate(reversed(rows)):
        size = cv2.getTextSize(text, _FONT, fitted, 2)[0][0]
        left, line = max(0, (width - size) // 2), height - round((24 + 36 * k) * scale)
        above, below = round(27 * scale), round(9 * scale)
        _darken(picture[line - above : line + below, max(0, left - 12) : left + size + 12], 0.3)
        _text(picture, text, (left, line), colour, fitted)


def _rows(text: str, scale: float, most: int) -> list[tuple[str, float]]:
    """Break a text into rows of at most `most` pixels, no smaller than needed; return each with its scale."""

    def wide(row: str) -> int:
        return int(cv2.getTextSize(row, _FONT, scale, 2)[0][0])

    rows = [text]
    if SMALLEST * wide(text) > most:
        rows = [""]
        for word in text.split():
            longer = f"{rows[-1]} {word}".strip()
            if rows[-1] and SMALLEST * wide(longer) > most:
                rows.append(word)
            else:
                rows[-1] = longer
    fitted = scale * min(1.0, most / max(map(wide, rows)))
    return [(row, fitted) for row in rows]


def _confidence_colour(lane: LaneResult) -> Colour:
    lowest, highest = min(lane.p_left, lane.p_right), max(lane.p_left, lane.p_right)
    if highest < 0.3:
        return RED
    return AMBER if lowest < 0.6 else GREEN


def _darken(area: Image, share: float) -> None:
    """Darken a part of a picture for readable writing; `share` of its brightness remains."""
    area[:] = cv2.convertScaleAbs(area, alpha=share)


def _text(picture: Image, text: str, place: tuple[int, int], colour: Colour, scale: float) -> None:
    thick = 1 if scale < 0.8 else 2
    cv2.putText(picture, text, (place[0] + thick, place[1] + thick), _FONT, scale, (20, 20, 20), thick, cv2.LINE_AA)
    cv2.putText(picture, text, place, _FONT, scale, colour, thick, cv2.LINE_AA)
