"""The events of a study as a stream of the Lab Streaming Layer, for recording together with other devices.

One stream of markers, each a JSON object: the participant and the session, and then a record of the journal or an event
of a run, as it stands in their files. The layer puts its own time to each.
"""

from __future__ import annotations

import json
from typing import Any

import pylsl

CONTENT = "Markers"
"""Type of the stream, by which recorders find it."""


class MarkerOutlet:
    """Sends markers to whoever in the network listens."""

    def __init__(self, name: str) -> None:
        """Open the stream of a study; `name` is the stream's and its source's."""
        info = pylsl.StreamInfo(name, CONTENT, 1, pylsl.IRREGULAR_RATE, "string", f"scenario-compiler {name}")
        self._outlet = pylsl.StreamOutlet(info)

    def mark(self, marker: dict[str, Any]) -> None:
        """Send a marker now."""
        self._outlet.push_sample([json.dumps(marker, ensure_ascii=False)])
