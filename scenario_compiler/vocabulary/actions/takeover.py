"""Actions on the takeover, as an experimenter's button does: ask, warn, hand back."""

from typing import Literal

from scenario_compiler.vocabulary.takeover import RequestCause
from scenario_compiler.vocabulary.word import Word, attribute


class RequestAction(Word):
    """Ask the driver to take over, at the next control step; without effect unless the automation drives."""

    word: Literal["request"] = "request"

    cause: RequestCause = attribute("The cause that is given.", default="scheduled")


class WarnAction(Word):
    """Warn the driver, at the next control step; without effect unless the automation drives and does not warn yet."""

    word: Literal["warn"] = "warn"


class HandBackAction(Word):
    """Hand back to the automation, at the next control step; without effect unless the driver drives."""

    word: Literal["hand_back"] = "hand_back"
