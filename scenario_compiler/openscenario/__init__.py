"""Reads OpenSCENARIO XML 1.0 to 1.3 as a `Scenario`.

In: a document whose root element is <OpenSCENARIO>. Out: the scenario and diagnostics. Imports the vocabulary and the
hall, but neither roads nor the engine.
"""
