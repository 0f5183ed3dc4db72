"""The takeover: why and how the automation requests it, who responds, and what happens if nobody does.

Defaults: warning and request thresholds are the AISA toolkit's; escalation after 4 s, the minimum-risk manoeuvre 10 s
after the request and its 4 m/s2 are after UN R157; the budget of 7 s is the most studied one.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import ClassVar, Literal

from scenario_compiler.vocabulary.driver import Driver, DriverModel, Inputs
from scenario_compiler.vocabulary.word import Number, Word, attribute, child

CauseKind = Literal["lane_confidence", "sensor_health", "path_blocked", "lane_ends", "no_progress", "controller"]
"""Causes for which the automation requests a takeover."""

RequestCause = Literal[CauseKind, "scheduled"]
"""Causes of a request: the automation's own, or an action of the scenario."""


class Cause(Word):
    """An enabled cause of requests, and its limits. A number that is left out takes the default of this kind."""

    word: Literal["cause"] = "cause"
    moved: ClassVar[Mapping[str, str]] = MappingProxyType(
        {name: f'<forward_sensor {name}="..."/> in <ego>' for name in ("range", "field_of_view")}
    )

    kind: CauseKind = attribute("Kind of the cause.")
    warning_below: Number | None = attribute(
        "lane_confidence, sensor_health: the automation warns when the value of either side is below this.",
        default=None,
        quantity="fraction",
        minimum=0,
        maximum=1,
    )
    request_below: Number | None = attribute(
        "lane_confidence, sensor_health: the automation requests a takeover when the values of both sides are below "
        "this.",
        default=None,
        quantity="fraction",
        minimum=0,
        maximum=1,
    )
    count: int | None = attribute(
        "Number of control steps, among the last `of`, that must meet the condition before the cause takes effect.",
        default=None,
        minimum=1,
        maximum=32,
    )
    of: int | None = attribute(
        "Number of most recent control steps that `count` refers to.", default=None, minimum=1, maximum=32
    )
    margin: Number | None = attribute(
        "path_blocked: free width needed in addition to the vehicle's own width, m.",
        default=None,
        quantity="length",
        minimum=0,
    )
    gap_front: Number | None = attribute(
        "lane_ends: least time gap to the vehicle ahead in the adjacent lane, s.",
        default=None,
        quantity="time",
        minimum=0,
    )
    gap_rear: Number | None = attribute(
        "lane_ends: least time until the vehicle behind in the adjacent lane closes the gap, s.",
        default=None,
        quantity="time",
        minimum=0,
    )
    warning_over: Number | None = attribute(
        "lane_confidence, sensor_health: a warning ends when neither side is below this value, which is at least "
        "`warning_below`; the greater of `warning_below` and 0.7 if left out.",
        default=None,
        quantity="fraction",
        minimum=0,
        maximum=1,
    )
    budget: Number | None = attribute(
        "path_blocked, lane_ends: time budget of this cause, s, instead of the budget of <takeover>.",
        default=None,
        quantity="time",
        minimum=0,
        exclusive=True,
    )
    warning_budget: Number | None = attribute(
        "path_blocked, lane_ends: time to the limit at which a warning begins, s, however soon the request follows. If "
        "left out, the warning precedes the request by `warning_lead`.",
        default=None,
        quantity="time",
        minimum=0,
        exclusive=True,
    )
    minimum_risk_after: Number | None = attribute(
        "Time from a request for this cause to the minimum-risk manoeuvre, s. If left out, that of <takeover>; 0 for "
        "sensor_health.",
        default=None,
        quantity="time",
        minimum=0,
    )
    after: Number | None = attribute(
        "no_progress: time that the vehicle stands before it requests a takeover, s, while no moving leader, red "
        "signal or action holds it.",
        default=None,
        quantity="time",
        minimum=0,
    )


Modality = Literal["text", "icon", "overlay", "tone", "speech", "vibration", "none"]
"""Channels of a message: a text, an icon, an overlay on the road in the driver's view, a tone, speech, vibration of the
seat or steering wheel. With `none` the driver is not informed.
"""

RETIRED_MODALITIES = (("audio", "tone or speech"),)
"""Former channels, and what to write instead."""

Content = Literal["what", "why", "next"]
Language = Literal["en", "de", "fi", "sv"]
"""Languages of the messages, by their ISO 639-1 codes."""


Told = Literal["warning", "request", "escalation", "minimum_risk"]
"""Events that messages announce. A message ends when another event follows or its reason ends."""


class Say(Word):
    """Your own text for a message, instead of the default text."""

    word: Literal["say"] = "say"

    at: Told = attribute("Event that the text announces.")
    text: str = attribute("The text.")


