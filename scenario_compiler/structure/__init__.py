"""Checks whether a file of one of ASAM's XML formats has the structure of its version.

In: a document, a `grammar.Grammar` (the format's declarations of elements, words and kinds of values) and a version.
Out: diagnostics with line and column (`walk.check_elements`). Knows no format: `roads.structure` declares OpenDRIVE's,
`openscenario.structure` OpenSCENARIO's. Imports the flat modules of the hall.
"""
