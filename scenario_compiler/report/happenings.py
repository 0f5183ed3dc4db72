"""Lists the events of a plan, with their times or triggers, in the words of the author's language."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from lxml import etree

from scenario_compiler.document import Origin
from scenario_compiler.expressions import Value
from scenario_compiler.plan.model import Plan
from scenario_compiler.structure.walk import local_name
from scenario_compiler.vocabulary.actions.dynamics import AtRate, OverDistance
from scenario_compiler.vocabulary.conditions import ElementStateCondition, SimulationTimeCondition
from scenario_compiler.vocabulary.grammar import AttributeRule, grammar_of
from scenario_compiler.vocabulary.scenario import parameter_values
from scenario_compiler.vocabulary.storyboard import Event, Trigger, TriggerCondition
from scenario_compiler.vocabulary.word import QUANTITIES, Word, number_value

SIGNS = {
    "lessThan": "<",
    "lessOrEqual": "≤",
    "greaterThan": ">",
    "greaterOrEqual": "≥",
    "equalTo": "=",
    "notEqualTo": "≠",
}
"""ASAM's rules of comparison as signs."""

LEADS = {"entity": "of", "over_time": "over", "duration": "for", "master": "with", "value": "", "variable": ""}
"""Words before the value of an attribute, if they differ from the attribute's name."""

COMPARED = frozenset({"below", "after", "value", "date_time"})
"""Fields of a condition with the value of the comparison, by its rule."""

UNSAID = frozenset({"rule", "coordinates"})
"""Attributes that a sign expresses, or that are not relevant in a picture."""


@dataclass(frozen=True, slots=True)
class Happening:
    """An event of a run, in words.

    Attributes:
        label: What happens, to which entity.
        trigger: What it waits for.
        time: Its time with the parameters' defaults, s; None if it depends on the run.
    """

    label: str
    trigger: str
    time: float | None


def happenings_of(plan: Plan) -> Iterator[Happening]:
    """Yield every event of the storyboard in words, in document order, then the stop trigger if there is one."""
    values = parameter_values(plan.parameters)
    begins: dict[str, float | None] = {}
    for story in plan.storyboard.stories:
        for act in story.acts:
            begin = begins[act.name] = _time_of(act.start, begins, values)
            for group in act.groups:
                for event in (event for maneuver in group.maneuvers for event in maneuver.events):
                    yield _happening(", ".join(group.actors), event, begin, begins, values)
    if plan.storyboard.stop is not None:
        stop = plan.storyboard.stop
        yield Happening("end of the run", _told(stop, values) or "never", _time_of(stop, begins, values))


def last_known_time(plan: Plan) -> float | None:
    """Return the last known time of an event's trigger or of the end of the run, s; None if none is known.

    The time limit of a run that is expected to end by another condition is not used.
    """
    values = parameter_values(plan.parameters)
    stop = plan.storyboard.stop
    end = plan.duration if stop is None else _time_of(stop, {}, values)
    acts = (act.start for story in plan.storyboard.stories for act in story.acts)
    triggers = [*acts, *(event.start for _, event in plan.storyboard.events())]
    conditions = [one for trigger in triggers if trigger for group in trigger.groups for one in group.conditions]
    known = [time for one in conditions if (time := _limit(one, values)) is not None]
    return end if end is not None else max(known, default=None)


def _happening(
    actors: str, event: Event, begin: float | None, begins: Mapping[str, float | None], values: Mapping[str, Value]
) -> Happening:
    done = " and ".join(said(one.action, values) for one in event.actions)
    own = _time_of(event.start, begins, values)
    time = None if own is None or begin is None else max(own, begin)
    trigger = _told(event.start, values) or "its act starts"
    return Happening(f"{actors}: {done}" if actors else done, trigger, time)


def _told(trigger: Trigger | None, values: Mapping[str, Value]) -> str:
    groups = trigger.groups if trigger is not None else ()
    return " or ".join(" and ".join(_condition(one, values) for one in group.conditions) for group in groups)


def _condition(one: TriggerCondition, values: Mapping[str, Value]) -> str:
    several = ("all of " if one.every else "any of ") if len(one.entities) > 1 else ""
    later = number_value(one.delay, values)
    text = said(one.condition, values, who=several + ", ".join(one.entities))
    return f"{text}, {later:g} s later" if later else text


