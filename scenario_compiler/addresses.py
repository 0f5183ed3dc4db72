"""Addresses of servers: which ones only this machine can reach, and how they are written."""

from __future__ import annotations

LOOPBACK = ("127.0.0.1", "localhost", "::1")
"""Hosts that only this machine can reach."""


def bracketed(host: str) -> str:
    """Return a host in the notation of URLs."""
    return f"[{host}]" if ":" in host else host
