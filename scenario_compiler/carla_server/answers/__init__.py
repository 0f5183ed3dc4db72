"""What is done for each call; `protocol.py` says for which."""
