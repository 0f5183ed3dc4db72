"""A server that speaks CARLA's network protocol, so that CARLA's clients run against our world unchanged.

In: OpenDRIVE maps and the calls of clients. Out: CARLA's answers and streams. `protocol.py` is the protocol as one
table, `answers/` has the handlers of the calls, `sensors/` a class for each kind of sensor.
"""
