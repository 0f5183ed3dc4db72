"""What an action becomes: `ACTIONS`, by the type of its word. One module a family of the standard."""

from __future__ import annotations

from scenario_compiler.engine.program.actions import (
    control,
    lateral,
    longitudinal,
    path,
    place,
    routing,
    run,
    traffic,
    trajectories,
    world,
)
from scenario_compiler.engine.program.actions.family import Family
from scenario_compiler.engine.program.draft import Draft
from scenario_compiler.vocabulary.word import Word

ACTIONS: Family = {
    **longitudinal.ACTIONS,
    **lateral.ACTIONS,
    **path.ACTIONS,
    **place.ACTIONS,
    **routing.ACTIONS,
    **trajectories.ACTIONS,
    **run.ACTIONS,
    **world.ACTIONS,
    **traffic.ACTIONS,
    **control.ACTIONS,
}
"""By the type of an action, its row; the last argument is the number of the entity that does it, or NONE."""


def add_action(draft: Draft, word: Word, actor: int) -> int:
    """Append an action of an entity, or of none (NONE); return its row.

    Raises:
        ValueError: ACTIONS has no entry for the word.
    """
    if type(word) not in ACTIONS:
        raise ValueError(f"a program has no row for the action <{word.tag()}>")
    return draft.action(ACTIONS[type(word)](draft, word, actor), actor)
