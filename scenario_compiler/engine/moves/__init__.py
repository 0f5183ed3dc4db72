"""Actions, each with an entry: the row of its word, its start, its step, and its text in the log.

A new action is one `Entry` next to the functions that execute it, and its module's place in `FAMILIES`.
"""
