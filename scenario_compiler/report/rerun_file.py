"""Writes a run as a file of the Rerun viewer: boxes, paths, values over time, events as a log, pictures."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
import rerun as rr

from scenario_compiler.outputs import write_whole
from scenario_compiler.report.replay import Picture
from scenario_compiler.report.run import Run

VALUES = ("confidence_left", "confidence_right", "sensor_health", "blocked_distance", "lane_end_distance")

LEVELS = {
    "warning": "WARN",
    "request": "ERROR",
    "escalation": "ERROR",
    "minimum_risk": "ERROR",
    "collision": "CRITICAL",
}


def write_rerun(run: Run, path: Path, pictures: tuple[Picture, ...]) -> None:
    """Write a run and its first-person pictures as a .rrd file, on the timeline "t" from the start of the run.

    Raises:
        OSError: The file cannot be written.
    """
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "run.rrd"
        stream = rr.RecordingStream("scenario-compiler", recording_id=run.recording.trajectory_hash[:32])
        stream.save(file)
        _log(stream, run, pictures)
        stream.flush()
        stream.disconnect()
        write_whole(path, file.read_bytes())


def _log(stream: rr.RecordingStream, run: Run, pictures: tuple[Picture, ...]) -> None:
    recording = run.recording
    stream.log("world", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    for i, entity in enumerate(run.plan.entities):
        there = recording.present[:, i]
        way = np.stack([column[there, i] for column in (recording.x, recording.y, recording.z)], axis=-1)
        stream.log(["world", "ways", entity.id], rr.LineStrips3D([way]), static=True)
    for row, t in enumerate(recording.t.tolist()):
        stream.set_time("t", duration=t)
        for i, entity in enumerate(run.plan.entities):
            place = ["world", entity.id]  # as parts: a name may contain a slash or a space
            if not recording.present[row, i]:
                stream.log(place, rr.Clear(recursive=True))
                continue
            vehicle, h = entity.vehicle, float(recording.h[row, i])
            centre = (
                float(recording.x[row, i]) + vehicle.center * np.cos(h),
                float(recording.y[row, i]) + vehicle.center * np.sin(h),
                float(recording.z[row, i]) + 0.5 * vehicle.height,
            )
            turn = rr.Quaternion(xyzw=[0.0, 0.0, np.sin(h / 2), np.cos(h / 2)])
            half = (0.5 * vehicle.length, 0.5 * vehicle.width, 0.5 * vehicle.height)
            boxes = rr.Boxes3D(centers=[centre], half_sizes=[half], quaternions=[turn], labels=[entity.id])
            stream.log(place, boxes)
            stream.log(["speed", entity.id], rr.Scalars(float(recording.v[row, i])))
        for name in VALUES if run.plan.controller is not None else ():
            value = float(getattr(recording, name)[row])
            if np.isfinite(value):
                stream.log(f"values/{name}", rr.Scalars(value))
    for event in recording.events:
        stream.set_time("t", duration=event.t)
        about = ", ".join(text for text in (event.entity, event.cause, event.message) if text)
        text = f"{event.kind}: {about}" if about else event.kind
        stream.log("events", rr.TextLog(text, level=LEVELS.get(event.kind, "INFO")))
    for picture in pictures:
        stream.set_time("t", duration=picture.t)
        stream.log("camera", rr.EncodedImage(contents=picture.data, media_type=picture.type))
