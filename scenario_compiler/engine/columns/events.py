"""The names of the engine's events, and their meanings for readers.

An action's own event is declared in its entry (`moves.entry.Told`).
"""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op

EVENTS: dict[int, tuple[str, str]] = {
    op.EVENT_ACTIVATION: (
        "activation",
        "The automation drives again after a hand-back.",
    ),
    op.EVENT_WARNING: (
        "warning",
        "The driver is warned; `cause` says why.",
    ),
    op.EVENT_REQUEST: (
        "request",
        "A takeover is requested; `cause` says why.",
    ),
    op.EVENT_ESCALATION: (
        "escalation",
        "The request is made urgent; `cause` as above.",
    ),
    op.EVENT_RESPONSE: (
        "response",
        "The driver takes over.",
    ),
    op.EVENT_EYES_ON: (
        "eyes_on",
        "The driver's eyes are on the road after a request; `value` is the time since it.",
    ),
    op.EVENT_HANDS_ON: (
        "hands_on",
        "The driver's hands are on the wheel after a request; `value` is the time since it.",
    ),
    op.EVENT_HAND_BACK: (
        "hand_back",
        "The driver hands back to the automation.",
    ),
    op.EVENT_MINIMUM_RISK: (
        "minimum_risk",
        "The minimum-risk manoeuvre begins; `cause` as above.",
    ),
    op.EVENT_STANDSTILL: (
        "standstill",
        "The automated vehicle stands; `cause` is `driver` where a driver stopped it, `message` says where: "
        "`own_lane`, `other_lane`, `shoulder` or `off_road`.",
    ),
    op.EVENT_COLLISION: (
        "collision",
        "Two boxes touch: the automated vehicle's, or the first entity's, and that of `entity`.",
    ),
    op.EVENT_MERGE: (
        "merge",
        "A move to the lane beside begins.",
    ),
    op.EVENT_MERGE_ABORTED: (
        "merge_aborted",
        "That move is broken off.",
    ),
    op.EVENT_BRAKE: (
        "brake",
        "The driver brakes before what blocks the path.",
    ),
    op.EVENT_EVADE: (
        "evade",
        "The driver evades what blocks the path.",
    ),
    op.EVENT_STORYBOARD_START: (
        "storyboard_start",
        "An event of the storyboard begins: `message` is its name, `entity` who does it if one does.",
    ),
    op.EVENT_STORYBOARD_END: (
        "storyboard_end",
        "It ends.",
    ),
    op.EVENT_WARNING_OVER: (
        "warning_over",
        "The warning's reason is gone.",
    ),
    op.EVENT_FAILURE: (
        "failure",
        "A failure of the camera begins; `cause` is its kind.",
    ),
    op.EVENT_FAILURE_END: (
        "failure_end",
        "It ends.",
    ),
    op.EVENT_HAZARD_LIGHTS: (
        "hazard_lights",
        "`value` 1: on, 0: off.",
    ),
    op.EVENT_NO_PROGRESS: (
        "no_progress",
        "The automated vehicle has stood for as long as the cause `no_progress` allows, and nothing that it follows, "
        "no red signal and no action held it.",
    ),
    op.EVENT_OBSTRUCTION: (
        "obstruction",
        "The automated vehicle has come to a standstill, by a minimum-risk manoeuvre or by its driver, in a lane for "
        "driving in which nothing ahead holds it: it is in the way of those behind.",
    ),
    op.EVENT_OUTSIDE_DOMAIN: (
        "outside_domain",
        "What surrogate perception goes by is outside the domain for which it was fitted, for the first time: from "
        "here on the camera may answer otherwise.",
    ),
    op.EVENT_OVERRIDE: (
        "override",
        "The person at the wheel takes over without being asked.",
    ),
    op.EVENT_CONTACT: (
        "contact",
        "Two others touch, one of them for the first time: `entity`, and the one that `message` names.",
    ),
}
"""By an event's code its name and what it tells. Activation, request (transition demand), response (override),
minimum-risk manoeuvre and collision are occurrences that UN R157, 8.2.1, has a data storage system record; the others
are ours.
"""
