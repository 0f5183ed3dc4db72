"""Expands the conflict language and the AISA toolkit's file from an XML document to a `Scenario`.

In: a document. Out: scenarios, without templates, catalogs and structural parameters, and diagnostics. Imports
`markup`, the vocabulary and the hall, but neither roads, nor the engine, nor another language (`languages` knows them
all).
"""
