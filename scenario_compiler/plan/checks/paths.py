"""Checks that either all points of a path have a time or none, and that times do not go back."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from itertools import pairwise

from scenario_compiler.diagnostics import Code, Diagnostics
from scenario_compiler.expressions import Value
from scenario_compiler.plan.model import Plan
from scenario_compiler.roads import Network
from scenario_compiler.vocabulary.actions import FollowPathAction, FollowTrajectoryAction
from scenario_compiler.vocabulary.actions.path import Path
from scenario_compiler.vocabulary.positions import Polyline, Trajectory
from scenario_compiler.vocabulary.scenario import parameter_values
from scenario_compiler.vocabulary.traversal import walk
from scenario_compiler.vocabulary.word import number_value

PATH_TIMES = Code(
    "SC384",
    "path-times",
    "The times of a path's points do not make a trajectory: some points have one and others none, or a time is not "
    "later than the one before. Or a trajectory is followed by its times, and some of its vertices, control points or "
    "clothoids have none, or a negative one; or the times of its vertices fall. Times count from the start of the "
    "path:\n\n"
    '    <path><point time="2"><lane road="1" lane="-1" s="40"/></point>\n'
    '          <point time="4"><lane road="1" lane="-1" s="55"/></point></path>\n\n'
    "Without times the actor moves at its own speed; <path speed=...> sets it.",
)


def check_paths(plan: Plan, network: Network, sink: Diagnostics) -> None:
    """Report points of paths with inconsistent times, at the parameters' values."""
    del network
    values = parameter_values(plan.parameters)
    for path in _paths(plan):
        times = [None if one.time is None else number_value(one.time, values) for one in path.points]
        for (before, time), point in zip(
            pairwise([None if times[0] is None else 0.0, *times]), path.points, strict=True
        ):
            if (before is None) != (time is None):
                message = "some points of the path have a time and others have none"
            elif before is not None and time is not None and time < before + (0.0 if point is path.points[0] else 1e-6):
                message = f"the point is due at {time:g} s, but the one before at {before:g} s"
            else:
                continue
            sink.add(PATH_TIMES, message, point.place_of("time") if time is not None else point.origin)
    for word in plan.words():
        if isinstance(word, Polyline):
            _check_vertices(word, values, sink)
        elif isinstance(word, FollowTrajectoryAction) and word.timing is not None:
            _check_times(word.trajectory, values, sink)


def _check_times(trajectory: Trajectory, values: Mapping[str, Value], sink: Diagnostics) -> None:
    """Report the parts without a time, or with a negative one, of a trajectory that is followed by its times."""
    given = [time for _, time in trajectory.times if time is not None]
    for part, time in trajectory.times if given else ():
        if time is None:
            sink.add(PATH_TIMES, "other parts of the trajectory have a time and this one has none", part.origin)
        elif number_value(time, values) < 0.0:
            message = f"this part of the trajectory is due at {number_value(time, values):g} s, before 0 s"
            sink.add(PATH_TIMES, message, part.origin)


def _check_vertices(line: Polyline, values: Mapping[str, Value], sink: Diagnostics) -> None:
    """Report each vertex that is due before an earlier one; equal times are a jump, which real files contain."""
    latest = -math.inf
    for vertex in line.vertices:
        time = None if vertex.time is None else number_value(vertex.time, values)
        if time is not None and time < latest:
            message = f"the vertex is due at {time:g} s, but one before it at {latest:g} s"
            sink.add(PATH_TIMES, message, vertex.place_of("time"))
        latest = latest if time is None else max(latest, time)


def _paths(plan: Plan) -> Iterator[Path | FollowPathAction]:
    for entity in plan.entities:
        if entity.path is not None:
            yield entity.path
    yield from (word for word in walk(plan.storyboard) if isinstance(word, FollowPathAction))
