"""Messages to the driver: by policy, at their time, in each language, and no longer than their reason lasts."""

from __future__ import annotations

from itertools import chain
from typing import get_args

import pytest

from scenario_compiler.recording.events import EventRow
from scenario_compiler.runtime.messages import TEXTS, Messenger
from scenario_compiler.vocabulary.takeover import CauseKind, Language, Message, Say, Told
from tests.report import made


def messenger(*given: Message) -> Messenger:
    plan = made.plan()
    return Messenger(plan.model_copy(update={"takeover": plan.takeover.model_copy(update={"messages": given})}))


def row(t: float, kind: str, cause: str = "path_blocked") -> EventRow:
    return EventRow(t=t, kind=kind, cause=cause)


def told(rows: list[EventRow]) -> list[tuple[float, str, str, str]]:
    return [(one.t, one.kind, one.cause, one.message) for one in rows]


def test_a_message_ends_when_its_reason_ends() -> None:
    one = messenger(Message(modality=("text", "tone"), content=("what",)))
    rows = list(chain.from_iterable(one.heed(row(t, kind)) for t, kind in ((3.0, "warning"), (4.0, "request"))))
    rows += one.heed(row(6.0, "response"))
    assert told(rows) == [
        (3.0, "message", "text", "Be ready to take over"),
        (3.0, "message", "tone", "Be ready to take over"),
        (4.0, "message_over", "text", "Be ready to take over"),
        (4.0, "message_over", "tone", "Be ready to take over"),
        (4.0, "message", "text", "Take over now"),
        (4.0, "message", "tone", "Take over now"),
        (6.0, "message_over", "text", "Take over now"),
        (6.0, "message_over", "tone", "Take over now"),
    ]
    assert one.shown == ()


@pytest.mark.parametrize("end", ["warning_over", "response", "override", "standstill"])
def test_every_end_of_a_reason_ends_the_message(end: str) -> None:
    one = messenger(Message())
    assert [found.kind for found in one.heed(row(1.0, "warning"))] == ["message"]
    assert [found.kind for found in one.heed(row(2.0, end))] == ["message_over"]


def test_other_events_change_nothing() -> None:
    one = messenger(Message())
    list(one.heed(row(1.0, "request")))
    assert list(one.heed(row(1.5, "hazard_lights"))) == []
    assert len(one.shown) == 1


def test_a_message_comes_after_its_time_if_its_reason_still_holds() -> None:
    one = messenger(Message(modality=("text",)), Message(modality=("speech",), after=1.5))
    assert [found.cause for found in one.heed(row(4.0, "request"))] == ["text"]
    assert list(one.come(5.4)) == []
    assert told(list(one.come(5.5))) == [(5.5, "message", "speech", "Take over now")]
    assert list(one.come(5.6)) == []
    list(one.heed(row(8.0, "escalation")))
    list(one.heed(row(8.5, "response")))
    assert list(one.come(10.0)) == []


def test_an_authors_own_texts_are_shown_at_their_event() -> None:
    one = messenger(Message(content=("what", "why"), says=(Say(at="request", text="Hands on the wheel"),)))
    assert [found.message for found in one.heed(row(1.0, "request"))] == ["Hands on the wheel"]
    list(one.heed(row(2.0, "escalation")))
    assert one.shown[0].text == "Take over immediately: the path ahead is blocked"


def test_the_modality_none_shows_nothing() -> None:
    assert list(messenger(Message(modality=("none",))).heed(row(1.0, "request"))) == []


@pytest.mark.parametrize("language", get_args(Language))
def test_every_language_has_every_text(language: Language) -> None:
    texts = TEXTS[language]
    assert set(texts.what) == set(get_args(Told))
    assert set(texts.why) == set(texts.next) == {*get_args(CauseKind), "scheduled"}
    assert all(text.strip() for group in (texts.what, texts.why, texts.next) for text in group.values())
