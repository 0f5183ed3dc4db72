"""Recordings and plans made by hand, for tests that need to know the answer."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from scenario_compiler.engine.columns import opcodes, slots
from scenario_compiler.engine.columns.numbers import SAME_TIME
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import new_state
from scenario_compiler.engine.columns.totals import SUMMARY, SUMMARY_SIZE, TAKEOVERS_AT, Totals
from scenario_compiler.engine.measures.judging import finish_totals, judge_row
from scenario_compiler.engine.measures.rows import take_row
from scenario_compiler.engine.measures.takeovers import write_takeovers
from scenario_compiler.engine.motion.collision import update_boxes
from scenario_compiler.forms.declaration import at_start, write_first
from scenario_compiler.plan.model import Entity, MapReference, Plan
from scenario_compiler.recording.names import EventKind
from scenario_compiler.recording.recording import Header, Recording, RecordingBuilder
from scenario_compiler.recording.totals import RunTotals
from scenario_compiler.recording.traces import TIMED_EVENTS, Traces, traces_of
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
BLOCK = slots.E_COUPLER + 1
"""Numbers of an entity in a program."""
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
        classifications=(Classification(scheme="gold2018", number=9, urgency="3", response="1-3"),),
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


def approach(speed: float = 10.0) -> Callable[[float], Row]:
    """An ego vehicle on the x axis, driven at constant speed, and a car at rest at x = 64 m.

    Front to rear the gap is 60 m at t = 0 (64 - 1 - 3).
    """

    def row(t: float) -> Row:
        x = speed * t
        return {
            "x": (x, 64.0),
            "y": (0.0, 0.0),
            "h": (0.0, 0.0),
            "v": (speed, 0.0),
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
            "takeover_state": (opcodes.TAKEOVER_MANUAL if t > 3.05 else opcodes.TAKEOVER_AUTOMATED,),
        }

    return row


def random_runs(seed: int, rows: int = 200) -> Traces:
    """Return six runs of four vehicles of all sizes on curves, near and far from one another and into another."""
    dice = np.random.default_rng(seed)
    entities, runs = 4, 6
    shape = (entities, runs, rows)
    turning = dice.choice([0.0, 0.0, 0.002, -0.02, 0.15], (entities, runs, 1)) * dice.random((entities, runs, 1))
    v = np.cumsum(dice.normal(0.0, 0.4, shape), axis=-1) + dice.uniform(-3.0, 25.0, (entities, runs, 1))
    h = dice.choice([0.0, 0.01, 1.5, 3.1, 6.2], (entities, runs, 1)) + np.cumsum(turning * v * STEP, axis=-1)
    x = np.cumsum(v * np.cos(h) * STEP, axis=-1) + dice.uniform(-80.0, 120.0, (entities, runs, 1))
    y = np.cumsum(v * np.sin(h) * STEP, axis=-1) + dice.choice([0.0, 0.0, 1.5, 3.5, 40.0], (entities, runs, 1))
    present = dice.random(shape) < 0.97
    z = np.broadcast_to(np.where(dice.random((entities, runs, 1)) < 0.1, 6.0, 0.0), shape)
    moved = {"x": x, "y": y, "z": z, "h": np.mod(h, 2 * np.pi), "v": v}
    arrays = {name: np.moveaxis(np.where(present, each, np.nan), 0, -1) for name, each in moved.items()}
    t = np.broadcast_to(np.arange(rows) * STEP, (runs, rows))
    ids = ("ego", *"abc"[: entities - 1])
    one = traces_of(plan_of(*ids), record(ids, 1, lambda _: {"x": (0.0,) * entities}))
    nothing = {
        name: np.broadcast_to(getattr(one, name), (runs, rows, *getattr(one, name).shape[1:]))
        for name in (
            "a",
            "road",
            "lane",
            "s",
            "off",
            "steer",
            "brake",
            "takeover_state",
            "cause",
            "confidence_left",
            "confidence_right",
            "lane_width",
            "lane_heading",
            "on_road",
        )
    }
    nothing |= {
        name: np.full((runs, rows), np.nan)
        for name in ("blocked_distance", "lane_end_distance", "limit_time", "lane_time_to_collision")
    }
    nothing |= {name: np.zeros((runs, rows)) for name in ("blocked_speed", "traffic_density")}
    sizes = {"length": dice.uniform(0.5, 14.0, entities), "width": dice.uniform(0.4, 3.0, entities)}
    center = dice.uniform(-0.2, 0.4, entities) * sizes["length"]
    times = {kind: np.full(runs, np.nan) for kind in TIMED_EVENTS}
    nothing["requests"] = np.zeros(runs)
    nothing["towed_by"] = np.full((runs, rows, entities), -1)
    present = np.moveaxis(present, 0, -1)
    changed: dict[str, Any] = nothing | {
        "t": t,
        "present": present,
        **arrays,
        **sizes,
        "center": center,
        "times": times,
    }
    return dataclasses.replace(one, **changed)


def with_trailers(runs: Traces) -> Traces:
    """Return runs in which the ego tows another entity for a while, and that one a third entity for longer."""
    towed_by = runs.towed_by.copy()
    towed_by[:3, 20:80, 1], towed_by[:3, 20:110, 2] = 0, 1
    return dataclasses.replace(runs, towed_by=towed_by)


def added_up(runs: Traces) -> RunTotals:
    """Return what the engine's totals come to over the rows of runs, row by row, as a sweep adds them up."""
    lead = runs.t.shape[:-1]
    return RunTotals(
        np.array([_summary(runs, index) for index in np.ndindex(*lead)]).reshape(-1, SUMMARY_SIZE), runs.step
    )


