"""The functions of the engine that are called from outside; each is a symbol of the library."""

from __future__ import annotations

from scenario_compiler.engine.ego.outlook import look_out
from scenario_compiler.engine.ego.view import look_at_view
from scenario_compiler.engine.motion.appearing import delete_entity, spawn_entity
from scenario_compiler.engine.motion.collision import find_contacts, find_touched, note_world_collision
from scenario_compiler.engine.story.step import begin_step, end_step, move_step, reset, step
from scenario_compiler.engine.story.sweep import sweep
from scenario_compiler.forms.language import Marked

ENTRIES: tuple[Marked, ...] = (
    *(reset, begin_step, move_step, end_step, step, look_out, look_at_view, sweep),
    *(spawn_entity, delete_entity, find_contacts, find_touched, note_world_collision),
)
"""The entries of both forms."""
