"""Actions along a path of one's own: over points, off the lanes if need be."""

from typing import Literal

from scenario_compiler.vocabulary.positions import Position
from scenario_compiler.vocabulary.word import Number, Word, attribute, child, same_as


class PathPoint(Word):
    """A point of a path."""

    word: Literal["point"] = "point"

    time: Number | None = attribute(
        "When the point is reached, s after the path was begun; by the entity's speed when left out. Either all points "
        "have a time or none.",
        default=None,
        quantity="time",
        minimum=0,
    )
    position: Position = child("Where it is.")


class Path(Word):
    """Move in straight lines over points, from where the entity is: a pedestrian who crosses, a trajectory.

    Points with times make it a trajectory; without them the entity keeps its speed, which other actions may change.
    """

    word: Literal["path"] = "path"

    speed: Number | None = attribute(
        "Speed from the begin of the path on, m/s; the present speed when left out. Times of points override it.",
        default=None,
        quantity="speed",
        minimum=0,
    )
    then: Literal["stop", "drive"] = attribute(
        "What follows the last point: standing there, or going on along the lane that the point is in.", default="stop"
    )
    points: tuple[PathPoint, ...] = child("Its points, in order.")


class FollowPathAction(Word):
    """Leave the lane and move in straight lines over points, from where the entity is then."""

    word: Literal["follow_path"] = "follow_path"

    speed: Number | None = same_as(Path, "speed")
    then: Literal["stop", "drive"] = same_as(Path, "then")
    points: tuple[PathPoint, ...] = same_as(Path, "points")
