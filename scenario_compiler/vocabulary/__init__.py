"""The words of a scenario, each declared once, and `Scenario` itself.

Input: nothing. Output: frozen models that front ends build, lowering binds, and plans contain. Imports only the hall.

No module here postpones its annotations (`from __future__ import annotations`). Pydantic reads the annotations of every
word when the word is declared, and evaluating them from text would take a fifth of the time for declaring the
vocabulary.
"""
