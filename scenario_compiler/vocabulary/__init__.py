"""The words of a scenario, each declared once, and `Scenario` itself.

Input: nothing. Output: records that front ends build, lowering binds, and plans contain. Imports only the hall.

The modules with words do not postpone annotations (`from __future__ import annotations`): to evaluate those of the
words that a run uses from text takes as long as to evaluate those of all words when they are declared.
"""
