"""Sensors: each kind is a class; a spawned sensor is asked for its message in each tick."""
