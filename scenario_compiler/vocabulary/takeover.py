"""The takeover: what makes the automation ask, how it asks, who answers, and what it does when nobody does.

Defaults: warning and request thresholds are the AISA toolkit's; escalation after 4 s, the minimum-risk manoeuvre 10 s
after the request and its 4 m/s2 are after UN R157; the budget of 7 s is the most studied one.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import ClassVar, Literal

from scenario_compiler.vocabulary.driver import Driver, DriverModel, Inputs
from scenario_compiler.vocabulary.word import Number, Word, attribute, child

CauseKind = Literal["lane_confidence", "sensor_health", "path_blocked", "lane_ends", "no_progress", "controller"]
"""Why the automation asks for a takeover."""

RequestCause = Literal[CauseKind, "scheduled"]
"""Why a takeover is requested: by the automation, or by an action of the scenario."""


class Cause(Word):
    """A cause that is switched on, and its limits. Numbers left out take the kind's defaults."""

    word: Literal["cause"] = "cause"
    moved: ClassVar[Mapping[str, str]] = MappingProxyType(
        {name: f'<forward_sensor {name}="..."/> in <ego>' for name in ("range", "field_of_view")}
    )

    kind: CauseKind = attribute("What makes the automation ask.")
    warning_below: Number | None = attribute(
        "lane_confidence, sensor_health: warn when either side is below.",
        default=None,
        quantity="fraction",
        minimum=0,
        maximum=1,
    )
    request_below: Number | None = attribute(
        "lane_confidence, sensor_health: request when both sides are below.",
        default=None,
        quantity="fraction",
        minimum=0,
        maximum=1,
    )
    count: int | None = attribute(
        "Number of control steps, among the last `of`, that must ask before it counts.",
        default=None,
        minimum=1,
        maximum=32,
    )
    of: int | None = attribute(
        "Number of control steps that `count` looks back on.", default=None, minimum=1, maximum=32
    )
    margin: Number | None = attribute(
        "path_blocked: free width needed beside the vehicle's own width, m.",
        default=None,
        quantity="length",
        minimum=0,
    )
    gap_front: Number | None = attribute(
        "lane_ends: least time gap to the vehicle ahead in the lane beside, s.",
        default=None,
        quantity="time",
        minimum=0,
    )
    gap_rear: Number | None = attribute(
        "lane_ends: least time until the vehicle behind in the lane beside has closed up, s.",
        default=None,
        quantity="time",
        minimum=0,
    )
    warning_over: Number | None = attribute(
        "lane_confidence, sensor_health: a warning ends when neither side is below, at least `warning_below`.",
        default=None,
        quantity="fraction",
        minimum=0,
        maximum=1,
    )
    budget: Number | None = attribute(
        "path_blocked, lane_ends: time budget of this cause, s, in place of that of <takeover>.",
        default=None,
        quantity="time",
        minimum=0,
        exclusive=True,
    )
    warning_budget: Number | None = attribute(
        "path_blocked, lane_ends: time to the limit at which a warning begins, s; when left out it leads the request "
        "by `warning_lead`.",
        default=None,
        quantity="time",
        minimum=0,
        exclusive=True,
    )
    minimum_risk_after: Number | None = attribute(
        "Time from a request for this cause to the minimum-risk manoeuvre, s; that of <takeover> when left out, and 0 "
        "for sensor_health.",
        default=None,
        quantity="time",
        minimum=0,
    )
    after: Number | None = attribute(
        "no_progress: time for which the vehicle stands until it asks, s, while no leader that moves, no red signal "
        "and no action holds it.",
        default=None,
        quantity="time",
        minimum=0,
    )


Modality = Literal["text", "icon", "overlay", "tone", "speech", "vibration", "none"]
"""Channels of a message: a text, an icon, a mark laid over the road in the driver's view, a tone, speech, vibration of
seat or wheel; `none` tells the driver nothing.
"""

RETIRED_MODALITIES = (("audio", "tone or speech"),)
"""Channels of before, and what is to be written in their place."""

Content = Literal["what", "why", "next"]
Language = Literal["en", "de", "fi", "sv"]
"""Languages of the messages, by their ISO 639-1 codes."""


