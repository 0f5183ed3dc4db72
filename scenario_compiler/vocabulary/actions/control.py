"""Actions on who drives an entity, and on its lights and looks."""

from typing import Literal

from scenario_compiler.vocabulary.word import Number, Word, attribute, child


class ActivateControllerAction(Word):
    """Switch an entity's controller on or off for the motion along the road, across it, the lights, the animation."""

    word: Literal["activate_controller"] = "activate_controller"

    controller: str = attribute("Name of the controller; the assigned one when left out.", default="")
    longitudinal: bool | None = attribute("Speed; as it is when left out.", default=None)
    lateral: bool | None = attribute("Steering; as it is when left out.", default=None)
    lighting: bool | None = attribute("Lights; as they are when left out.", default=None)
    animation: bool | None = attribute("Animation; as it is when left out.", default=None)


class ControllerProperty(Word):
    """A parameter of an assigned controller."""

    word: Literal["property"] = "property"

    name: str = attribute("Its name.")
    value: str = attribute("Its value.", default="")


class AssignControllerAction(Word):
    """Give an entity a controller, and switch it on where that is said."""

    word: Literal["assign_controller"] = "assign_controller"

    name: str = attribute("Name of the controller.")
    model: str = attribute("What it is: default, external, acc, follow_route, ...", default="default")
    longitudinal: bool | None = attribute("Speed; as it is when left out.", default=None)
    lateral: bool | None = attribute("Steering; as it is when left out.", default=None)
    properties: tuple[ControllerProperty, ...] = child("Its parameters.", default=())


class OverrideControllerAction(Word):
    """Hold a pedal, the steering wheel or the gear in place of the controller, or let go of it."""

    word: Literal["override_controller"] = "override_controller"

    input: Literal["throttle", "brake", "clutch", "parking_brake", "steering_wheel", "gear"] = attribute("Which one.")
    active: bool = attribute("Whether it is held from now on.")
    value: Number = attribute("Its value: 0 to 1, the angle in radians, or the gear.", default=0.0)


class LightAction(Word):
    """Switch a light of the entity."""

    word: Literal["light"] = "light"

    type: str = attribute("Which light: a vehicle light of ASAM OpenSCENARIO, or a name of one's own.")
    mode: Literal["off", "on", "flashing"] = attribute("What it does.")


class AnimationAction(Word):
    """Start a movement of the entity's parts: doors, gestures."""

    word: Literal["animation"] = "animation"

    type: str = attribute("What moves.")
    state: Number = attribute("State to reach, 0 to 1.", default=1.0)
    duration: Number | None = attribute("How long it takes, s.", default=None, quantity="time")