class Message(Word):
    """How the automation informs the driver."""

    word: Literal["message"] = "message"

    modality: tuple[Modality, ...] = attribute(
        "Channels of the message.", default=("text",), separated=True, retired=RETIRED_MODALITIES
    )
    content: tuple[Content, ...] = attribute(
        "Content of the message: what happens, why, what to do next.", default=("what",), separated=True
    )
    language: Language = attribute("Language of the texts.", default="en")
    after: Number = attribute(
        "Time from the event to the message, s. The message is not shown if its reason has ended by then.",
        default=0.0,
        quantity="time",
        minimum=0,
    )
    says: tuple[Say, ...] = child("Your own texts.", default=())


Before = Literal["follow", "hold_speed"]
After = Literal["follow", "hold_speed", "slow_down", "let_go"]


class Automation(Word):
    """The longitudinal behaviour of the automation before a request, and after it until somebody responds.

    `follow` keeps a distance to the vehicle ahead; from the request on it also slows down before an obstacle in its
    path and before the end of the lane. `hold_speed` keeps the speed whatever is ahead. `slow_down` follows and brakes
    with the given deceleration. All of them stop at red signals. With `let_go` the request switches the automation off:
    the steering wheel returns to straight, the car rolls without the accelerator, and there is no minimum-risk
    manoeuvre.
    """

    word: Literal["automation"] = "automation"

    before: Before = attribute("Behaviour before a request.", default="follow")
    after: After = attribute("Behaviour after a request.", default="follow")
    deceleration: Number = attribute(
        "Deceleration of `slow_down`, m/s2.", default=1.0, quantity="acceleration", minimum=0, exclusive=True
    )


class Takeover(Word):
    """When and how the automation requests a takeover, and what happens then."""

    word: Literal["takeover"] = "takeover"

    budget: Number = attribute(
        "Time budget: the automation requests a takeover when, at unchanged speed, this time is left to one of its "
        "limits, s.",
        default=7.0,
        quantity="time",
        minimum=0,
        exclusive=True,
    )
    warning_lead: Number = attribute(
        "Least time at unchanged speed from the warning to the request, for causes that can be foreseen, s. There is "
        "no warning of a limit that is detected too late for this.",
        default=1.0,
        quantity="time",
        minimum=0,
    )
    warning_after: Number = attribute(
        "Time for which a reason to warn must last before a warning begins, s.",
        default=0.3,
        quantity="time",
        minimum=0,
    )
    warning_least: Number = attribute("Least duration of a warning, s.", default=5.0, quantity="time", minimum=0)
    warning_clear: Number = attribute(
        "Time for which there must be no reason to warn before a warning ends, s.",
        default=1.0,
        quantity="time",
        minimum=0,
    )
    escalate_after: Number = attribute(
        "Time from the request to its escalation, s.", default=4.0, quantity="time", minimum=0
    )
    minimum_risk_after: Number = attribute(
        "Time from the request to the minimum-risk manoeuvre, s. The manoeuvre begins earlier if otherwise the "
        "distance to a limit ahead would be too short to stop.",
        default=10.0,
        quantity="time",
        minimum=0,
    )
    minimum_risk: bool = attribute(
        "Whether there is a minimum-risk manoeuvre. Without one, the automation drives as <automation> specifies "
        "until somebody responds, even into an obstacle, as in most simulator studies.",
        default=True,
    )
    minimum_risk_deceleration: Number = attribute(
        "Deceleration of the minimum-risk manoeuvre, m/s2.",
        default=4.0,
        quantity="acceleration",
        minimum=0,
        exclusive=True,
    )
    hazard_lights: bool = attribute("Whether the hazard lights flash from the minimum-risk manoeuvre on.", default=True)
    hand_back_after: Number = attribute(
        "Time of manual driving after which the automation may take over again, s; 0 means never.",
        default=0.0,
        quantity="time",
        minimum=0,
    )
    causes: tuple[Cause, ...] = child(
        "The enabled causes; all causes if none is given. If several hold at the same control step, the request is for "
        "sensor_health if it is one of them, otherwise for the one that is written first.",
        default=(),
    )
    driver: Driver | DriverModel = child("The driver who responds.", default_factory=Driver.model_construct)
    messages: tuple[Message, ...] = child("How the automation informs the driver.", default=())
    automation: Automation = child(
        "Behaviour of the automation before and after a request.", default_factory=Automation.model_construct
    )
    inputs: Inputs = child("What counts as the driver's input.", default_factory=Inputs.model_construct)
