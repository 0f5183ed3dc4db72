"""What actions do, an entry each: the row that its word becomes, its start, its step, what the log says of it.

A new action is one `Entry` beside the functions that execute it, and its place in `ACTIONS`.
"""
