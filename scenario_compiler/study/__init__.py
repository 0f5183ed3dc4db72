"""Studies with participants: their procedure, running their sessions, and their data.

A session is a sequence of steps (`procedure`). Its events are written to a journal at once, and all tables are made
from journals and recordings. A driver model can take part in a study like a person (`pilot`).
"""
