"""A limit shared by the language and the engine. It is separate because the engine is built without the words."""

HORIZON = 30.0
"""Greatest time to collision, s. Beyond it there is no time to collision: nobody keeps speed and path for so long.

The number is our own choice. Without it, almost equal speeds would give meaningless times of hours.
"""