def _summary(runs: Traces, index: tuple[int, ...]) -> list[float]:
    count = runs.x.shape[-1]
    program = Program()
    program.entity_count[:], program.ego[:] = [count], [0]
    program.entity_motion[:] = [opcodes.MOTION_SCRIPTED] * count
    program.entity_const[:] = [slots.K_ENTITIES + i * BLOCK for i in range(count)]
    program.const[:] = [0.0] * (slots.K_ENTITIES + count * BLOCK)
    program.const[slots.K_STEP] = runs.step
    program.const[slots.K_INPUT_STEERING] = runs.inputs.steering
    program.const[slots.K_INPUT_BRAKE] = runs.inputs.brake
    program.const[slots.K_STEERING_RATIO] = runs.inputs.steering_ratio
    sizes = {slots.E_LENGTH: runs.length, slots.E_WIDTH: runs.width, slots.E_HEIGHT: runs.height}
    for place, values in (*sizes.items(), (slots.E_CENTER, runs.center)):
        program.const[slots.K_ENTITIES + place :: BLOCK] = values.tolist()
    st, totals = new_state(program), at_start(Totals, program)
    st.reach[:] = (0.5 * np.hypot(runs.length, runs.width)).tolist()
    st.order[:] = range(count)
    for row in range(int((~np.isnan(runs.t[index])).sum())):
        if row:
            judge_row(program, st, totals)
        st.clock[0] = float(runs.t[index][row])
        for name in ("x", "y", "z", "h", "v", "a", "s", "off", "steer", "brake"):
            getattr(st, name)[:] = np.nan_to_num(getattr(runs, name)[index][row]).tolist()
        for name in ("road", "lane", "towed_by"):
            getattr(st, name)[:] = getattr(runs, name)[index][row].tolist()
        st.trains[0] = int(max(st.towed_by) >= 0)
        st.present[:] = runs.present[index][row].astype(int).tolist()
        st.takeover_state[0] = int(runs.takeover_state[index][row])
        st.cause[0] = int(runs.cause[index][row])
        st.conf_left[0], st.conf_right[0] = (
            float(side[index][row]) for side in (runs.confidence_left, runs.confidence_right)
        )
        st.blocked_distance[0] = _or_far(runs.blocked_distance[index][row])
        st.limit_time[0] = _or_far(runs.limit_time[index][row])
        st.lane_time[0] = _or_far(runs.lane_time_to_collision[index][row])
        st.traffic_density[0] = float(runs.traffic_density[index][row])
        st.lane_width[0] = float(np.nan_to_num(runs.lane_width[index][row]))
        st.path_heading[0] = float(np.nan_to_num(runs.lane_heading[index][row]))
        st.on_road[0] = int(runs.on_road[index][row])
        st.blocked_speed[0] = float(runs.blocked_speed[index][row])
        st.lane_end_distance[0] = _or_far(runs.lane_end_distance[index][row])
        update_boxes(program, st)
        take_row(program, st, totals)
        if row and runs.times["request"][index] <= st.clock[0] + SAME_TIME:
            st.requests[0], st.request_at[0] = 1, float(runs.times["request"][index])
        st.log_count[0] = sum(float(times[index]) <= st.clock[0] + SAME_TIME for times in runs.times.values())
        for kind, times in runs.times.items():
            time = float(times[index])
            if time <= st.clock[0] + SAME_TIME and kind == "collision" and not st.crashed[0]:
                st.crashed[0] = 1
                st.time_collision[0] = time
            elif time <= st.clock[0] + SAME_TIME and kind != "collision":
                getattr(st, f"time_{kind}")[0] = time
    finish_totals(program, st, totals)
    out = [0.0] * SUMMARY_SIZE
    write_first(totals, SUMMARY, out, 0)
    write_takeovers(totals, out, TAKEOVERS_AT)
    return out


def _or_far(distance: float) -> float:
    return opcodes.FAR if math.isnan(distance) else float(distance)
