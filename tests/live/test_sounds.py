"""The recorded sounds: they say today's texts, are what their list says, and a page gets those that it can need."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import get_args

import av
import pytest

from scenario_compiler.live.session import Drive
from scenario_compiler.live.sounds import SOUNDS, files_of, sound_files, sounds_of
from scenario_compiler.live.wording import WORDS
from scenario_compiler.plan.model import Plan
from scenario_compiler.recording.events import EventRow
from scenario_compiler.recording.names import TAKEOVER_STATES
from scenario_compiler.report.wording import OUTCOMES
from scenario_compiler.runtime.messages import TEXTS, Messenger
from scenario_compiler.vocabulary.takeover import Language, Message, Say
from tests.report import made

LISTED = json.loads((SOUNDS / "sounds.json").read_text(encoding="utf-8"))


def plan_of(*messages: Message) -> Plan:
    plan = made.plan()
    return plan.model_copy(update={"takeover": plan.takeover.model_copy(update={"messages": messages})})


def test_every_text_of_every_language_is_recorded_and_nothing_else() -> None:
    spoken = {name.removesuffix(".opus"): one["text"] for name, one in LISTED["files"].items() if one["text"]}
    texts = {f"{language}/{name}": text for language in TEXTS for name, text in TEXTS[language].named.items()}
    assert spoken == texts  # `python tools/make_sounds.py` makes them anew
    there = {path.relative_to(SOUNDS).as_posix() for path in SOUNDS.rglob("*.opus")}
    assert there == set(sound_files())


def test_every_file_is_what_its_list_says() -> None:
    for name, one in LISTED["files"].items():
        content = (SOUNDS / name).read_bytes()
        assert hashlib.sha256(content).hexdigest() == one["sha256"], name
        with av.open(str(SOUNDS / name)) as container:
            stream = container.streams.audio[0]
            assert (stream.codec_context.name, stream.rate, stream.channels) == ("opus", 48_000, 1)
            assert container.duration is not None
            assert container.duration / av.time_base == pytest.approx(one["seconds"], abs=0.05), name
    assert sum((SOUNDS / name).stat().st_size for name in LISTED["files"]) < 1_000_000
    assert "section 2" in LISTED["licence"]


def test_a_page_gets_the_sounds_that_it_can_need() -> None:
    assert sounds_of(plan_of(Message(modality=("text",)))) == []
    assert sounds_of(plan_of(Message(modality=("tone",)))) == ["tones/warning.opus", "tones/request.opus"]
    what = sounds_of(plan_of(Message(modality=("speech",), content=("what",), language="fi")))
    assert what == [f"fi/what_{event}.opus" for event in ("warning", "request", "escalation", "minimum_risk")]
    every = sounds_of(plan_of(Message(modality=("speech",), content=("what", "why", "next"), language="sv")))
    assert sorted(every) == sorted(name for name in sound_files() if name.startswith("sv/"))


def test_standard_texts_are_played_from_files_and_an_authors_own_are_not() -> None:
    own = Say(at="request", text="Hands on the wheel")
    plan = plan_of(Message(modality=("tone", "speech"), content=("what", "why"), language="de", says=(own,)))
    messenger = Messenger(plan)
    list(messenger.heed(EventRow(t=1.0, kind="warning", cause="lane_ends")))
    found = [files_of(one, "warning") for one in messenger.shown]
    assert found == [["tones/warning.opus"], ["de/what_warning.opus", "de/why_lane_ends.opus"]]
    assert all(set(files) <= set(sounds_of(plan)) for files in found)
    list(messenger.heed(EventRow(t=2.0, kind="request", cause="lane_ends")))
    assert [files_of(one, "request") for one in messenger.shown] == [["tones/request.opus"], []]


def test_every_language_has_all_words_of_the_page() -> None:
    assert set(WORDS) == set(get_args(Language))
    for language, words in WORDS.items():
        assert list(words) == list(WORDS["en"]), language
        assert {*TAKEOVER_STATES.values(), *OUTCOMES} <= set(words), language
        assert [text.count("{}") for text in words.values()] == [text.count("{}") for text in WORDS["en"].values()]


def test_a_page_speaks_the_language_of_its_messages(repository: Path) -> None:
    network = made.town(repository)
    assert Drive(plan_of(), network).language == "en"
    assert Drive(plan_of(), network, otherwise="de").language == "de"
    tone, text = Message(modality=("tone",)), Message(language="fi")
    assert Drive(plan_of(tone), network, otherwise="de").language == "de"
    assert Drive(plan_of(tone, text), network, otherwise="de").language == "fi"
