"""Recordings and plans made by hand, for tests that need to know the answer."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from scenario_compiler.engine.columns import opcodes
from scenario_compiler.plan.model import Entity, MapReference, Plan
from scenario_compiler.recording.names import EventKind
from scenario_compiler.recording.recording import Header, Recording, RecordingBuilder
from scenario_compiler.vocabulary.criteria import Criterion, NoCollision, StayOnRoad
from scenario_compiler.vocabulary.entities import Controller, Vehicle
from scenario_compiler.vocabulary.positions import LanePositionWord
from scenario_compiler.vocabulary.scenario import Classification
from scenario_compiler.vocabulary.sensors import Camera
from scenario_compiler.vocabulary.storyboard import Storyboard
from scenario_compiler.vocabulary.takeover import Takeover
from scenario_compiler.vocabulary.weather import Weather

CAR = Vehicle(name="car", length=4.0, width=2.0, height=1.5, wheelbase=2.6, center=1.0, max_steer=math.radians(40))
"""A box that reaches from 1 m behind the reference point to 3 m ahead of it."""

STEP = 0.1
Row = dict[str, Sequence[float]]


def plan_of(*ids: str, criteria: tuple[Criterion, ...] = (NoCollision(), StayOnRoad())) -> Plan:
    start = LanePositionWord(road="1", lane=-1, s=0.0)
    return Plan(
        name="made_by_hand",
        summary="A vehicle stands in the lane ahead.",
        map=MapReference(name="m", file="m.xodr", sha256="0" * 64),
        step=STEP,
        control_every=1,
        duration=10.0,
        weather=Weather(),
        entities=tuple(
            Entity(
                id=name,
                kind="ego" if i == 0 else "static",
                vehicle=CAR,
                start=start,
                speed=10.0,
                desired_speed=10.0,
            )
            for i, name in enumerate(ids)
        ),
        camera=Camera(),
        controller=Controller(),
        perception="ideal",
        storyboard=Storyboard(),
        takeover=Takeover(),
        criteria=criteria,
        classification=Classification(scheme="gold2018", number=9, urgency="3", response="1-3"),
        digest="d" * 64,
    )


def record(
    ids: Sequence[str],
    rows: int,
    row: Callable[[float], Row],
    events: Sequence[tuple[float, EventKind, str]] = (),
    stop: str = "duration",
    parameters: dict[str, float | bool | str] | None = None,
) -> Recording:
    """Record `rows` rows of what `row` returns for each time; events are (t, kind, cause or entity hit)."""
    live: dict[str, list[float]] = {name: list(values) for name, values in row(0.0).items()}
    header = Header(
        plan_digest="d" * 64,
        plan_name="made_by_hand",
        seed=1,
        step=STEP,
        entities=tuple(ids),
        perception="ideal",
        parameters=parameters or {},
        versions={"scenario-compiler": "0"},
    )
    builder = RecordingBuilder(header, ("1", "2"), live)
    for k in range(rows):
        for name, values in row(k * STEP).items():
            live[name][:] = values
        builder.append(k * STEP)
    for t, kind, about in events:
        crash = kind == "collision"
        builder.event(t, kind, entity=about if crash else "", cause="" if crash else about, message=f"{kind}!")
    return builder.finish("destination" if stop == "destination" else "error" if stop == "error" else "duration")


def approach(speed: float = 10.0, stop_at: float = math.inf) -> Callable[[float], Row]:
    """An ego vehicle on the x axis, driven at constant speed until `stop_at`, and a car at rest at x = 64 m.

    Front to rear the gap is 60 m at t = 0 (64 - 1 - 3).
    """

    def row(t: float) -> Row:
        x = speed * min(t, stop_at)
        v = speed if t < stop_at else 0.0
        return {
            "x": (x, 64.0),
            "y": (0.0, 0.0),
            "h": (0.0, 0.0),
            "v": (v, 0.0),
            "a": (0.0, 0.0),
            "road": (0, 0),
            "lane": (-1, -1),
            "s": (x, 64.0),
            "off": (0.0, 0.0),
            "brake": (0.0 if t < 3.05 else 0.4, 0.0),
            "cause": (opcodes.CAUSE_PATH_BLOCKED if t > 1.05 else opcodes.CAUSE_NONE,),
            "blocked_distance": (60.0 - x if t > 0.45 else opcodes.FAR,),
            "lane_end_distance": (opcodes.FAR,),
            "confidence_left": (0.9,),
            "confidence_right": (0.4 + 0.01 * t,),
            "takeover_state": (opcodes.TAKEOVER_AUTOMATED,),
        }

    return row
