"""Actions on an entity's position and route."""

from __future__ import annotations

from typing import Any

from lxml import etree

from scenario_compiler.openscenario.motion import (
    anywhere,
    read_position,
    read_route,
    read_trajectory,
    write_position,
    write_route,
    write_trajectory,
)
from scenario_compiler.openscenario.node import Node
from scenario_compiler.openscenario.output import Output
from scenario_compiler.openscenario.spelling import (
    Child,
    Fields,
    Form,
    boolean,
    choice,
    entity,
    made,
    nested,
    number,
    regular,
)
from scenario_compiler.vocabulary.actions import (
    AcquirePositionAction,
    AssignRouteAction,
    ConnectTrailerAction,
    DisconnectTrailerAction,
    FinalSpeed,
    FollowTrajectoryAction,
    MasterPosition,
    RandomRouteAction,
    SynchronizeAction,
    TeleportAction,
    TrajectoryTiming,
    VisibilityAction,
)

_PRIVATE = ("PrivateAction",)
_ROUTING = ("PrivateAction", "RoutingAction")
_TRAILER = ("PrivateAction", "TrailerAction")


class _Route:
    """The route: a child, or an entry of a catalog."""

    def read(self, node: Node) -> Fields | None:
        route = read_route(node)
        return None if route is None else {"route": route}

    def write(self, word: AssignRouteAction, element: etree._Element, output: Output) -> None:
        element.append(write_route(word.route, output))


class _Trajectory:
    """The trajectory: in a <TrajectoryRef>, in 1.0 directly a child."""

    def read(self, node: Node) -> Fields | None:
        trajectory = read_trajectory(node.child("TrajectoryRef") or node)
        return None if trajectory is None else {"trajectory": trajectory}

    def write(self, word: FollowTrajectoryAction, element: etree._Element, output: Output) -> None:
        trajectory = write_trajectory(word.trajectory, output)
        element.append(trajectory if output.version == (1, 0) else nested(["TrajectoryRef"], trajectory))


_TIMING = regular(
    "Timing",
    TrajectoryTiming,
    choice(TrajectoryTiming, "domain", "domainAbsoluteRelative"),
    number("scale"),
    number("offset"),
)


class _TimeReference:
    """Whether and how the times of the trajectory are used."""

    def read(self, node: Node) -> Fields:
        reference = node.child("TimeReference")
        timing = None if reference is None else reference.child("Timing")
        if reference is not None and timing is None:
            reference.child("None")
        return {"timing": None if timing is None else _TIMING.read(timing)}

    def write(self, word: FollowTrajectoryAction, element: etree._Element, output: Output) -> None:
        timing = made("None") if word.timing is None else _TIMING.write(word.timing, output)
        element.append(made("TimeReference", timing))


class _FollowingMode:
    """Whether the entity is on the trajectory exactly, or steers along it."""

    def read(self, node: Node) -> Fields:
        mode = node.child("TrajectoryFollowingMode")
        return {} if mode is None else {"following": mode.choice("followingMode", ("position", "follow"))}

    def write(self, word: FollowTrajectoryAction, element: etree._Element, output: Output) -> None:
        del output
        element.append(made("TrajectoryFollowingMode", followingMode=word.following))


class _FinalSpeed:
    """The speed on arrival; a relative one is relative to the master entity."""

    def read(self, node: Node) -> Fields:
        inner = node.child("FinalSpeed")
        speed = None if inner is None else inner.required("AbsoluteSpeed", "RelativeSpeedToMaster")
        if speed is None:
            return {}
        fields: Fields = {"value": speed.number("value")}
        if speed.tag == "RelativeSpeedToMaster":
            master = node.text("masterEntityRef")
            fields["relative_to"] = next(iter(node.reading.known.selections.get(master, ())), master)
            fields["kind"] = speed.choice("speedTargetValueType", ("delta", "factor"))
        time, distance = speed.child("TargetTimeSteadyState"), speed.child("TargetDistanceSteadyState")
        if time is not None:
            fields["steady_time"] = time.number("time")
        if distance is not None:
            fields["steady_distance"] = distance.number("distance")
        return {"final_speed": FinalSpeed.model_construct(**fields).written_at(speed.origin)}

    def write(self, word: SynchronizeAction, element: etree._Element, output: Output) -> None:
        final = word.final_speed
        if final is None:
            return
        speed = made("AbsoluteSpeed", value=output.text(final.value, final))
        if final.relative_to:
            speed = made("RelativeSpeedToMaster", value=output.text(final.value, final))
            speed.set("speedTargetValueType", final.kind)
            if final.relative_to != word.master:
                output.tell_lost(final, "in OpenSCENARIO a final speed can be relative to the master entity only")
        for value, tag, name in (
            (final.steady_time, "TargetTimeSteadyState", "time"),
            (final.steady_distance, "TargetDistanceSteadyState", "distance"),
        ):
            if value is None:
                continue
            if output.version == (1, 0):
                output.tell_lost(final, f"<{tag}> is not known before 1.1")
            else:
                speed.append(made(tag, **{name: output.text(value, final)}))
        element.append(made("FinalSpeed", speed))


def _read_master_position(node: Node) -> MasterPosition | None:
    found = read_position(node)
    return None if found is None else MasterPosition.model_construct(position=found).written_at(node.origin)


_MASTER = Child(
    "master_position",
    "TargetPositionMaster",
    _read_master_position,
    lambda word, output: write_position(word.position, output, "TargetPositionMaster"),
)

ROUTING: tuple[Form[Any], ...] = (
    regular("TeleportAction", TeleportAction, anywhere(), around=_PRIVATE),
    regular("AssignRouteAction", AssignRouteAction, _Route(), around=_ROUTING),
    regular("AcquirePositionAction", AcquirePositionAction, anywhere(), around=_ROUTING),
    regular("RandomRouteAction", RandomRouteAction, around=_ROUTING, since=(1, 3)),
    regular(
        "FollowTrajectoryAction",
        FollowTrajectoryAction,
        number("begin", "initialDistanceOffset", 0.0, (1, 1)),
        _TimeReference(),
        _FollowingMode(),
        _Trajectory(),
        around=_ROUTING,
    ),
    regular(
        "SynchronizeAction",
        SynchronizeAction,
        entity("master", "masterEntityRef"),
        number("tolerance", "targetTolerance", 0.0, (1, 1)),
        number("master_tolerance", "targetToleranceMaster", 0.0, (1, 1)),
        _MASTER,
        anywhere("TargetPosition"),
        _FinalSpeed(),
        around=_PRIVATE,
    ),
    regular(
        "VisibilityAction",
        VisibilityAction,
        boolean("graphics"),
        boolean("sensors"),
        boolean("traffic"),
        around=_PRIVATE,
    ),
    regular(
        "ConnectTrailerAction", ConnectTrailerAction, entity("trailer", "trailerRef"), around=_TRAILER, since=(1, 3)
    ),
    regular("DisconnectTrailerAction", DisconnectTrailerAction, around=_TRAILER, since=(1, 3)),
)
"""Private actions on position, route and presence."""
