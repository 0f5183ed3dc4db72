"""A language server, which supports editors while a scenario file is written.

In: the texts that an editor holds, and a place in one. Out: findings, completions, explanations, definitions, edits.
All of it comes from where the compiler has it: the words' declarations, its reader and its diagnostics. `server` alone
knows the protocol; the other modules are functions over texts. Imports the compiler and what is below it.
"""
