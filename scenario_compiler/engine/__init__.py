"""The engine, which executes a plan in compiled or interpreted form from the same source.

In: a `Plan` and a `Network`, lowered to the flat columns of a `Program`. Out: the columns of a `State`, step by step.
Imports the plan, the vocabulary, roads, `forms` and the hall. It knows no XML.
"""
