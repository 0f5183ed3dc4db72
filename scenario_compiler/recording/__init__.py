"""What a run leaves behind, and what is read off it.

In: rows of plain numbers and events of a run. Out: a `Recording`, its files (Parquet, CSV), measures, judged
criteria and an `Outcome`. Imports the engine's codes, the plan, the vocabulary and the hall; pyarrow in `arrow`
and `store` alone.
"""
