"""The reason why a run ends early if the engine has no result."""

from __future__ import annotations

from scenario_compiler.diagnostics import Code

ENGINE_BROKE_OFF = Code(
    "SC522",
    "engine-broke-off",
    "The engine's arithmetic had no result, such as a division by zero: this is a fault of the program, not of the "
    "scenario. The recording up to that step is kept. Please report it with the scenario and the seed.\n\n"
    "    scenario-compiler run conflict.xml --seed 7 --interpreted     repeats it in plain Python, for a debugger",
)
