"""A server that speaks CARLA's network protocol, so that CARLA's clients run against our world unchanged.

In: OpenDRIVE maps and what clients call. Out: CARLA's answers and streams. `protocol.py` is the protocol as one table,
`answers/` what is done for each call, `sensors/` what each sensor delivers.
"""
