"""The driver: when he answers a request, and what changes that."""

from typing import Literal

from scenario_compiler.vocabulary.word import Number, Word, attribute, child, same_as

EffectKind = Literal[
    "visual_task",
    "handheld_task",
    "eyes_closed",
    "visual_request",
    "no_request",
    "repetition",
    "time_budget",
    "traffic_density",
]
"""What changes the mean takeover time: a visual task without and with a device in the hand, closed eyes, a request that
is only seen, none at all, a second or later request, a longer time budget, and traffic.
"""

Task = Literal["none", "visual", "handheld"]
"""What a driver does beside: nothing, something to look at with free hands, something held in the hand."""

Law = Literal["lognormal", "normal", "sumo"]
"""Kind of distribution of the takeover time."""


ReferenceName = Literal["careful_and_competent", "careful_by_way", "careful_by_overlap", "rss", "fuzzy_safety_model"]
"""Reference drivers: the careful and competent driver after UN R157, whose text allows three readings of when a cut-in
is perceived (0.375 m sideways and then 0.4 s; 0.375 m and 0.72 m; overlapping sides), RSS, and the fuzzy safety model.
"""


class Effect(Word):
    """By how much something changes the mean takeover time. The spread grows and falls with the mean."""

    word: Literal["effect"] = "effect"

    of: EffectKind = attribute("What it is the effect of.")
    by: Number = attribute(
        "What it adds to the mean takeover time, s; of time_budget for each second of budget, of traffic_density for "
        "each vehicle per kilometre."
    )
    source: str = attribute("Where the number comes from.", default="")


class Inputs(Word):
    """What counts as an input of the driver where takeover times are measured on the trace.

    Two degrees at the steering wheel and a tenth of the brake pedal are the usual convention (after Gold et al. 2013,
    not verified); the steering ratio is chosen.
    """

    word: Literal["inputs"] = "inputs"

    steering: Number = attribute(
        "Change of the angle of the steering wheel since the response that is more than none, degrees.",
        default=0.03490658503988659,
        quantity="angle",
        minimum=0,
    )
    brake: Number = attribute(
        "Position of the brake pedal, 0 to 1, that is more than none.",
        default=0.1,
        quantity="fraction",
        minimum=0,
        maximum=1,
    )
    steering_ratio: Number = attribute(
        "Angle of the steering wheel over that of the front wheels.", default=16.0, minimum=0, exclusive=True
    )


class Driving(Word):
    """How the driver drives once he has taken over."""

    word: Literal["driving"] = "driving"

    brakes: float = attribute(
        "Share of drivers who only brake before what is in the way. The default is chosen.",
        default=0.0,
        quantity="fraction",
        minimum=0,
        maximum=1,
    )
    steers: float = attribute(
        "Share of drivers who steer around it where there is room and brake where there is none; the rest do both at "
        "once. The default is chosen.",
        default=1.0,
        quantity="fraction",
        minimum=0,
        maximum=1,
    )
    deceleration: Number = attribute(
        "Hardest braking, m/s2; the default is 0.774 g of the careful and competent driver after UN R157.",
        default=7.59,
        quantity="acceleration",
        minimum=0.5,
    )
    lateral_acceleration: Number = attribute(
        "Greatest lateral acceleration of a planned evasion, m/s2. The default is chosen.",
        default=5.0,
        quantity="acceleration",
        minimum=0.5,
    )
    sight: Number = attribute(
        "How far the driver sees what stands on the road, by day in clear air, m. Weather and night shorten it as they "
        "do what a camera sees. The default is chosen.",
        default=300.0,
        quantity="length",
        minimum=1,
    )
    perception: Number = attribute(
        "Time in which the risk of something new is seen, s, after UN R157.",
        default=0.4,
        quantity="time",
        minimum=0,
    )
    reaction: Number = attribute(
        "Time from then until the driver acts, s, after UN R157.", default=0.75, quantity="time", minimum=0
    )
    look_beside: Number = attribute(
        "Time for which the driver looks at the lane beside before he moves into it to pass what blocks his way, s, "
        "where there are vehicles within 150 m in it. The default is chosen.",
        default=1.0,
        quantity="time",
        minimum=0,
    )
    sdlp: Number = attribute(
        "Standard deviation of the lateral position once the driver has settled, m. The default is after the "
        "on-the-road driving test, Verster and Roth 2011, not verified.",
        default=0.2,
        quantity="length",
        minimum=0,
        maximum=1,
    )
    sdlp_at_first: Number = attribute(
        "The same right after the response, m. That it is larger is in Merat et al. 2014; the default is chosen.",
        default=0.35,
        quantity="length",
        minimum=0,
        maximum=1,
    )
    settled_after: Number = attribute(
        "Time from the response until the driver has settled, s; 35 to 40 s in Merat et al. 2014.",
        default=37.5,
        quantity="time",
        minimum=0,
        exclusive=True,
    )


class Person(Word):
    """A person at the wheel, who takes over and drives in the page of `drive`."""

    word: Literal["person"] = "person"


