"""Checks that the messages to the driver name each modality and each content once, and `none` alone."""

from __future__ import annotations

from collections.abc import Sequence

from scenario_compiler.diagnostics import Code, Diagnostics, Place
from scenario_compiler.plan.model import Plan
from scenario_compiler.roads import Network
from scenario_compiler.vocabulary.actions import MessageAction
from scenario_compiler.vocabulary.takeover import Message

UNCLEAR_MESSAGE = Code(
    "SC515",
    "unclear-message",
    "A message lists a modality or a content twice, which would be given twice, or `none` beside other modalities, "
    "although `none` means that the driver is not informed. Or it has two texts for one event, of which the second "
    "would never be given, or a text of its own although no channel of it has words.\n\n"
    '    <message modality="none text"/>     "none", or "text"',
)

WORDED = frozenset(("text", "speech"))
"""Modalities that give the words of a message."""


def check_messages(plan: Plan, network: Network, sink: Diagnostics) -> None:
    """Report lists of modalities and contents that contradict or repeat themselves."""
    del network
    actions = [action for _, action in plan.storyboard.actions() if isinstance(action, MessageAction)]
    once = {id(action): action for action in actions}  # an action is listed with each of its actors
    told: tuple[Message | MessageAction, ...] = (*plan.takeover.messages, *once.values())
    for message in told:
        _report(message.modality, message.place_of("modality"), sink)
        if isinstance(message, Message):
            _report(message.content, message.place_of("content"), sink)
            _report_texts(message, sink)


def _report_texts(message: Message, sink: Diagnostics) -> None:
    """Report texts of the author that are never given."""
    for k, say in enumerate(message.says):
        if say.at in {one.at for one in message.says[:k]}:
            sink.add(UNCLEAR_MESSAGE, f"the message has a text for '{say.at}' already", say.place_of("at"))
        elif WORDED.isdisjoint(message.modality):
            given = " ".join(message.modality)
            fault = f"this text is neither displayed nor spoken: the modality is '{given}'"
            sink.add(UNCLEAR_MESSAGE, fault, say.place_of("text"))


def _report(named: Sequence[str], place: Place, sink: Diagnostics) -> None:
    if "none" in named and set(named) != {"none"}:
        sink.add(UNCLEAR_MESSAGE, "'none' stands alone: the driver is informed, or is not", place)
    for one in dict.fromkeys(one for k, one in enumerate(named) if one in named[:k]):
        sink.add(UNCLEAR_MESSAGE, f"'{one}' is named twice", place)
