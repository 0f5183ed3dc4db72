"""The driver: how long a response to a request takes, and the factors that change this time."""

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
"""Factors that change the mean takeover time: a visual task without or with a hand-held device, closed eyes, a request
that is only visual, no request at all, a second or later request, a longer time budget, and traffic.
"""

Task = Literal["none", "visual", "handheld"]
"""A driver's secondary task: none, a visual one with free hands, or one with a device in the hand."""

Law = Literal["lognormal", "normal", "sumo"]
"""Kind of distribution of the takeover time."""


ReferenceName = Literal["careful_and_competent", "careful_by_way", "careful_by_overlap", "rss", "fuzzy_safety_model"]
"""Reference drivers: the careful and competent driver after UN R157, RSS, and the fuzzy safety model. The text of R157
allows three readings of the moment at which a cut-in is perceived: 0.375 m sideways and then 0.4 s; 0.375 m and 0.72 m;
overlapping sides.
"""


class Effect(Word):
    """The amount by which a factor changes the mean takeover time. The spread changes in proportion to the mean."""

    word: Literal["effect"] = "effect"

    of: EffectKind = attribute("The factor.")
    by: Number = attribute(
        "Change of the mean takeover time, s; for time_budget per second of budget, for traffic_density per vehicle "
        "per kilometre."
    )
    source: str = attribute("Source of the number.", default="")


class Inputs(Word):
    """What counts as a driver's input when takeover times are measured on the trace.

    Two degrees at the steering wheel and a tenth of the brake pedal are the usual convention (after Gold et al. 2013,
    not verified). The steering ratio is our own choice.
    """

    word: Literal["inputs"] = "inputs"

    steering: Number = attribute(
        "Least change of the steering wheel angle since the response that counts as an input, degrees.",
        default=0.03490658503988659,
        quantity="angle",
        minimum=0,
    )
    brake: Number = attribute(
        "Least position of the brake pedal that counts as an input, 0 to 1.",
        default=0.1,
        quantity="fraction",
        minimum=0,
        maximum=1,
    )
    steering_ratio: Number = attribute(
        "Ratio of the steering wheel angle to the angle of the front wheels.", default=16.0, minimum=0, exclusive=True
    )


