"""The names of the engine's events, and their meanings for readers.

An action's own event is declared in its entry (`moves.entry.Told`).
"""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op

EVENTS: dict[int, tuple[str, str]] = {
    op.EVENT_ACTIVATION: (
        "activation",
        "The automation drives again after the driver has handed back.",
    ),
    op.EVENT_WARNING: (
        "warning",
        "The automation warns the driver; `cause` is the reason.",
    ),
    op.EVENT_REQUEST: (
        "request",
        "The automation requests a takeover; `cause` is the reason.",
    ),
    op.EVENT_ESCALATION: (
        "escalation",
        "The request becomes urgent; `cause` is that of the request.",
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
        "The minimum-risk manoeuvre begins; `cause` is that of the request.",
    ),
    op.EVENT_STANDSTILL: (
        "standstill",
        "The automated vehicle has stopped; `cause` is `driver` if a driver stopped it, `message` is the place: "
        "`own_lane`, `other_lane`, `shoulder`, `across_edge` or `off_road`.",
    ),
    op.EVENT_COLLISION: (
        "collision",
        "The box of the automated vehicle, or of the first entity, touches that of `entity`, or the world's own "
        "physics reports a collision, of which `entity` is empty if the scenario does not have the other one.",
    ),
    op.EVENT_MERGE: (
        "merge",
        "The automated vehicle begins to merge into the adjacent lane.",
    ),
    op.EVENT_MERGE_ABORTED: (
        "merge_aborted",
        "The merge is broken off.",
    ),
    op.EVENT_BRAKE: (
        "brake",
        "The driver brakes for an object that blocks the path.",
    ),
    op.EVENT_EVADE: (
        "evade",
        "The driver evades an object that blocks the path.",
    ),
    op.EVENT_STORYBOARD_START: (
        "storyboard_start",
        "An event of the storyboard begins: `message` is its name, `entity` its actor if there is one.",
    ),
    op.EVENT_STORYBOARD_END: (
        "storyboard_end",
        "The event of the storyboard ends.",
    ),
    op.EVENT_WARNING_OVER: (
        "warning_over",
        "The warning ends because its reason has ended.",
    ),
    op.EVENT_FAILURE: (
        "failure",
        "A failure of the camera begins; `cause` is its kind.",
    ),
    op.EVENT_FAILURE_END: (
        "failure_end",
        "The failure ends.",
    ),
    op.EVENT_HAZARD_LIGHTS: (
        "hazard_lights",
        "The hazard lights are switched: `value` is 1 for on, 0 for off.",
    ),
    op.EVENT_NO_PROGRESS: (
        "no_progress",
        "The automated vehicle has stood for as long as the cause `no_progress` allows, and nothing that it follows, "
        "no red signal and no action held it.",
    ),
    op.EVENT_OBSTRUCTION: (
        "obstruction",
        "The automated vehicle has come to a standstill, by a minimum-risk manoeuvre or by its driver, in a lane for "
        "driving in which nothing ahead holds it, so that it obstructs the vehicles behind.",
    ),
    op.EVENT_OUTSIDE_DOMAIN: (
        "outside_domain",
        "A feature of surrogate perception leaves, for the first time, the domain of the fit: from here on the camera "
        "could give another confidence.",
    ),
    op.EVENT_SHORT_START: (
        "short_start",
        "The run begins within the time budget of a limit ahead, by more than a control step: the request for it comes "
        "at once, with less time than the budget, and without a warning. `cause` is that of the request.",
    ),
    op.EVENT_OVERRIDE: (
        "override",
        "The person at the wheel takes over without a request.",
    ),
    op.EVENT_CONTACT: (
        "contact",
        "Two other entities touch, one of them for the first time: `entity`, and the one in `message`.",
    ),
    op.EVENT_NO_LANE: (
        "no_lane",
        "A lane change of `entity` has no effect, because its road has no such lane there.",
    ),
}
"""Name and meaning of each event, by its code. Activation, request (transition demand), response (override),
minimum-risk manoeuvre and collision are occurrences that a data storage system must record according to UN R157, 8.2.1;
the others are our own.
"""
