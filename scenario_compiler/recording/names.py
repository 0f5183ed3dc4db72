"""The names that a recording and its files use for the engine's integer codes."""

from __future__ import annotations

from typing import Literal

from scenario_compiler.engine import opcodes
from scenario_compiler.vocabulary.sensors import FailureKind

StateName = Literal[
    "automated", "warning", "request", "escalation", "manual", "hand_back", "minimum_risk", "standstill"
]
"""States of the takeover."""

EventKind = Literal[
    "activation", "warning", "warning_over", "request", "escalation", "response", "hand_back", "minimum_risk",
    "standstill", "collision", "contact", "merge", "merge_aborted", "brake", "evade", "sensor_noise", "failure",
    "failure_end", "weather", "hazard_lights", "storyboard_start", "storyboard_end", "message", "light",
    "command", "signal", "stop",
]  # fmt: skip
"""Kinds of events. Activation, request (transition demand), response (override), minimum-risk manoeuvre and
collision are occurrences that UN R157, 8.2.1, has a data storage system record; the others are ours."""

StopReason = Literal[
    "", "duration", "trigger", "destination", "standstill", "collision", "error", "controller_failed", "user"
]  # fmt: skip
"""Why a run ended; empty while it goes on, `user` when a person or a program ended it."""

BROKEN: frozenset[StopReason] = frozenset(("error", "controller_failed"))
"""Reasons of runs that broke off."""

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
}

EVENT_KINDS: dict[int, EventKind] = {
    opcodes.EVENT_ACTIVATION: "activation",
    opcodes.EVENT_WARNING: "warning",
    opcodes.EVENT_WARNING_OVER: "warning_over",
    opcodes.EVENT_REQUEST: "request",
    opcodes.EVENT_ESCALATION: "escalation",
    opcodes.EVENT_RESPONSE: "response",
    opcodes.EVENT_HAND_BACK: "hand_back",
    opcodes.EVENT_MINIMUM_RISK: "minimum_risk",
    opcodes.EVENT_STANDSTILL: "standstill",
    opcodes.EVENT_COLLISION: "collision",
    opcodes.EVENT_MERGE: "merge",
    opcodes.EVENT_MERGE_ABORTED: "merge_aborted",
    opcodes.EVENT_BRAKE: "brake",
    opcodes.EVENT_EVADE: "evade",
    opcodes.EVENT_SENSOR_NOISE: "sensor_noise",
    opcodes.EVENT_STORYBOARD_START: "storyboard_start",
    opcodes.EVENT_STORYBOARD_END: "storyboard_end",
    opcodes.EVENT_FAILURE: "failure",
    opcodes.EVENT_FAILURE_END: "failure_end",
    opcodes.EVENT_WEATHER: "weather",
    opcodes.EVENT_MESSAGE: "message",
    opcodes.EVENT_LIGHT: "light",
    opcodes.EVENT_COMMAND: "command",
    opcodes.EVENT_SIGNAL: "signal",
    opcodes.EVENT_HAZARD_LIGHTS: "hazard_lights",
    opcodes.EVENT_CONTACT: "contact",
}

FAILURES: dict[int, FailureKind] = {
    opcodes.FAILURE_NOISE: "noise",
    opcodes.FAILURE_DROPOUT: "dropout",
    opcodes.FAILURE_FREEZE: "freeze",
    opcodes.FAILURE_BLACKOUT: "blackout",
    opcodes.FAILURE_BLUR: "blur",
    opcodes.FAILURE_DIRT: "dirt",
}

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
    opcodes.FAULT_OFF_ROAD_START: "a start position lies on no lane",
    opcodes.FAULT_UNKNOWN_CONDITION: "the program holds an unknown condition",
    opcodes.FAULT_UNKNOWN_ACTION: "the program holds an unknown action",
    opcodes.FAULT_UNKNOWN_SHAPE: "the program holds an unknown transition shape",
    opcodes.FAULT_UNKNOWN_MOTION: "the program holds an unknown kind of motion",
    opcodes.FAULT_DELAY_OVERFLOW: "a delayed condition changes too often to be remembered",
    opcodes.FAULT_UNKNOWN_RULE: "the program holds an unknown comparison",
    opcodes.FAULT_UNKNOWN_EDGE: "the program holds an unknown condition edge",
    opcodes.FAULT_NO_ROOM: "there is no free place left to draw for it",
}
"""What a run's fault code means."""

BY_HAND = "driver"
"""Cause of a standstill that a driver brought about: the takeover's state stays as it was."""

STATE_AFTER: dict[EventKind, StateName] = {
    "activation": "automated",
    "warning": "warning",
    "warning_over": "automated",
    "request": "request",
    "escalation": "escalation",
    "response": "manual",
    "hand_back": "hand_back",
    "minimum_risk": "minimum_risk",
    "standstill": "standstill",
}
"""The takeover's state that begins with an event."""