def _time_of(trigger: Trigger | None, begins: Mapping[str, float | None], values: Mapping[str, Value]) -> float | None:
    """Return when a trigger fires that only waits for times, or for acts with a known start time, s."""
    if trigger is None:
        return 0.0
    if len(trigger.groups) != 1:
        return None
    times = [_time_in(one, begins, values) for one in trigger.groups[0].conditions]
    known = [time for time in times if time is not None]
    return max(known) if known and len(known) == len(times) else None


def _time_in(one: TriggerCondition, begins: Mapping[str, float | None], values: Mapping[str, Value]) -> float | None:
    condition = one.condition
    if isinstance(condition, ElementStateCondition):
        if condition.kind != "act" or condition.state not in ("startTransition", "runningState"):
            return None
        begin = begins.get(condition.element.rpartition("::")[2])
        return None if begin is None else begin + number_value(one.delay, values)
    return _limit(one, values)


def _limit(one: TriggerCondition, values: Mapping[str, Value]) -> float | None:
    """Return the time after which a condition is true, s; None if it is not a condition on the time."""
    if not isinstance(one.condition, SimulationTimeCondition) or SIGNS[one.condition.rule] not in (">", "≥", "="):
        return None
    return number_value(one.condition.after, values) + number_value(one.delay, values)


def said(word: Word, values: Mapping[str, Value], *, who: str = "") -> str:
    """Return an action or a condition in words: its name, its entity, and its attributes.

    Args:
        word: The word.
        values: Values of the parameters on which its numbers depend.
        who: The entities of a condition, if the trigger states them and not the condition.
    """
    rules = grammar_of(type(word)).attributes.values()
    parts = [_name(word), f"of {who}" if who else "", *(_attribute(word, rule, values) for rule in rules)]
    parts += [_dynamics(getattr(word, "dynamics", None), values)]
    return " ".join(part for part in parts if part)


def _name(word: Word) -> str:
    """Return the element's name in the author's language; OpenSCENARIO's without the suffix Action or Condition."""
    element = _element_of_openscenario(word)
    if element is None:
        return word.tag().replace("_", " ")
    return local_name(element).removesuffix("Action").removesuffix("Condition")


def _element_of_openscenario(word: Word) -> etree._Element | None:
    """Return the OpenSCENARIO element from which a word was read; None for a word of the conflict language."""
    origin = word.origin
    if isinstance(origin, Origin) and local_name(origin.document.root).lower() == "openscenario":
        return origin.element
    return None


def _dynamics(dynamics: AtRate | OverDistance | None, values: Mapping[str, Value]) -> str:
    if dynamics is None:
        return ""
    size = f"{abs(number_value(dynamics.value, values)):g}"
    return f"over {size} m" if isinstance(dynamics, OverDistance) else f"at a rate of {size}"


def _attribute(word: Word, rule: AttributeRule, values: Mapping[str, Value]) -> str:
    value = getattr(word, rule.field)
    if rule.name in UNSAID or value is None or (value == rule.default and not rule.required):
        return ""
    if rule.kind == "boolean":
        return rule.name.replace("_", " ") if value else ""
    if rule.kind == "choice":
        return str(value)
    if rule.kind in ("number", "fixed_number"):
        quantity = QUANTITIES.get(rule.spelling.quantity, QUANTITIES["number"])
        unit = quantity.unit.replace("2", "²") if quantity.name != "fraction" else ""
        value = f"{number_value(value, values) / quantity.factor:g} {unit}".rstrip()
    elif isinstance(value, tuple):
        value = " ".join(map(str, value))
    elif rule.field == "element":
        return str(value).rpartition("::")[2]
    lead = _comparison(word) if rule.field in COMPARED else ""
    return f"{lead or LEADS.get(rule.field, rule.name.replace('_', ' '))} {value}".lstrip()


def _comparison(word: Word) -> str:
    """Return the sign of a condition's rule, or nothing.

    There is none without a rule, and none for the default rule of the conflict language, whose `below` and `after`
    imply it.
    """
    rule = grammar_of(type(word)).attributes.get("rule")
    unsaid = rule is None or (rule.default == getattr(word, "rule", "") and _element_of_openscenario(word) is None)
    return "" if unsaid else SIGNS[getattr(word, "rule", "")]
