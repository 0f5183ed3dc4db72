"""The words of a scenario, each declared once, and `Scenario` itself.

In: nothing. Out: frozen models that front ends build, lowering binds and plans hold. Imports the hall only.
"""
