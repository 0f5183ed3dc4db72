"""Checks that variables, traffic signals, storyboard elements, dates and controllers exist and fit."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

from scenario_compiler.diagnostics import Code, Diagnostics, Severity, did_you_mean
from scenario_compiler.plan.checks.moves import TO_ITSELF
from scenario_compiler.plan.model import Plan
from scenario_compiler.roads import Network
from scenario_compiler.vocabulary.actions import (
    EnvironmentAction,
    ModifyVariableAction,
    SetVariableAction,
    TrafficSignalControllerAction,
    TrafficSignalStateAction,
)
from scenario_compiler.vocabulary.conditions import (
    CollisionCondition,
    DistanceCondition,
    ElementStateCondition,
    PositionDistanceCondition,
    RelativeAngleCondition,
    RelativeSpeedCondition,
    TimeHeadwayCondition,
    TimeOfDayCondition,
    TimeToCollisionCondition,
    TrafficSignalCondition,
    TrafficSignalControllerCondition,
    UserDefinedValueCondition,
    VariableCondition,
)
from scenario_compiler.vocabulary.conditions.by_value import ELEMENT_KINDS
from scenario_compiler.vocabulary.conditions.measuring import ORDERS
from scenario_compiler.vocabulary.signals import SignalState
from scenario_compiler.vocabulary.storyboard import TriggerCondition
from scenario_compiler.vocabulary.traversal import walk
from scenario_compiler.vocabulary.variables import (
    NUMBERS,
    Variable,
    VariableType,
    is_value,
    number_in,
    number_of,
    seconds_of,
)
from scenario_compiler.vocabulary.word import Word

UNKNOWN_VARIABLE = Code(
    "SC275",
    "unknown-variable",
    "An action or condition names a variable that the scenario does not declare."
    '\n\n    <variable name="phase" type="integer" value="1"/>'
    '\n    <when><variable variable="phaze" value="2"/> <do>...</do></when>     the declared one is phase',
)
WRONG_VALUE = Code(
    "SC276",
    "variable-value",
    "A value does not have the variable's type: a text instead of a number, a fraction instead of an integer, or the "
    "sum of a number and a text.\n\n"
    '    <variable name="open" type="boolean" value="false"/>\n'
    '    <do><set_variable variable="open" value="yes"/></do>     booleans are true or false',
)
UNORDERED = Code(
    "SC299",
    "unordered-texts",
    "A condition asks whether a text is less or greater than another one, and one of them is not a number, so it is "
    "never true. Texts have no order; only those that are numbers are compared, as numbers.\n\n"
    '    <variable name="weather" type="string" value="rain"/>\n'
    '    <when><variable variable="weather" rule="lessThan" value="snow"/> <do>...</do></when>\n\n'
    "Compare texts with equalTo or notEqualTo, or give the variable the type of its values.",
    Severity.WARNING,
)
UNKNOWN_PHASE = Code(
    "SC277",
    "unknown-signal-phase",
    "An action or condition names a controller of traffic signals, or one of its phases, that the scenario does not "
    "declare; the delay of a controller refers to a missing controller or to itself; or a phase gives a state to the "
    "signals of a controller that the map does not have.\n\n"
    '    <signal_controller name="crossing"><phase name="go" duration="20"/></signal_controller>\n'
    '    <do><traffic_signal_phase controller="crossing" phase="stop"/></do>     its only phase is go',
)
BAD_DATE = Code(
    "SC278",
    "bad-date",
    "A date and time is not in the format of ISO 8601: the date, a T, the time of day, and optionally a time "
    "zone.\n\n"
    '    <environment date_time="2026-06-21T18:30:00"/>     the date, a T, the time; a zone may follow',
)
UNKNOWN_ELEMENT = Code(
    "SC279",
    "unknown-element",
    "A condition waits for an element that the storyboard does not have. The element's name must be preceded by the "
    "names of the elements that contain it.\n\n"
    '    <element_state kind="act" element="story::act" state="completeState"/>',
)
NEVER_GIVEN = Code(
    "SC280",
    "never-given",
    "A condition waits for a value from another program. No world supplies such values, so it is never true.\n\n"
    '    <user_defined_value name="weather_station" value="rain"/>',
    Severity.WARNING,
)
NO_TARGET = Code(
    "SC281",
    "no-target",
    "A time to collision must refer either to another entity or to a position; here it names neither or both.\n\n"
    '    <time_to_collision to="ego" below="3"/>',
)

ALONG_ROAD = Code(
    "SC286",
    "measured-along-road",
    "A distance is to be measured along a trajectory. It is measured along the road instead: ahead along its "
    "reference line, across from one t to the other. The same applies to distances in a lane's coordinate system, "
    "which differ only in bends.\n\n"
    '    <distance to="lead" below="20" coordinates="trajectory" distance="longitudinal"/>',
    Severity.WARNING,
)

UNKNOWN_SIGNAL = Code(
    "SC292",
    "unknown-signal",
    "An action, a condition or a phase names a traffic signal that the map does not have. It has a state, which "
    "conditions can refer to, but no vehicle stops at it and no picture shows it.\n\n"
    '    <phase name="stop" duration="20"><signal_state signal="17" state="red"/></phase>     its id in the map is 71',
    Severity.WARNING,
)

NEVER_SHOWN = Code(
    "SC297",
    "never-shown",
    "A condition waits for a state of a traffic signal that no phase and no action gives to it, so it is never true. "
    "States are texts of the scenario, compared letter by letter; a signal has none until it is given one.\n\n"
    '    <phase name="stop" duration="20"><signal_state signal="11" state="red"/></phase>\n'
    '    <when><traffic_signal signal="11" state="Red"/> <do>...</do></when>     the phase gives red',
    Severity.WARNING,
)

Compared = DistanceCondition | RelativeSpeedCondition | RelativeAngleCondition | CollisionCondition
"""Conditions that compare an entity with another one, but may be true of an entity and itself."""

Paths = dict[str, set[str]]


def check_world(plan: Plan, network: Network, sink: Diagnostics) -> None:
    """Report references of the storyboard to what does not exist, and values that do not fit."""
    _check_controllers(plan, network, sink)
    _check_signals(plan, network, sink)
    paths = _paths(plan)
    for word in walk(plan.storyboard):
        check = CHECKS_OF.get(type(word))
        if check is not None:
            check(plan, word, sink)
        if isinstance(word, TriggerCondition) and isinstance(word.condition, Compared):
            _check_other(word, word.condition, sink)
        if isinstance(word, ElementStateCondition) and word.element not in paths[word.kind]:
            message = f"there is no {word.kind} '{word.element}'"
            hint = _meant_element(word.element, paths[word.kind])
            sink.add(UNKNOWN_ELEMENT, message, word.place_of("element"), hint=hint)
    for variable in plan.variables:
        if variable.value and not is_value(variable.type, variable.value):
            message = f"'{variable.value}' is not a value of the type {variable.type}"
            sink.add(WRONG_VALUE, message, variable.place_of("value"))


def _meant_element(written: str, known: set[str]) -> str:
    """Return a hint with the only element of the same last name, or else with a similar one."""
    last = written.rpartition("::")[2]
    namesakes = [path for path in known if path.rpartition("::")[2] == last]
    return did_you_mean(namesakes[0] if len(namesakes) == 1 else written, known)


def _check_variable(plan: Plan, word: Any, sink: Diagnostics) -> None:
    variable = next((one for one in plan.variables if one.name == word.variable), None)
    if variable is None:
        known = [one.name for one in plan.variables]
        message = f"there is no variable '{word.variable}'"
        hint = did_you_mean(word.variable, known) or f'declare it: <variable name="{word.variable}" value="0"/>'
        sink.add(UNKNOWN_VARIABLE, message, word.place_of("variable"), hint=hint)
    elif isinstance(word, ModifyVariableAction):
        if variable.type not in NUMBERS:
            message = f"'{variable.name}' is not a number: its type is {variable.type}"
            sink.add(WRONG_VALUE, message, word.place_of("variable"))
    elif not _fits(variable.type, word):
        message = f"'{word.value}' is not a value of '{variable.name}', which is of the type {variable.type}"
        sink.add(WRONG_VALUE, message, word.place_of("value"))
    elif isinstance(word, VariableCondition) and variable.type == "string" and word.rule in ORDERS:
        _check_order(plan, word, variable, sink)


def _check_order(plan: Plan, word: VariableCondition, variable: Variable, sink: Diagnostics) -> None:
    """Report a condition that asks for the order of texts if they are never both numbers."""
    actions = (one for one in walk(plan.storyboard) if isinstance(one, SetVariableAction))
    values = [variable.value, *(one.value for one in actions if one.variable == variable.name)]
    if number_in(word.value) is None:
        message = f"'{word.value}' is not a number, and texts have no order, so this is never true"
        sink.add(UNORDERED, message, word.place_of("value"))
    elif all(number_in(one) is None for one in values):
        message = f"no value of '{variable.name}' is a number, and texts have no order, so this is never true"
        sink.add(UNORDERED, message, word.place_of("variable"))


def _fits(kind: VariableType, word: SetVariableAction | VariableCondition) -> bool:
    """Return whether a word's value is one of a type; an integer may be compared with any number."""
    if isinstance(word, VariableCondition) and kind != "string":
        return number_of(kind, word.value) is not None
    return is_value(kind, word.value)


