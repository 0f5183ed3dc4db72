"""A limit shared by the language and the engine. It is separate because the engine is built without the words."""

HORIZON = 30.0
"""Greatest time to collision, s. A longer one is undefined, because nobody keeps speed and path for so long.

The number is our own choice. Without it, almost equal speeds would give meaningless times of hours.
"""
