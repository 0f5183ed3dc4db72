"""Where entities are and how they move: places, paths, steering, scripted motion, collisions, distances."""