def _check_phase(plan: Plan, word: Any, sink: Diagnostics) -> None:
    controller = next((one for one in plan.signal_controllers if one.name == word.controller), None)
    if controller is None:
        known = [one.name for one in plan.signal_controllers]
        message = f"there is no controller of traffic signals '{word.controller}'"
        hint = did_you_mean(word.controller, known) or "declare it with <signal_controller>"
        sink.add(UNKNOWN_PHASE, message, word.place_of("controller"), hint=hint)
    elif word.phase not in {one.name for one in controller.phases}:
        message = f"'{controller.name}' has no phase '{word.phase}'"
        known = [one.name for one in controller.phases]
        sink.add(UNKNOWN_PHASE, message, word.place_of("phase"), hint=did_you_mean(word.phase, known))


def _check_controllers(plan: Plan, network: Network, sink: Diagnostics) -> None:
    """Report delays of signal controllers that refer to a missing one or to themselves, and missing signals."""
    references = {one.name: one.reference for one in plan.signal_controllers}
    for one in plan.signal_controllers:
        at, seen = one.reference, {one.name}
        while at in references and at not in seen:
            seen.add(at)
            at = references[at]
        groups = network.model().controllers if any(phase.state for phase in one.phases) else ()
        known = [name for group in groups for name in (group.name, group.id)]
        for phase in one.phases:
            if phase.state and one.name not in known:
                message = f"the map has no controller of signals '{one.name}', to which this state applies"
                sink.add(UNKNOWN_PHASE, message, phase.place_of("state"), hint=did_you_mean(one.name, known))
        if at:
            reason = "counts from itself" if at in seen else f"counts from '{at}', which does not exist"
            sink.add(UNKNOWN_PHASE, f"the delay of '{one.name}' {reason}", one.place_of("reference"))


