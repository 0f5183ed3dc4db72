"""Sweeps: sampling, grouping, running and storing thousands of variants of a scenario.

In: a scenario file and a `SweepSpec`. Out: a folder with one row a variant as Parquet, chosen traces and a report.
Imports everything below. scipy is imported in `sampling` and `search` alone, pyarrow in `results` and `finished`,
dask in `cluster`.
"""
