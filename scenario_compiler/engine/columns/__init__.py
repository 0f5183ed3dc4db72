"""The containers' columns, and the functions that know nothing else: numbers, the log, who is there."""