def _check_signals(plan: Plan, network: Network, sink: Diagnostics) -> None:
    """Report signals that the map does not have; the map's signals are read only if the plan names one."""
    phases = [phase for one in plan.signal_controllers for phase in one.phases]
    naming = [
        *(one for one in walk(plan.storyboard) if isinstance(one, TrafficSignalStateAction | TrafficSignalCondition)),
        *(state for phase in phases for state in phase.states),
    ]
    known = {one.id for one in network.model().signals} if naming else set()
    for one in naming:
        if one.signal not in known:
            message = f"the map has no traffic signal '{one.signal}'"
            hint = did_you_mean(one.signal, known) if known else "it has no traffic signals"
            sink.add(UNKNOWN_SIGNAL, message, one.place_of("signal"), hint=hint)
    if any(isinstance(one, TrafficSignalCondition) for one in naming):
        _check_shown(plan, network, naming, known, sink)


def _check_shown(plan: Plan, network: Network, naming: Sequence[Word], on_map: set[str], sink: Diagnostics) -> None:
    """Report conditions on states that no phase and no action gives to their signals.

    Args:
        plan: The plan.
        network: Its map.
        naming: All words of the plan that name a signal.
        on_map: The map's signals; one that is neither there nor given any state is reported as unknown only.
        sink: Receives the findings.
    """
    shown: dict[str, set[str]] = {signal: set() for signal in on_map}
    for one in naming:
        if isinstance(one, TrafficSignalStateAction | SignalState):
            shown.setdefault(one.signal, set()).add(one.state)
    for controller in plan.signal_controllers:
        for state in {phase.state for phase in controller.phases} - {""}:
            for signal in network.model().signals_of(controller.name):
                shown.setdefault(signal, set()).add(state)
    for one in naming:
        if isinstance(one, TrafficSignalCondition) and one.state not in shown.get(one.signal, {one.state}):
            message = (
                f"nothing gives the state '{one.state}' to the traffic signal '{one.signal}', so this is never true"
            )
            known = sorted(shown[one.signal])
            hint = did_you_mean(one.state, known) or ("its states are " + ", ".join(known) if known else "")
            sink.add(NEVER_SHOWN, message, one.place_of("state"), hint=hint)


