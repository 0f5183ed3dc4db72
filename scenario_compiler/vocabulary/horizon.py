"""A limit that the language and the engine share; apart from the words, because the engine is built without them."""

HORIZON = 30.0
"""Time from which on there is no time to collision, s: nobody keeps speed and path unchanged for so long.

The number is our own choice. Speeds that are almost equal would otherwise give times of hours, which say nothing.
"""
