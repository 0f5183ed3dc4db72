"""Measures of a running run: totals to which each of its rows is added."""
