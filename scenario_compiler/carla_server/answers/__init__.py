"""The handlers of calls; `protocol.py` assigns them to the calls."""
