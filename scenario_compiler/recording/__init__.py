"""Recordings of runs, and everything that is computed from them.

In: rows of plain numbers and events of a run. Out: a `Recording`, its files (Parquet, CSV), measures, judged criteria
and an `Outcome`. Imports the engine's codes, the plan, the vocabulary and the hall; only `arrow` and `store` import
pyarrow.
"""