def _check_date(plan: Plan, word: Any, sink: Diagnostics) -> None:
    del plan
    if isinstance(word, EnvironmentAction) and not word.date_time:
        return
    try:
        seconds_of(word.date_time)
    except (ValueError, OverflowError):
        hint = "write it as 2026-06-21T18:30:00"
        sink.add(BAD_DATE, f"'{word.date_time}' is not a date and time", word.place_of("date_time"), hint=hint)


def _check_given(plan: Plan, word: Any, sink: Diagnostics) -> None:
    del plan
    sink.add(NEVER_GIVEN, f"no world supplies the value '{word.name}', so this is never true", word.origin)


def _check_frame(plan: Plan, word: Any, sink: Diagnostics) -> None:
    del plan
    if word.distance != "euclidianDistance" and word.coordinates == "trajectory":
        message = "a distance along a trajectory is measured along the road"
        sink.add(ALONG_ROAD, message, word.place_of("coordinates"))


def _check_other(word: TriggerCondition, condition: Compared, sink: Diagnostics) -> None:
    if isinstance(condition, CollisionCondition):
        named, attribute = condition.with_entities[0] if len(condition.with_entities) == 1 else "", "with"
    else:
        named, attribute = condition.to, "to"
    if named and named in (word.entities or (condition.entity,)):
        message = f"<{condition.tag()}> compares '{named}' with itself"
        sink.add(TO_ITSELF, message, condition.place_of(attribute), severity=Severity.WARNING)


def _check_target(plan: Plan, word: Any, sink: Diagnostics) -> None:
    _check_frame(plan, word, sink)
    if bool(word.to) == (word.position is not None):
        found = "both an entity and a position" if word.to else "neither an entity nor a position"
        sink.add(NO_TARGET, f"the time to collision names {found}", word.origin)


CHECKS_OF: dict[type[Word], Callable[[Plan, Any, Diagnostics], None]] = {
    SetVariableAction: _check_variable,
    ModifyVariableAction: _check_variable,
    VariableCondition: _check_variable,
    TrafficSignalControllerAction: _check_phase,
    TrafficSignalControllerCondition: _check_phase,
    EnvironmentAction: _check_date,
    TimeOfDayCondition: _check_date,
    UserDefinedValueCondition: _check_given,
    TimeToCollisionCondition: _check_target,
    TimeHeadwayCondition: _check_frame,
    DistanceCondition: _check_frame,
    PositionDistanceCondition: _check_frame,
}


def _paths(plan: Plan) -> Paths:
    """Return the full names of the storyboard's elements by kind."""
    found: Paths = {kind: set() for kind in ELEMENT_KINDS}
    for kind, path in _elements(plan):
        found[kind].add(path)
    return found


def _elements(plan: Plan) -> Iterator[tuple[str, str]]:
    for story in plan.storyboard.stories:
        yield "story", story.name
        for act in story.acts:
            yield "act", f"{story.name}::{act.name}"
            for group in act.groups:
                path = f"{story.name}::{act.name}::{group.name}"
                yield "maneuverGroup", path
                for maneuver in group.maneuvers:
                    yield "maneuver", f"{path}::{maneuver.name}"
                    for event in maneuver.events:
                        at = f"{path}::{maneuver.name}::{event.name}"
                        yield "event", at
                        yield from (("action", f"{at}::{action.name}") for action in event.actions)
