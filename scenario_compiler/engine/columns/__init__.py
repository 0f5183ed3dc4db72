"""The columns of all containers, and basic functions on numbers, the log and the presence of entities."""