class Driver(Word):
    """Who answers a request: a driver of the catalog, and what he does and sees at the time."""

    word: Literal["driver"] = "driver"

    preset: str = attribute(
        "Name of a driver in the driver catalog. That no study stands for every driver is why the default is the mean "
        "over all studies: it is chosen.",
        default="study_means",
        names="driver",
    )
    takeover_time: Number | None = attribute(
        "Time from the request to the driver's first input, s, in place of what the preset says. No effect changes it.",
        default=None,
        quantity="time",
        minimum=0,
    )
    task: Task | None = attribute(
        "What the driver does while the automation drives; as in the preset's measurements when left out.", default=None
    )
    eyes_closed: bool = attribute("Whether the driver's eyes are closed when the request comes.", default=False)
    traffic_density: Number | None = attribute(
        "Vehicles per kilometre around, for an effect of traffic_density; no effect is known without a coefficient of "
        "yours. When left out it is what is counted at the request: vehicles that go the same way at 2 m/s or more, "
        "from 500 m behind to 500 m ahead, on all lanes.",
        default=None,
        minimum=0,
    )
    effects: tuple[Effect, ...] = child("Effects of your own, in place of the catalog's.", default=())
    driving: Driving | None = child("How he drives, in place of what the preset says.", default=None)
    by_person: Person | None = child(
        "A person answers; the preset stands in where nobody can: in sweeps and with --pilot.", default=None
    )


class DriverModel(Word):
    """A driver by numbers: the catalog's entry, which plans hold."""

    word: Literal["driver_model"] = "driver_model"

    name: str = attribute("Name in the catalog.", defines="driver")
    formerly: str = attribute("Name that it had before, which is refused with a hint.", default="")
    summary: str = attribute("Whom it stands for.", default="")
    source: str = attribute("Where the numbers come from.", default="")
    drives_as: ReferenceName | None = attribute(
        "Reference driver who drives once he has answered, in place of the model of a person.", default=None
    )
    law: Law = attribute(
        "Distribution of the takeover time: lognormal; normal, of those times that are positive; or sumo, that of "
        "SUMO's transition-of-control device, whose mean for a time budget L is the lesser of 2 sqrt(L) and 0.7 L.",
        default="lognormal",
    )
    mu: Number = attribute(
        "Mean of the logarithm of the takeover time in seconds; of a normal law the mean of the time, s. A study's "
        "regression is written here, as an expression over the scenario's parameters.",
        default=0.0,
    )
    sigma: Number = attribute(
        "Standard deviation of that logarithm; of a normal law that of the time, s.", default=0.0, minimum=0
    )
    missed: float = attribute(
        "sumo: probability that the answer comes after the time budget.",
        default=0.05,
        quantity="fraction",
        minimum=0.0001,
        maximum=0.49,
    )
    late: float = attribute(
        "Share of answers that come late: between the median and `latest`, evenly on a logarithmic scale.",
        default=0.0,
        quantity="fraction",
        minimum=0,
        maximum=1,
    )
    latest: float = attribute("Longest late takeover time, s.", default=0.0, quantity="time", minimum=0)
    lapse: float = attribute("Probability of no answer at all.", default=0.0, quantity="fraction", minimum=0, maximum=1)
    takeover_time: Number | None = attribute(
        "Time from the request to the driver's first input, s, in place of the distribution.",
        default=None,
        quantity="time",
        minimum=0,
    )
    by_person: Person | None = child("A person answers in place of this model.", default=None)
    person: float = attribute(
        "Share of the variance that is between people: one person drives a whole run, and its requests are correlated "
        "by this. The default is chosen.",
        default=0.5,
        quantity="fraction",
        minimum=0,
        maximum=1,
    )
    eyes_on: float = attribute(
        "Median share of the takeover time after which the eyes are on the road. The default is chosen.",
        default=0.3,
        quantity="fraction",
        minimum=0.01,
        maximum=0.99,
    )
    hands_on: float = attribute(
        "Median share of the time from then to the first input after which the hands are on the wheel. The default is "
        "chosen.",
        default=0.4,
        quantity="fraction",
        minimum=0.01,
        maximum=0.99,
    )
    stage_spread: float = attribute(
        "Standard deviation of the logit of both shares. The default is chosen.", default=0.4, minimum=0, maximum=5
    )
    reference_budget: Number | None = attribute(
        "Time budget that the numbers hold for, s, from which the effect of time_budget counts; without it the budget "
        "makes no difference.",
        default=None,
        quantity="time",
        minimum=0,
    )
    measured_task: Task = attribute("What the drivers did in the measurements.", default="none")
    task: Task | None = same_as(Driver, "task")
    eyes_closed: bool = same_as(Driver, "eyes_closed")
    traffic_density: Number | None = same_as(Driver, "traffic_density")
    effects: tuple[Effect, ...] = child("Effects, in place of the catalog's.", default=())
    driving: Driving = child("How he drives.", default_factory=Driving.model_construct)
