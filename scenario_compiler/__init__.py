"""Declarative scenario compiler: conflicts written as XML become runs with a takeover and a report.

The public names are imported when they are first used, so that importing the package costs nothing.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from scenario_compiler.compiler import Compilation, Overrides, compile_built, compile_scenario
    from scenario_compiler.controllers import Control, ControllerModel, ControllerParams
    from scenario_compiler.diagnostics import CompileError
    from scenario_compiler.openscenario.export.files import write_openscenario
    from scenario_compiler.plan.model import Plan
    from scenario_compiler.recording.outcome import Outcome, judge
    from scenario_compiler.recording.recording import Recording
    from scenario_compiler.report.html import write_report
    from scenario_compiler.report.run import Run
    from scenario_compiler.resources import find_map
    from scenario_compiler.roads import Network, load_network
    from scenario_compiler.runtime import open_world, run
    from scenario_compiler.trust import Trust

_HOMES = {
    "Compilation": "compiler",
    "CompileError": "diagnostics",
    "Control": "controllers",
    "ControllerModel": "controllers",
    "ControllerParams": "controllers",
    "Network": "roads",
    "Outcome": "recording.outcome",
    "Overrides": "compiler",
    "Plan": "plan.model",
    "Recording": "recording.recording",
    "Run": "report.run",
    "Trust": "trust",
    "compile_built": "compiler",
    "compile_scenario": "compiler",
    "find_map": "resources",
    "judge": "recording.outcome",
    "load_network": "roads",
    "open_world": "runtime",
    "run": "runtime",
    "write_openscenario": "openscenario.export.files",
    "write_report": "report.html",
}

__all__ = [
    "Compilation",
    "CompileError",
    "Control",
    "ControllerModel",
    "ControllerParams",
    "Network",
    "Outcome",
    "Overrides",
    "Plan",
    "Recording",
    "Run",
    "Trust",
    "compile_built",
    "compile_scenario",
    "find_map",
    "judge",
    "load_network",
    "open_world",
    "run",
    "write_openscenario",
    "write_report",
]


def __getattr__(name: str) -> object:
    """Import a public name from its home on first use."""
    if name not in _HOMES:
        raise AttributeError(f"module 'scenario_compiler' has no attribute '{name}'")
    return getattr(importlib.import_module(f"scenario_compiler.{_HOMES[name]}"), name)


def __dir__() -> list[str]:
    """Return the public names."""
    return sorted(__all__)
