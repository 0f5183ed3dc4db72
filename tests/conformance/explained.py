"""Why runs differ from the recorded ones, where they do."""

from __future__ import annotations

EXPLAINED: dict[str, str] = {}
"""Path of a scenario in the corpus to the reason."""
