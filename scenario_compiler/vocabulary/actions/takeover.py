"""Actions on the takeover, as with an experimenter's button: request, warn, hand back."""

from typing import Literal

from scenario_compiler.vocabulary.takeover import RequestCause
from scenario_compiler.vocabulary.word import Word, attribute


class RequestAction(Word):
    """Request a takeover at the next control step. No effect unless the automation drives."""

    word: Literal["request"] = "request"

    cause: RequestCause = attribute("Cause given to the driver.", default="scheduled")


class WarnAction(Word):
    """Warn the driver at the next control step. No effect unless the automation drives and no warning is active."""

    word: Literal["warn"] = "warn"


class HandBackAction(Word):
    """Hand back to the automation at the next control step. No effect unless the driver drives."""

    word: Literal["hand_back"] = "hand_back"
