"""Controllers of traffic signals: phases that follow one another, each with the states of its signals."""

from typing import Literal

from scenario_compiler.vocabulary.word import Number, Word, attribute, child


class SignalState(Word):
    """The state of a traffic signal in a phase."""

    word: Literal["signal_state"] = "signal_state"

    signal: str = attribute("Id of the signal in the map.", names="signal")
    state: str = attribute(
        "Its state, by colours (`red`, `red;yellow`, `green`) or lamps from the top (`on;off;off`). Vehicles of "
        "traffic and the automation stop at red, and at yellow where they can."
    )


class SignalPhase(Word):
    """A phase of a controller of traffic signals."""

    word: Literal["phase"] = "phase"

    name: str = attribute("Name of the phase.")
    duration: Number = attribute("How long it lasts, s.", quantity="time", minimum=0)
    state: str = attribute(
        "State of every signal of the map's controller of this name or id, before those that are named one by one.",
        default="",
    )
    states: tuple[SignalState, ...] = child("States of its signals.", default=())


class SignalController(Word):
    """A controller of traffic signals: it goes through its phases from the start on, again and again."""

    word: Literal["signal_controller"] = "signal_controller"

    name: str = attribute("Name of the controller.", defines="signal_controller")
    delay: Number = attribute(
        "How much later than the controller `reference` it begins, s.", default=0.0, quantity="time", minimum=0
    )
    reference: str = attribute(
        "Name of the controller that the delay counts from; the run's start without.",
        default="",
        names="signal_controller",
    )
    phases: tuple[SignalPhase, ...] = child("Its phases, in order.", default=())
