"""The error of a call that cannot be answered; CARLA's clients raise it as a RuntimeError."""

from __future__ import annotations


class CallError(Exception):
    """A call has no answer; its text is sent to the client."""
