"""Reasons for runs that differ from the recorded ones, and the variants of features that differ by decision."""

from __future__ import annotations

_UNIT_TESTS = "esmini/EnvironmentSimulator/Unittest/xosc/"
_FEATURES = "esmini_features/"

CONTINUOUS_OFFSET = (
    "By the standard a continuous LaneOffsetAction keeps its offset until another action takes the lane; esmini ends "
    "it at its target. A trigger that waits for its end is warned about."
)
SCALED_TIMES = (
    'The standard scales the times ("Scaling factor for time values. While values smaller than 1.0 represent negative '
    'scaling, values larger than 1.0 will result in positive scaling", Timing) and shifts them ("Introduction of a '
    'global offset for all time values"); esmini multiplies the rate at which they pass.'
)
RELATIVE_PROFILE = (
    '"Reference entity. If set, the speed values will be interpreted as relative delta to the speed of the referenced '
    'entity" (SpeedProfileAction, entityRef); esmini 3.6 ignores the attribute.'
)
REACHED_TURNED = (
    '"Radius of tolerance circle around given position" (ReachPositionCondition, tolerance): the standard asks for the '
    "place alone, esmini for the heading too."
)
RELATIVE_SPEED = (
    "The standard has a relative speed in a direction along the triggering entity's axes, esmini along the other's."
)
CLEARANCE_OF_BOXES = (
    'Of others "the whole bounding box is considered" (RelativeClearanceCondition, freeSpace), and distances begin at '
    "the triggering entity's reference point; esmini measures the gap between its box and the other one."
)
JUMPING_PROFILE = (
    "esmini begins the profile at its first corner without a time, so that the speed leaps by 3.9 m/s in one step, "
    "far over the action's maxAcceleration; limits hold here, and an entry without a time is reached as fast as they "
    "let it."
)
AGAINST_HEADINGS = (
    "A speed is signed along the heading. The recorded B has a positive speed and moves against its heading; A, which "
    "does the same from another start, moves along it, and agrees."
)
HEADER_OFFSET = (
    "esmini moves roads and world positions by the offset of the road file's header, so all coordinates differ by it. "
    "Roads, lanes and distances along them agree."
)

EXPLAINED: dict[str, str] = {
    _UNIT_TESTS + "test_action_dynamics.xosc": (
        "Every row agrees, the end does not: the run ends after a continuous LaneOffsetAction. " + CONTINUOUS_OFFSET
    ),
    _UNIT_TESTS + "direction_dimension_trig.xosc": (
        "Everything agrees until the Ego's event, which waits for a relative speed along a direction. "
        + RELATIVE_SPEED
        + " There it rises over -8 m/s at 2.7 s, in the standard's axes it is above that from the start, and an edge "
        "needs a rise."
    ),
    "esmini/resources/xosc/parking_demo.xosc": (
        "14 of 15 entities agree. Over the last 3 m of its clothoid spline (16.6 s to 17.6 s) esmini moves Target4 by "
        "half as much again as the speed that it reports, and ends the spline earlier."
    ),
    _UNIT_TESTS + "random_route_action.xosc": (
        "The entity whose route is random takes another turn at the junction: the draws are those of esmini's own "
        "generator. The other entity agrees."
    ),
    _FEATURES + "header_offset_world.xosc": HEADER_OFFSET,
    _FEATURES + "offset_continuous_then_next.xosc": CONTINUOUS_OFFSET,
    _FEATURES + "profile_follow_untimed.xosc": JUMPING_PROFILE,
    _FEATURES + "profile_relative_entity.xosc": RELATIVE_PROFILE,
    _FEATURES + "traj_absolute_scale_offset.xosc": SCALED_TIMES,
    _FEATURES + "traj_headings_against.xosc": AGAINST_HEADINGS,
    _FEATURES + "traj_relative_scale_offset.xosc": SCALED_TIMES,
}
"""Name of a recorded run to the reason."""

DECISIONS: dict[tuple[str, str], str] = {
    ("LaneOffsetAction", "continuous"): CONTINUOUS_OFFSET,
    ("FollowTrajectoryAction", "times scaled or shifted"): SCALED_TIMES,
    ("SpeedProfileAction", "relative to an entity"): RELATIVE_PROFILE,
    ("SpeedProfileAction", "follow, an entry without time"): JUMPING_PROFILE,
    ("ReachPositionCondition", "turned"): REACHED_TURNED,
    ("RelativeSpeedCondition", "longitudinal"): RELATIVE_SPEED,
    ("RelativeSpeedCondition", "lateral"): RELATIVE_SPEED,
    ("RelativeClearanceCondition", "of boxes"): CLEARANCE_OF_BOXES,
    ("RandomRouteAction", "used"): "The turns are drawn by a generator of our own.",
    ("Road network", "an offset in the header"): HEADER_OFFSET,
}
"""Feature and variant to why it differs by decision."""
