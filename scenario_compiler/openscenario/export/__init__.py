"""Writes a plan as an OpenSCENARIO file.

In: a plan and its map. Out: elements, and a diagnostic for everything that the standard or the version cannot express.
"""
