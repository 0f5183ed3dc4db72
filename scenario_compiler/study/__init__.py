"""Studies with participants: their procedure, running their sessions, and their data.

A session is a row of steps (`procedure`). What happens in it is written to a journal as it happens, and all tables are
made from journals and recordings. A driver model goes through a study as a person does (`pilot`).
"""
