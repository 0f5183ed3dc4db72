"""Writes a run as an MCAP file for Foxglove: boxes, the takeover, measured values, events, pictures.

Messages are JSON in Foxglove's own schemas if it has one (https://docs.foxglove.dev/docs/sdk/schemas), otherwise in
schemas that the file contains. Times count from the start of the run. Axes are OpenDRIVE's, x east, y north, z up, in
the frame "map".
"""

from __future__ import annotations

import base64
import io
import json
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from mcap.writer import Writer

from scenario_compiler.outputs import write_whole
from scenario_compiler.recording.names import CAUSES, TAKEOVER_STATES
from scenario_compiler.recording.recording import COLUMNS
from scenario_compiler.report.replay import Picture
from scenario_compiler.report.run import Run

FRAME = "map"

VALUES = (
    *("confidence_left", "confidence_right", "sensor_health", "sigma", "blocked_distance", "lane_end_distance"),
    *("v", "a", "throttle", "brake", "steer"),
)
"""Columns of the topic /values; those of entities are for the first entity."""

LEVELS = {"warning": 3, "request": 4, "escalation": 4, "collision": 5, "minimum_risk": 4}
"""Level of an event in Foxglove's log: 2 information, 3 warning, 4 error, 5 fatal."""

TIME = {"type": "object", "properties": {"sec": {"type": "integer"}, "nsec": {"type": "integer"}}}
NAMED = {"type": "object", "properties": {"timestamp": TIME}}


def write_mcap(run: Run, path: Path, pictures: tuple[Picture, ...]) -> None:
    """Write a run and its first-person pictures as an MCAP file; equal runs give equal bytes.

    Raises:
        OSError: The file cannot be written.
    """
    content = io.BytesIO()
    writer = Writer(content)
    writer.start(profile="", library="scenario-compiler")
    channels: dict[str, int] = {}
    for topic, (schema, description) in _topics().items():
        number = writer.register_schema(name=schema, encoding="jsonschema", data=json.dumps(description).encode())
        channels[topic] = writer.register_channel(topic=topic, message_encoding="json", schema_id=number)
    for t, topic, message in sorted(_messages(run, pictures), key=lambda one: one[0]):
        at = round(t * 1e9)
        writer.add_message(channels[topic], log_time=at, publish_time=at, data=json.dumps(message).encode())
    writer.add_metadata("run", {"name": run.plan.name, "plan": run.plan.digest, "seed": str(run.recording.header.seed)})
    writer.finish()  # type: ignore[no-untyped-call]  # the package does not say that it returns nothing
    write_whole(path, content.getvalue())


def _topics() -> dict[str, tuple[str, dict[str, Any]]]:
    """Return name and contents of the schema of each topic."""
    units = {column.name: column for column in COLUMNS}
    numbers = {
        name: {"type": "number", "description": f"{units[name].description} Unit: {units[name].unit or 'none'}."}
        for name in VALUES
    }
    texts = {name: {"type": "string"} for name in ("state", "cause")}
    return {
        "/scene": ("foxglove.SceneUpdate", NAMED),
        "/log": ("foxglove.Log", NAMED),
        "/camera": ("foxglove.CompressedImage", NAMED),
        "/values": ("run.Values", {"type": "object", "properties": numbers}),
        "/takeover": ("run.Takeover", {"type": "object", "properties": texts}),
    }


def _messages(run: Run, pictures: tuple[Picture, ...]) -> Iterator[tuple[float, str, dict[str, Any]]]:
    recording = run.recording
    for row, t in enumerate(recording.t.tolist()):
        yield t, "/scene", _scene(run, row, t)
        values = {}
        for name in VALUES:
            column = getattr(recording, name)
            value = float(column[row] if column.ndim == 1 else column[row, 0])
            if math.isfinite(value):
                values[name] = value
        yield t, "/values", values
        if run.plan.controller is not None:
            state, cause = int(recording.takeover_state[row]), int(recording.cause[row])
            yield t, "/takeover", {"state": TAKEOVER_STATES[state], "cause": CAUSES[cause]}
    for event in recording.events:
        about = ", ".join(text for text in (event.entity, event.cause, event.message) if text)
        text = f"{event.kind}: {about}" if about else event.kind
        level = LEVELS.get(event.kind, 2)
        yield event.t, "/log", {"timestamp": _time(event.t), "level": level, "message": text, "name": run.plan.name}
    for picture in pictures:
        data = base64.b64encode(picture.data).decode()
        kind = picture.type.removeprefix("image/")
        yield picture.t, "/camera", {"timestamp": _time(picture.t), "frame_id": "camera", "data": data, "format": kind}


def _scene(run: Run, row: int, t: float) -> dict[str, Any]:
    recording, entities, gone = run.recording, [], []
    for i, entity in enumerate(run.plan.entities):
        if not recording.present[row, i]:
            gone.append({"timestamp": _time(t), "type": 0, "id": entity.id})
            continue
        vehicle, h = entity.vehicle, float(recording.h[row, i])
        x = float(recording.x[row, i]) + vehicle.center * math.cos(h)
        y = float(recording.y[row, i]) + vehicle.center * math.sin(h)
        z = float(recording.z[row, i]) + 0.5 * vehicle.height
        pose = {
            "position": {"x": x, "y": y, "z": z},
            "orientation": {"x": 0.0, "y": 0.0, "z": math.sin(h / 2), "w": math.cos(h / 2)},
        }
        colour = {"r": 0.0, "g": 0.45, "b": 0.7, "a": 0.9} if i == 0 else {"r": 0.8, "g": 0.8, "b": 0.8, "a": 0.9}
        size = {"x": vehicle.length, "y": vehicle.width, "z": vehicle.height}
        text_pose = {**pose, "position": {"x": x, "y": y, "z": z + vehicle.height}}
        text = {"pose": text_pose, "billboard": True, "font_size": 1.0, "color": colour, "text": entity.id}
        entities.append(
            {
                "timestamp": _time(t),
                "frame_id": FRAME,
                "id": entity.id,
                "lifetime": {"sec": 0, "nsec": 0},
                "cubes": [{"pose": pose, "size": size, "color": colour}],
                "texts": [text],
            }
        )
    return {"deletions": gone, "entities": entities}


def _time(t: float) -> dict[str, int]:
    seconds, rest = divmod(round(t * 1e9), 1_000_000_000)
    return {"sec": seconds, "nsec": rest}
