"""The words of a scenario, each declared once, and `Scenario` itself.

In: nothing. Out: frozen models that front ends build, lowering binds and plans hold. Imports the hall only.

No module here postpones its annotations (`from __future__ import annotations`): pydantic reads those of every word when
the word is declared, and to evaluate them from text takes a fifth of what declaring the vocabulary takes.
"""
