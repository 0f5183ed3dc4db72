"""Names for the engine's integer codes in a recording and its files."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal, TypeAlias

from scenario_compiler.engine.columns import opcodes
from scenario_compiler.engine.columns.events import EVENTS
from scenario_compiler.engine.moves.camera import FAILURE_CODES
from scenario_compiler.engine.moves.table import ACTIONS

StateName = Literal[
    "automated", "warning", "request", "escalation", "manual", "hand_back", "minimum_risk", "standstill"
]
"""States of the takeover."""

TimelineState = Literal[StateName, "collision"]
"""States in the timeline of a run: after the first collision there is no takeover any more."""

EventKind: TypeAlias = str
"""Kind of an event, one of EVENT_TEXTS."""

MOMENTS: tuple[EventKind, ...] = (
    "warning", "request", "escalation", "response", "minimum_risk", "collision", "standstill",
)  # fmt: skip
"""Kinds of events whose first occurrence is pictured and marked in reports."""

StopReason = Literal[
    "", "duration", "trigger", "destination", "standstill", "collision", "error", "world_lost",
    "controller_failed", "user",
]  # fmt: skip
"""Why a run ended; empty while it goes on, `user` if a person or a program ended it."""

BROKEN_OFF: frozenset[StopReason] = frozenset({"error", "world_lost", "controller_failed"})
"""Reasons for which a run could not go on."""

TAKEOVER_STATES: dict[int, StateName] = {
    opcodes.TAKEOVER_AUTOMATED: "automated",
    opcodes.TAKEOVER_WARNING: "warning",
    opcodes.TAKEOVER_REQUEST: "request",
    opcodes.TAKEOVER_ESCALATION: "escalation",
    opcodes.TAKEOVER_MANUAL: "manual",
    opcodes.TAKEOVER_HAND_BACK: "hand_back",
    opcodes.TAKEOVER_MINIMUM_RISK: "minimum_risk",
    opcodes.TAKEOVER_STANDSTILL: "standstill",
}

CAUSES: dict[int, str] = {
    opcodes.CAUSE_NONE: "",
    opcodes.CAUSE_CONTROLLER: "controller",
    opcodes.CAUSE_SENSOR_HEALTH: "sensor_health",
    opcodes.CAUSE_LANE_CONFIDENCE: "lane_confidence",
    opcodes.CAUSE_PATH_BLOCKED: "path_blocked",
    opcodes.CAUSE_LANE_ENDS: "lane_ends",
    opcodes.CAUSE_NO_PROGRESS: "no_progress",
    opcodes.CAUSE_SCHEDULED: "scheduled",
}

EVENT_TEXTS: dict[EventKind, str] = {
    **dict(EVENTS.values()),
    **{entry.told.event: entry.told.text for entry in ACTIONS if entry.told is not None},
    "world_collision": "The world's own physics reports a collision of the ego vehicle with `entity`, which also "
    "causes the event `collision`; `message` is the world's name of the other one.",
    "lane_invasion": "The world's own sensor reports that the ego vehicle crosses a mark; `message` is its type.",
    "message_over": "The message has ended, together with its reason: `message` is its text, `cause` its modality.",
    "message_given": "How the page gave the driver a message of the modality `cause`: `message` is `file` (a recorded "
    "sound), `browser` (its speech synthesis), `text` (shown, because it could not be spoken), `gamepad`, `phone`, or "
    "`none`.",
    "person_left": "The page of the person at the wheel was closed. The vehicle stops if that person was driving.",
    "person_back": "The page of the person at the wheel is open again.",
    "person_silent": "The page of the person at the wheel has sent nothing for 0.5 s: pedals and steering wheel count "
    "as released. If that person was driving, the vehicle stops after 2 s without a message.",
    "person_heard": "The page of the person at the wheel sends the person's inputs again.",
    "broken_off": "The run cannot go on: `cause` is a diagnostic code, `message` gives the reason.",
    "stop": "The run ends; `message` is the stop reason.",
}
"""Every kind of event, and its meaning: the engine's events, its actions', the worlds' and the loop's."""

WORLD_EVENTS: frozenset[EventKind] = frozenset({"world_collision", "lane_invasion"})
"""Events that only the sensors of some worlds report."""

SOURCES: dict[int, str] = {0: "automation", 1: "driver model", 2: "person", 3: "minimum-risk manoeuvre"}
"""The source of the automated vehicle's commands."""