Told = Literal["warning", "request", "escalation", "minimum_risk"]
"""Events that messages announce; a message ends when one of them gives way to another or its reason ends."""


class Say(Word):
    """A text of your own, in place of those that come along."""

    word: Literal["say"] = "say"

    at: Told = attribute("Event at which it is said.")
    text: str = attribute("What is said.")


class Message(Word):
    """How the automation tells the driver."""

    word: Literal["message"] = "message"

    modality: tuple[Modality, ...] = attribute(
        "By which channels.", default=("text",), separated=True, retired=RETIRED_MODALITIES
    )
    content: tuple[Content, ...] = attribute(
        "What is said: what happens, why, what to do next.", default=("what",), separated=True
    )
    language: Language = attribute("Language of the texts.", default="en")
    after: Number = attribute(
        "Time from the event to the message, s; it does not come where its reason has ended by then.",
        default=0.0,
        quantity="time",
        minimum=0,
    )
    says: tuple[Say, ...] = child("Texts of your own.", default=())


Before = Literal["follow", "hold_speed"]
After = Literal["follow", "hold_speed", "slow_down", "let_go"]


class Automation(Word):
    """What the automation does along the road before a request and after it, until somebody answers.

    `follow` keeps the distance to what is followed, and slows down from the request on before what blocks the path and
    the end of the lane; `hold_speed` keeps the speed whatever is ahead; `slow_down` follows and brakes as given. All of
    them stop at red signals. With `let_go` the automation is switched off by its request: the wheel goes back to
    straight, the car rolls without the accelerator, and there is no minimum-risk manoeuvre.
    """

    word: Literal["automation"] = "automation"

    before: Before = attribute("Before a request.", default="follow")
    after: After = attribute("After a request.", default="follow")
    deceleration: Number = attribute(
        "Deceleration of `slow_down`, m/s2.", default=1.0, quantity="acceleration", minimum=0, exclusive=True
    )


class Takeover(Word):
    """The policy of a takeover."""

    word: Literal["takeover"] = "takeover"

    budget: Number = attribute(
        "Time budget: the time to a limit of the automation, at unchanged speed, at which it asks, s.",
        default=7.0,
        quantity="time",
        minimum=0,
        exclusive=True,
    )
    warning_lead: Number = attribute(
        "Least time by which the warning of a cause that can be foreseen leads its request, s.",
        default=1.0,
        quantity="time",
        minimum=0,
    )
    warning_after: Number = attribute(
        "Time for which there must be a reason to warn until a warning begins, s.",
        default=0.3,
        quantity="time",
        minimum=0,
    )
    warning_least: Number = attribute("Least duration of a warning, s.", default=5.0, quantity="time", minimum=0)
    warning_clear: Number = attribute(
        "Time for which there must be no reason to warn until a warning ends, s.",
        default=1.0,
        quantity="time",
        minimum=0,
    )
    escalate_after: Number = attribute(
        "Time from the request to its escalation, s.", default=4.0, quantity="time", minimum=0
    )
    minimum_risk_after: Number = attribute(
        "Time from the request to the minimum-risk manoeuvre, s; it begins earlier where a limit ahead leaves only the "
        "distance to stop.",
        default=10.0,
        quantity="time",
        minimum=0,
    )
    minimum_risk: bool = attribute(
        "Whether there is a minimum-risk manoeuvre. Without one the automation goes on as <automation> says until "
        "somebody answers, into what is ahead too, as in most studies in simulators.",
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
        "Time of manual driving after which the automation may take back, s; 0: never.",
        default=0.0,
        quantity="time",
        minimum=0,
    )
    causes: tuple[Cause, ...] = child("The causes that are switched on; all of them when none is given.", default=())
    driver: Driver | DriverModel = child("Who answers.", default_factory=Driver.model_construct)
    messages: tuple[Message, ...] = child("How the automation tells the driver.", default=())
    automation: Automation = child(
        "What the automation does before a request and after it.", default_factory=Automation.model_construct
    )
    inputs: Inputs = child("What counts as the driver's input in measures.", default_factory=Inputs.model_construct)
