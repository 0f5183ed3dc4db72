"""The sounds of messages: the recorded files, and those of them that a run can need.

`tools/make_sounds.py` makes them; `pages/sounds/sounds.json` lists their contents and licences.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import get_args

from scenario_compiler.plan.model import Plan
from scenario_compiler.recording.names import StateName
from scenario_compiler.runtime.messages import Shown, message_parts
from scenario_compiler.vocabulary.takeover import RequestCause, Told

SOUNDS = Path(__file__).parent / "pages" / "sounds"

TONES = ("tones/warning.opus", "tones/request.opus")
"""The tone of a warning, and the tone of everything after it."""


def files_of(message: Shown, state: StateName) -> list[str]:
    """Return the names of the files for a message, in the order in which they are played.

    There are none for an author's own words, nor for silent messages. The tone depends on the state.
    """
    if message.modality == "tone":
        return [TONES[state != "warning"]]
    return [f"{message.language}/{part}.opus" for part in message.parts] if message.modality == "speech" else []


def sound_files() -> tuple[str, ...]:
    """Return the names of all files, relative to `SOUNDS`."""
    return tuple(json.loads((SOUNDS / "sounds.json").read_text(encoding="utf-8"))["files"])


def sounds_of(plan: Plan) -> list[str]:
    """Return the names of the files that a run of a plan can need, so that a page can load them early."""
    return [name for name in sound_files() if name in set(_needed(plan))]


def _needed(plan: Plan) -> Iterator[str]:
    for message in plan.takeover.messages:
        if "tone" in message.modality:
            yield from TONES
        if "speech" in message.modality:
            for event in get_args(Told):
                for cause in get_args(RequestCause):
                    for part in message_parts(event, cause, message.content):
                        yield f"{message.language}/{part}.opus"
