"""Measures what the lane detector's confidence is worth, and fits it.

In: road files. `maps` drives clips along their lanes and `bank` makes up situations, both with the truth beside each
picture; `collect` lets a detector look at them, `gather` on several cores; `fit` fits the confidence, and `figures`
says what it is worth, with maps left out of the fit in turn. `scenario-compiler calibrate` writes the page.
"""
