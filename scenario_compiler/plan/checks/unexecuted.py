"""No word of the plan is one that the engine has no row for."""

from __future__ import annotations

from scenario_compiler.diagnostics import Code, Diagnostics
from scenario_compiler.plan.model import Plan
from scenario_compiler.roads import Network
from scenario_compiler.vocabulary.positions import TrajectoryPosition
from scenario_compiler.vocabulary.traversal import walk
from scenario_compiler.vocabulary.word import Word

UNEXECUTED_WORD = Code(
    "SC253",
    "unexecuted-word",
    "The word is read, and written to files of OpenSCENARIO, but nothing executes it yet: the scenario cannot run. "
    "`scenario-compiler coverage` lists what executes each word. Say the same in other words."
    '\n\n    <on_trajectory s="5">...</on_trajectory>     write the place itself: <lane road="1" lane="-1" s="95"/>',
)

UNEXECUTED: tuple[type[Word], ...] = (TrajectoryPosition,)
"""Words that are read and not executed."""


def check_unexecuted(plan: Plan, network: Network, sink: Diagnostics) -> None:
    """Report words that nothing executes."""
    del network
    roots = [plan.storyboard, *(word for one in plan.entities for word in (one.start, one.path) if word is not None)]
    for word in (word for root in roots for word in walk(root)):
        if isinstance(word, UNEXECUTED):
            sink.add(UNEXECUTED_WORD, f"<{word.tag()}> is not executed yet", word.origin)
