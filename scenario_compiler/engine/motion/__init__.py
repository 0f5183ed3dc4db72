"""Positions of entities and their motion: paths, steering, scripted motion, collisions, distances."""
