"""Actions that control an entity's driver, lights and animations."""

from typing import Literal

from scenario_compiler.vocabulary.word import Number, Word, attribute, child


class ActivateControllerAction(Word):
    """Switch an entity's controller on or off, separately for speed, steering, lights and animation."""

    word: Literal["activate_controller"] = "activate_controller"

    controller: str = attribute("Name of the controller; the assigned one if left out.", default="")
    longitudinal: bool | None = attribute("Speed; unchanged if left out.", default=None)
    lateral: bool | None = attribute("Steering; unchanged if left out.", default=None)
    lighting: bool | None = attribute("Lights; unchanged if left out.", default=None)
    animation: bool | None = attribute("Animation; unchanged if left out.", default=None)


class ControllerProperty(Word):
    """A parameter of an assigned controller."""

    word: Literal["property"] = "property"

    name: str = attribute("Its name.")
    value: str = attribute("Its value.", default="")


class AssignControllerAction(Word):
    """Assign a controller to an entity, and optionally switch it on."""

    word: Literal["assign_controller"] = "assign_controller"

    name: str = attribute("Name of the controller.")
    model: str = attribute("Kind of controller: default, external, acc, follow_route, ...", default="default")
    longitudinal: bool | None = attribute("Speed; unchanged if left out.", default=None)
    lateral: bool | None = attribute("Steering; unchanged if left out.", default=None)
    properties: tuple[ControllerProperty, ...] = child("Its parameters.", default=())


class OverrideControllerAction(Word):
    """Hold a pedal, the steering wheel or the gear instead of the controller, or release it."""

    word: Literal["override_controller"] = "override_controller"

    input: Literal["throttle", "brake", "clutch", "parking_brake", "steering_wheel", "gear"] = attribute(
        "Input to hold."
    )
    active: bool = attribute("true: it is held from now on; false: it is released.")
    value: Number = attribute("Value: 0 to 1, the angle in radians, or the gear.", default=0.0)


class LightAction(Word):
    """Switch a light of the entity."""

    word: Literal["light"] = "light"

    type: str = attribute("Light: a vehicle light of ASAM OpenSCENARIO, or a name of your own.")
    mode: Literal["off", "on", "flashing"] = attribute("State of the light.")


class AnimationAction(Word):
    """Start an animation of the entity: doors, gestures."""

    word: Literal["animation"] = "animation"

    type: str = attribute("Part that moves, or gesture.")
    state: Number = attribute("Final state, 0 to 1.", default=1.0, minimum=0, maximum=1)
    duration: Number | None = attribute("Duration, s.", default=None, quantity="time", minimum=0)
    continuous: bool = attribute("Whether it is repeated, so that it never ends by itself.", default=False)
