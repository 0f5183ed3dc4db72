"""Controllers of traffic signals: phases in sequence, each with the states of its signals."""

from typing import Literal

from scenario_compiler.vocabulary.word import Number, Word, attribute, child


class SignalState(Word):
    """The state of a traffic signal in a phase."""

    word: Literal["signal_state"] = "signal_state"

    signal: str = attribute("Id of the signal in the map.", names="signal")
    state: str = attribute(
        "State as colours (`red`, `red;yellow`, `green`) or as lamps from the top (`on;off;off`). Background traffic "
        "and the automation stop at red, and at yellow if they can."
    )


class SignalPhase(Word):
    """A phase of a controller of traffic signals."""

    word: Literal["phase"] = "phase"

    name: str = attribute("Name of the phase.")
    duration: Number = attribute("Duration, s.", quantity="time", minimum=0)
    state: str = attribute(
        "State of every signal of the map's controller with this name or id. States of individually named signals "
        "take precedence.",
        default="",
    )
    states: tuple[SignalState, ...] = child("States of its signals.", default=())


class SignalController(Word):
    """A controller of traffic signals: repeats its phases in order from the start of the run."""

    word: Literal["signal_controller"] = "signal_controller"

    name: str = attribute("Name of the controller.", defines="signal_controller")
    delay: Number = attribute(
        "Delay of its start relative to the controller `reference`, s.", default=0.0, quantity="time", minimum=0
    )
    reference: str = attribute(
        "Name of the controller to which the delay refers; the start of the run if left out.",
        default="",
        names="signal_controller",
    )
    phases: tuple[SignalPhase, ...] = child("Its phases, in order.", default=())
