"""Actions along a path over points, on or off the lanes."""

from typing import Literal

from scenario_compiler.vocabulary.positions import Position
from scenario_compiler.vocabulary.word import Number, Word, attribute, child, same_as


class PathPoint(Word):
    """A point of a path."""

    word: Literal["point"] = "point"

    time: Number | None = attribute(
        "Time of arrival at the point, s after the start of the path; determined by the entity's speed if left out. "
        "Either all points have a time or none.",
        default=None,
        quantity="time",
        minimum=0,
    )
    position: Position = child("Position.")


class Path(Word):
    """Move in straight lines from the present position over points: a crossing pedestrian, a trajectory.

    With times the points form a trajectory. Without times the entity keeps its speed, which other actions may change.
    """

    word: Literal["path"] = "path"

    speed: Number | None = attribute(
        "Speed from the start of the path, m/s; the present speed if left out. Times of the points override it.",
        default=None,
        quantity="speed",
        minimum=0,
    )
    then: Literal["stop", "drive"] = attribute(
        "Behaviour after the last point: stand there, or drive on along the lane in which it lies.", default="stop"
    )
    points: tuple[PathPoint, ...] = child("The points, in order.")


class FollowPathAction(Word):
    """Leave the lane and move in straight lines from the present position over points.

    The automated vehicle does not: it steers itself.
    """

    word: Literal["follow_path"] = "follow_path"

    speed: Number | None = same_as(Path, "speed")
    then: Literal["stop", "drive"] = same_as(Path, "then")
    points: tuple[PathPoint, ...] = same_as(Path, "points")
