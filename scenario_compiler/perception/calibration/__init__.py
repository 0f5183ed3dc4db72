"""Fits the lane detector's confidence, and measures how reliable it is.

In: road files. `maps` makes clips along their lanes and `bank` makes situations, both with the truth for each picture.
`collect` runs a detector on them, `gather` does so on several cores. `fit` fits the confidence, and `figures` measures
its reliability, leaving out one map after the other from the fit. `scenario-compiler calibrate` writes the page.
"""
