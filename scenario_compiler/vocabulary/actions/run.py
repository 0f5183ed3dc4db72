"""Actions on the run as a whole."""

from typing import Literal

from scenario_compiler.vocabulary.takeover import RETIRED_MODALITIES, Modality
from scenario_compiler.vocabulary.word import Word, attribute


class MessageAction(Word):
    """Show a message to the driver. The event log contains it with its time."""

    word: Literal["message"] = "message"

    text: str = attribute("Text of the message.")
    modality: tuple[Modality, ...] = attribute(
        "Channels of the message.", default=("text",), separated=True, retired=RETIRED_MODALITIES
    )


class StopAction(Word):
    """End the run."""

    word: Literal["stop"] = "stop"
