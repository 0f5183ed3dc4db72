"""The engine's log as events: the entity of each, its cause, and the message to the driver."""

from __future__ import annotations

from collections.abc import Iterator

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.events import EVENTS
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.moves.table import ACTIONS, NUMBERS
from scenario_compiler.plan.model import Plan
from scenario_compiler.recording.decimals import to_the_nanosecond
from scenario_compiler.recording.events import EventRow
from scenario_compiler.recording.names import BY_HAND, CAUSES, FAILURES, STANDING_PLACES
from scenario_compiler.vocabulary.actions import MessageAction
from scenario_compiler.vocabulary.word import Word

CAUSED = frozenset({op.EVENT_WARNING, op.EVENT_REQUEST, op.EVENT_ESCALATION, op.EVENT_MINIMUM_RISK})
"""Codes of events that have a cause."""

VALUED = frozenset({op.EVENT_HAZARD_LIGHTS, op.EVENT_EYES_ON, op.EVENT_HANDS_ON})
"""Codes of events that have a value of their own."""

NAMED = frozenset({"storyboard_start", "storyboard_end"})
"""Kinds of log entries about events of the storyboard."""


def named_events(plan: Plan, program: Program) -> dict[int, tuple[str, str]]:
    """Return the name of each event of the storyboard and its only actor (empty if it has several), by its element."""
    elements = (at for at, kind in enumerate(program.element_kind) if kind == op.ELEMENT_EVENT)
    events = (
        (event.name, group.actors[0] if len(group.actors) == 1 else "") for group, event in plan.storyboard.events()
    )
    return dict(zip(elements, events, strict=True))


def actions_of(plan: Plan) -> Iterator[tuple[Word, str]]:
    """Yield each action with the entity that executes it (empty for none), in the order of a program's rows."""
    ego = plan.entities[0].id if plan.entities else ""
    for entity in plan.entities:
        if entity.path is not None:
            yield entity.path, entity.id
    for initial in plan.storyboard.init:
        yield initial.action, initial.entity or _doer(initial.action, ego)
    for group, event in plan.storyboard.events():
        for named in event.actions:
            once = ACTIONS[NUMBERS[named.action.tag()]].of_the_run
            actors = (_doer(named.action, ego),) if once else group.actors
            yield from ((named.action, actor) for actor in actors)


def _doer(word: Word, ego: str) -> str:
    """Return the entity that an action of the run concerns: the ego vehicle, or none."""
    return ego if ACTIONS[NUMBERS[word.tag()]].whose == "ego" else ""


class EventLog:
    """Reads the engine's log while a run goes on."""

    def __init__(self, plan: Plan, program: Program) -> None:
        """Store the meaning of the numbers in the log."""
        self.plan = plan
        self._named = named_events(plan, program)
        self._actions = list(actions_of(plan))
        self._read = 0

    def news(self, state: State) -> Iterator[EventRow]:
        """Yield the events logged since the last call, which was at most a step ago.

        Each channel of a message action is a row of its own.

        Raises:
            RuntimeError: The log has no room for all of them.
        """
        places, news = len(state.log_kind), range(self._read, state.log_count[0])
        if len(news) > places:
            raise RuntimeError(f"a step has logged {len(news)} events, but the log has room for {places}")
        for k in news:
            self._read = k + 1
            at = k % places
            t, code, value = state.log_time[at], state.log_kind[at], state.log_value[at]
            if code == op.EVENT_ACTION:
                yield from self._of_action(t, int(value))
            else:
                yield self._row(t, code, value, CAUSES[state.cause[0]])

    def _of_action(self, t: float, k: int) -> Iterator[EventRow]:
        word, entity = self._actions[k]
        told = ACTIONS[NUMBERS[word.tag()]].told
        if isinstance(word, MessageAction):
            for modality in word.modality:
                if modality == "none":
                    continue
                yield EventRow.model_construct(t=t, kind="message", cause=modality, message=word.text)
        elif told is not None:
            about, what = told.words(word)
            yield EventRow.model_construct(t=t, kind=told.event, entity=entity, cause=about, message=what)

    def _row(self, t: float, code: int, value: float, cause: str) -> EventRow:
        kind = EVENTS[code][0]
        entities = self.plan.entities
        reported = entities[0].id if entities else ""
        if kind in NAMED:
            name, entity = self._named[int(value)]
            return EventRow.model_construct(t=t, kind=kind, entity=entity, message=name)
        if code == op.EVENT_CONTACT:
            one, other = divmod(int(value), len(entities))
            return EventRow.model_construct(t=t, kind=kind, entity=entities[one].id, message=entities[other].id)
        if code == op.EVENT_COLLISION:
            touched = "" if value < 0.0 else entities[int(value)].id
            return EventRow.model_construct(t=t, kind=kind, entity=touched)
        if code == op.EVENT_NO_LANE:
            return EventRow.model_construct(t=t, kind=kind, entity=entities[int(value)].id)
        if code == op.EVENT_STANDSTILL:
            place, by_hand = divmod(int(value), 2)
            cause = BY_HAND if by_hand else ""
            return EventRow.model_construct(
                t=t, kind=kind, entity=reported, cause=cause, message=STANDING_PLACES[place]
            )
        if code in (op.EVENT_FAILURE, op.EVENT_FAILURE_END):
            return EventRow.model_construct(t=t, kind=kind, entity=reported, cause=FAILURES[int(value)])
        if code == op.EVENT_SHORT_START:
            return EventRow.model_construct(t=t, kind=kind, entity=reported, cause=CAUSES[int(value)])
        number = to_the_nanosecond(value) if code in VALUED else None
        return EventRow.model_construct(
            t=t, kind=kind, entity=reported, cause=cause if code in CAUSED else "", value=number
        )
