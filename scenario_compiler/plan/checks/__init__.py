"""Semantic checks over a lowered plan, in the order in which they run."""

from collections.abc import Callable

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.plan.checks.bends import check_bends
from scenario_compiler.plan.checks.camera import check_camera
from scenario_compiler.plan.checks.causes import check_causes
from scenario_compiler.plan.checks.classifications import check_classifications
from scenario_compiler.plan.checks.controllers import check_controllers
from scenario_compiler.plan.checks.curves import check_curves
from scenario_compiler.plan.checks.driver import check_driver
from scenario_compiler.plan.checks.effects import check_effects
from scenario_compiler.plan.checks.endless import check_endless
from scenario_compiler.plan.checks.failures import check_failures
from scenario_compiler.plan.checks.initial import check_initial
from scenario_compiler.plan.checks.messages import check_messages
from scenario_compiler.plan.checks.moves import check_moves
from scenario_compiler.plan.checks.nowhere import check_nowhere
from scenario_compiler.plan.checks.overlap import check_overlap
from scenario_compiler.plan.checks.paths import check_paths
from scenario_compiler.plan.checks.plausible import check_plausible
from scenario_compiler.plan.checks.presence import check_presence
from scenario_compiler.plan.checks.reach import check_budget, check_range, check_reach
from scenario_compiler.plan.checks.restarts import check_restarts
from scenario_compiler.plan.checks.routes import check_routes
from scenario_compiler.plan.checks.start import check_start
from scenario_compiler.plan.checks.triggers import check_triggers
from scenario_compiler.plan.checks.world import check_world
from scenario_compiler.plan.model import Plan
from scenario_compiler.roads import Network

CHECKS: tuple[Callable[[Plan, Network, Diagnostics], None], ...] = (
    check_start,
    check_bends,
    check_nowhere,
    check_initial,
    check_presence,
    check_overlap,
    check_camera,
    check_causes,
    check_driver,
    check_paths,
    check_curves,
    check_routes,
    check_plausible,
    check_budget,
    check_range,
    check_reach,
    check_triggers,
    check_failures,
    check_messages,
    check_moves,
    check_restarts,
    check_endless,
    check_world,
    check_controllers,
    check_effects,
    check_classifications,
)
