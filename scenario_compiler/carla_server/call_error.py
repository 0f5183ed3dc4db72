"""The error of a call that cannot be answered; CARLA's clients raise it as a RuntimeError."""

from __future__ import annotations


class CallError(Exception):
    """A call cannot be answered; the text of the exception is sent to the client."""
