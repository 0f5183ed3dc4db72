"""The plan (the intermediate representation), the passes that lower a scenario to it, the checks, and the file format.

In: a `Scenario` and a `Network`. Out: a `Plan`. Imports the vocabulary, roads and the hall.
"""
