"""Actions on the world: adding and removing entities, variables, traffic signals, other programs."""

from typing import Literal

from scenario_compiler.vocabulary.positions import Position
from scenario_compiler.vocabulary.word import Number, Word, attribute, child


class AddEntityAction(Word):
    """Add an entity to the road."""

    word: Literal["add_entity"] = "add_entity"

    entity: str = attribute("Id of the entity.", names="entity")
    position: Position = child("Position.")


class DeleteEntityAction(Word):
    """Remove an entity."""

    word: Literal["delete_entity"] = "delete_entity"

    entity: str = attribute("Id of the entity.", names="entity")


class SetVariableAction(Word):
    """Set a variable."""

    word: Literal["set_variable"] = "set_variable"

    variable: str = attribute("Name of the variable.", names="variable")
    value: str = attribute("Its new value.")


class ModifyVariableAction(Word):
    """Add to a variable, or multiply it."""

    word: Literal["modify_variable"] = "modify_variable"

    variable: str = attribute("Name of the variable.", names="variable")
    by: Literal["add", "multiply"] = attribute("Operation.")
    value: Number = attribute("Number to add, or factor.")


class TrafficSignalStateAction(Word):
    """Set the state of a traffic signal."""

    word: Literal["traffic_signal_state"] = "traffic_signal_state"

    signal: str = attribute("Id of the signal in the map.", names="signal")
    state: str = attribute("Its state.")


class TrafficSignalControllerAction(Word):
    """Set a controller of traffic signals to one of its phases."""

    word: Literal["traffic_signal_phase"] = "traffic_signal_phase"

    controller: str = attribute("Name of the controller.", names="signal_controller")
    phase: str = attribute("Name of the phase.")


class CommandAction(Word):
    """Send a command to another program. The event log contains it with its time."""

    word: Literal["command"] = "command"

    type: str = attribute("Type of the command.")
    content: str = attribute("Its content.", default="")


class EnvironmentAction(Word):
    """Set the time of day and the road's friction."""

    word: Literal["environment"] = "environment"

    date_time: str = attribute("Date and time, ISO 8601.", default="")
    animated: bool = attribute("Whether the time of day advances from there.", default=True)
    friction: Number | None = attribute(
        "Factor by which the road's friction is multiplied; 1 is dry. The weather does not change it.",
        default=None,
        minimum=0,
    )
