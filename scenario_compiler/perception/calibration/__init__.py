"""Fits the lane detector's confidence on rendered roads, and measures what it is worth.

`python -m scenario_compiler.perception.calibration` draws the roads, fits the logistic weights, measures the
table of confidences and writes both to `perception/lane_confidence.json`, which is a part of the package. It
takes some three minutes on one core and is run again when the renderer or the detector's features change; a
test tells when the table no longer holds.
"""
