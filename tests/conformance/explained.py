"""Why runs differ from the recorded ones, where they do."""

from __future__ import annotations

_UNIT_TESTS = "esmini/EnvironmentSimulator/Unittest/xosc/"

EXPLAINED: dict[str, str] = {
    _UNIT_TESTS + "test_action_dynamics.xosc": (
        "Every row agrees, the end does not. The run ends after a continuous LaneOffsetAction, which esmini ends at "
        "its target. By the standard a continuous one does not end by itself."
    ),
    _UNIT_TESTS + "direction_dimension_trig.xosc": (
        "Everything agrees until the Ego's event, which waits for a relative speed along a direction. The standard has "
        "it along the triggering entity's axes, esmini along the other's; there it rises over -8 m/s at 2.7 s, in the "
        "standard's axes it is above that from the start, and an edge needs a rise."
    ),
    "esmini/resources/xosc/parking_demo.xosc": (
        "13 of 15 entities agree. Over the last 3 m of its clothoid spline (16.6 s to 17.6 s) esmini moves Target4 by "
        "half as much again as the speed that it reports, and ends the spline earlier. The Camera's NURBS, whose "
        "control points have times, is up to 0.25 m apart: esmini places the times on a coarse polyline."
    ),
    _UNIT_TESTS + "random_route_action.xosc": (
        "The entity whose route is random takes another turn at the junction: the draws are those of esmini's own "
        "generator. The other entity agrees."
    ),
}
"""Path of a scenario in the corpus to the reason."""
