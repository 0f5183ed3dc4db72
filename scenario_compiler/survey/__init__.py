"""What a library of scenarios covers: situations by taxonomy, conditions, tags, near-duplicates, and what is missing.

In: a folder of scenarios. Out: a `Survey`, as JSON and as a page, and each scenario's tags in ASAM OpenLABEL's form.
Imports the compiler, the runtime and what is below them.
"""