class Driving(Word):
    """How the driver drives after taking over."""

    word: Literal["driving"] = "driving"

    brakes: float = attribute(
        "Share of drivers who only brake for an obstacle. The default is our own choice.",
        default=0.0,
        quantity="fraction",
        minimum=0,
        maximum=1,
    )
    steers: float = attribute(
        "Share of drivers who steer around an obstacle if there is room, and brake if there is not. The remaining "
        "drivers do both at once. The default is our own choice.",
        default=1.0,
        quantity="fraction",
        minimum=0,
        maximum=1,
    )
    deceleration: Number = attribute(
        "Hardest braking, m/s2. The default, 0.774 g, is that of the careful and competent driver in UN R157.",
        default=7.59,
        quantity="acceleration",
        minimum=0.5,
    )
    lateral_acceleration: Number = attribute(
        "Greatest lateral acceleration of a planned evasion, m/s2. The default is our own choice.",
        default=5.0,
        quantity="acceleration",
        minimum=0.5,
    )
    sight: Number = attribute(
        "Distance at which the driver sees an object on the road, by day in clear air, m. Weather and night reduce it "
        "in the same way as a camera's range. The default is our own choice.",
        default=300.0,
        quantity="length",
        minimum=1,
    )
    perception: Number = attribute(
        "Time to perceive the risk of a new object, s, after UN R157.",
        default=0.4,
        quantity="time",
        minimum=0,
    )
    reaction: Number = attribute(
        "Time from this perception to the driver's action, s, after UN R157.", default=0.75, quantity="time", minimum=0
    )
    look_beside: Number = attribute(
        "Time for which the driver looks at the adjacent lane, if it has vehicles within 150 m, before moving into it "
        "to pass an obstacle, s. The default is our own choice.",
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
        "Standard deviation of the lateral position right after the response, m. Merat et al. 2014 report that it is "
        "larger; the default is our own choice.",
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
    """A person at the wheel, who takes over and drives on the page of `drive`."""

    word: Literal["person"] = "person"


class Driver(Word):
    """The driver who responds to a request: a driver of the catalog, with a secondary task and the traffic around."""

    word: Literal["driver"] = "driver"

    preset: str = attribute(
        "Name of a driver in the driver catalog. No single study represents all drivers, so the default is the mean "
        "over all studies; this is our own choice.",
        default="study_means",
        names="driver",
    )
    takeover_time: Number | None = attribute(
        "Fixed time from the request to the driver's first input, s, instead of the preset's distribution. Effects do "
        "not change it.",
        default=None,
        quantity="time",
        minimum=0,
    )
    task: Task | None = attribute(
        "The driver's secondary task while the automation drives; if left out, the task in the preset's measurements.",
        default=None,
    )
    eyes_closed: bool = attribute("Whether the driver's eyes are closed when the request comes.", default=False)
    traffic_density: Number | None = attribute(
        "Vehicles per kilometre around the ego, for an effect of traffic_density. That effect has no default: without "
        "a coefficient of your own, the density changes nothing. If left out, the density is counted at the request: "
        "vehicles that drive in the same direction at 2 m/s or more, from 500 m behind to 500 m ahead, on all lanes.",
        default=None,
        minimum=0,
    )
    effects: tuple[Effect, ...] = child("Your own effects, instead of the catalog's.", default=())
    driving: Driving | None = child("How the driver drives, instead of the preset's values.", default=None)
    by_person: Person | None = child(
        "A person responds. The preset is used where no person can be present: in sweeps and with --pilot.",
        default=None,
    )


class DriverModel(Word):
    """A driver described by numbers: an entry of the catalog, which plans contain."""

    word: Literal["driver_model"] = "driver_model"

    name: str = attribute("Name in the catalog.", defines="driver")
    formerly: str = attribute("Former name. Using it is an error, and the hint names the new one.", default="")
    summary: str = attribute("The drivers that this entry represents.", default="")
    source: str = attribute("Source of the numbers.", default="")
    drives_as: ReferenceName | None = attribute(
        "Reference driver that drives after the response, instead of the model of a person.", default=None
    )
    law: Law = attribute(
        "Distribution of the takeover time: `lognormal`; `normal`, truncated to positive times; or `sumo`, that of "
        "SUMO's transition-of-control device, whose mean for a time budget L is the smaller of 2 sqrt(L) and 0.7 L.",
        default="lognormal",
    )
    mu: Number = attribute(
        "Mean of the logarithm of the takeover time in seconds; for a normal distribution, the mean of the time, s. "
        "To use a study's regression, write it here as an expression over the scenario's parameters.",
        default=0.0,
    )
    sigma: Number = attribute(
        "Standard deviation of this logarithm; for a normal distribution, the standard deviation of the time, s.",
        default=0.0,
        minimum=0,
    )
    missed: float = attribute(
        "sumo: probability that the response comes after the time budget.",
        default=0.05,
        quantity="fraction",
        minimum=0.0001,
        maximum=0.49,
    )
    late: float = attribute(
        "Share of late responses. They are distributed evenly on a logarithmic scale between the median and `latest`.",
        default=0.0,
        quantity="fraction",
        minimum=0,
        maximum=1,
    )
    latest: float = attribute("Longest takeover time of a late response, s.", default=0.0, quantity="time", minimum=0)
    lapse: float = attribute(
        "Probability that there is no response at all.", default=0.0, quantity="fraction", minimum=0, maximum=1
    )
    takeover_time: Number | None = attribute(
        "Fixed time from the request to the driver's first input, s, instead of the distribution.",
        default=None,
        quantity="time",
        minimum=0,
    )
    by_person: Person | None = child("A person responds instead of this model.", default=None)
    person: float = attribute(
        "Share of the variance that is between persons. One person drives a whole run, so this is the correlation "
        "between the run's requests. The default is our own choice.",
        default=0.5,
        quantity="fraction",
        minimum=0,
        maximum=1,
    )
    eyes_on: float = attribute(
        "Median share of the takeover time after which the eyes are on the road. The default is our own choice.",
        default=0.3,
        quantity="fraction",
        minimum=0.01,
        maximum=0.99,
    )
    hands_on: float = attribute(
        "Median share of the time from eyes on the road to the first input after which the hands are on the wheel. "
        "The default is our own choice.",
        default=0.4,
        quantity="fraction",
        minimum=0.01,
        maximum=0.99,
    )
    stage_spread: float = attribute(
        "Standard deviation of the logit of both shares. The default is our own choice.",
        default=0.4,
        minimum=0,
        maximum=5,
    )
    reference_budget: Number | None = attribute(
        "Time budget for which the numbers hold, s; the effect of time_budget counts from it. Without it the budget "
        "makes no difference.",
        default=None,
        quantity="time",
        minimum=0,
    )
    measured_task: Task = attribute("Secondary task of the drivers in the measurements.", default="none")
    task: Task | None = same_as(Driver, "task")
    eyes_closed: bool = same_as(Driver, "eyes_closed")
    traffic_density: Number | None = same_as(Driver, "traffic_density")
    effects: tuple[Effect, ...] = child("Effects, instead of the catalog's.", default=())
    driving: Driving = child("How the driver drives.", default_factory=Driving.model_construct)
