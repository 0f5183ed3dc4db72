"""Reads OpenSCENARIO XML 1.0 to 1.3 as a `Scenario`.

In: a document whose root element is <OpenSCENARIO>. Out: the scenario and diagnostics. Imports `markup`, the
vocabulary and the hall; only `export/` imports the plan, roads and the engine.
"""
