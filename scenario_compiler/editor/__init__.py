"""A language server, which supports editors while a scenario file is written.

In: the texts of an editor, and a place in one of them. Out: findings, completions, explanations, definitions, edits.
They are all derived from the compiler's own parts: the words' declarations, its reader and its diagnostics. Only
`server` knows the protocol; the other modules are functions of texts. Imports the compiler and what is below it.
"""
