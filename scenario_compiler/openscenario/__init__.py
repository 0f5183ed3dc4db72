"""Reads OpenSCENARIO XML 1.0 to 1.3 as a `Scenario`.

In: a document whose first element is <OpenSCENARIO>. Out: the scenario and diagnostics. Imports the vocabulary and the
hall; knows no road and no engine.
"""
