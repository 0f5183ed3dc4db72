"""Measures of a run that is still running: totals that its rows are added to, one after the other."""
