"""Actions on the run as a whole."""

from typing import Literal

from scenario_compiler.vocabulary.takeover import RETIRED_MODALITIES, Modality
from scenario_compiler.vocabulary.word import Word, attribute


class MessageAction(Word):
    """Tell the driver something; it stands in the event log with its time."""

    word: Literal["message"] = "message"

    text: str = attribute("What is said.")
    modality: tuple[Modality, ...] = attribute(
        "By which channels.", default=("text",), separated=True, retired=RETIRED_MODALITIES
    )


class StopAction(Word):
    """End the run."""

    word: Literal["stop"] = "stop"
