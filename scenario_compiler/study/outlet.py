"""The events of a study as a stream of the Lab Streaming Layer, for recording together with other devices.

It is one stream of markers. Each is a JSON object with the participant and the session, and a record of the journal or
an event of a run as in their files. The layer adds its own time to each.
"""

from __future__ import annotations

import json
from typing import Any

import pylsl

CONTENT = "Markers"
"""Type of the stream, by which recorders find it."""


class MarkerOutlet:
    """Sends markers to receivers in the network."""

    def __init__(self, name: str) -> None:
        """Open the stream of a study; `name` is the name of the stream and of its source."""
        info = pylsl.StreamInfo(name, CONTENT, 1, pylsl.IRREGULAR_RATE, "string", f"scenario-compiler {name}")
        self._outlet = pylsl.StreamOutlet(info)

    def mark(self, marker: dict[str, Any]) -> None:
        """Send a marker now."""
        self._outlet.push_sample([json.dumps(marker, ensure_ascii=False)])
