"""Measures of a run, as totals that are updated with each of its rows."""
