"""Our world behind CARLA's wire protocol, so that any client program of CARLA runs against it unchanged.

In: OpenDRIVE maps and what clients call. Out: CARLA's answers and streams. `protocol.py` is the protocol as one table,
`answers/` what is done for each call, `sensors/` what each sensor delivers.
"""