Wish: TypeAlias = Literal["", "take_over", "hand_back", "leave", "request"]
"""A person's wish to the automation: a person who leaves lets it stop the vehicle, an observer lets it request."""

WISHES: dict[int, Wish] = {
    opcodes.WISH_NONE: "",
    opcodes.WISH_TAKE_OVER: "take_over",
    opcodes.WISH_HAND_BACK: "hand_back",
    opcodes.WISH_LEAVE: "leave",
    opcodes.WISH_REQUEST: "request",
}
"""The wish of the person at the wheel."""

CODES: dict[str, Mapping[int, str]] = {
    "state": TAKEOVER_STATES,
    "cause": CAUSES,
    "source": SOURCES,
    "wish": WISHES,
}
"""Names of the codes of one kind of column."""

FAILURES = {code: name for name, code in FAILURE_CODES.items()}

STOP_REASONS: dict[int, StopReason] = {
    opcodes.STOP_NONE: "",
    opcodes.STOP_DURATION: "duration",
    opcodes.STOP_TRIGGER: "trigger",
    opcodes.STOP_DESTINATION: "destination",
    opcodes.STOP_STANDSTILL: "standstill",
    opcodes.STOP_COLLISION: "collision",
    opcodes.STOP_ERROR: "error",
}

FAULTS: dict[int, str] = {
    opcodes.FAULT_NOT_FINITE: "a position or speed is no longer a finite number",
    opcodes.FAULT_OFF_ROAD_START: "a position lies on no lane",
    opcodes.FAULT_UNKNOWN_CONDITION: "the program holds an unknown condition",
    opcodes.FAULT_UNKNOWN_ACTION: "the program holds an unknown action",
    opcodes.FAULT_UNKNOWN_SHAPE: "the program holds an unknown transition shape",
    opcodes.FAULT_UNKNOWN_MOTION: "the program holds an unknown kind of motion",
    opcodes.FAULT_DELAY_OVERFLOW: "a delayed condition changes too often for its history to be stored",
    opcodes.FAULT_UNKNOWN_RULE: "the program holds an unknown comparison",
    opcodes.FAULT_UNKNOWN_EDGE: "the program holds an unknown condition edge",
    opcodes.FAULT_NO_ROOM: "no free place is left for a random position",
}
"""What a run's fault code means."""

StandingPlace = Literal["", "own_lane", "other_lane", "shoulder", "across_edge", "off_road"]
"""Where a stopped vehicle stands; empty if it was not stopped."""

STANDING_PLACES: dict[int, StandingPlace] = {
    opcodes.STANDS_NOWHERE: "",
    opcodes.STANDS_IN_OWN_LANE: "own_lane",
    opcodes.STANDS_IN_OTHER_LANE: "other_lane",
    opcodes.STANDS_ON_SHOULDER: "shoulder",
    opcodes.STANDS_OFF_ROAD: "off_road",
    opcodes.STANDS_ACROSS_EDGE: "across_edge",
}

BY_HAND = "driver"
"""Cause of a standstill that a driver brought about; the takeover's state does not change."""

STATE_AFTER: dict[EventKind, TimelineState] = {
    "activation": "automated",
    "warning": "warning",
    "warning_over": "automated",
    "request": "request",
    "escalation": "escalation",
    "response": "manual",
    "override": "manual",
    "hand_back": "hand_back",
    "minimum_risk": "minimum_risk",
    "standstill": "standstill",
    "collision": "collision",
}
"""The state that begins with an event."""
