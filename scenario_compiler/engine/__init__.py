"""The engine: executes a plan, as machine code or interpreted, from one source.

In: a `Plan` and a `Network`, lowered to the flat columns of a `Program`. Out: the columns of a `State`, step by step.
Imports the plan, the vocabulary, roads and the hall. It knows no XML.
"""
