"""Sensors: each kind is a class that is made when a client spawns one and asked for its message in a tick."""
