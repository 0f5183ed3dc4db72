"""The coverage of a library of scenarios: situations, conditions, tags, near-duplicates, and gaps.

In: a folder of scenarios. Out: a `Survey`, as JSON and as a page, and each scenario's tags in ASAM OpenLABEL's form.
Imports the compiler, the runtime and what is below them.
"""
