"""A run as a video, MP4 or GIF: the driver's view, the run from above, or both, with the takeover's timeline.

Each picture shows the last recorded row that is not after its time; a video lasts as long as its run. PyAV encodes it.
"""

from __future__ import annotations

import io
import math
from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import av
import numpy as np
from av.container import OutputContainer
from av.filter import Graph
from av.video.stream import VideoStream
from numpy.typing import NDArray

from scenario_compiler.outputs import write_whole
from scenario_compiler.report.palette import MOMENT_COLOURS, STATE_COLOURS
from scenario_compiler.report.pictures import Sights, even_times, row_at, stills
from scenario_compiler.report.run import Run

if TYPE_CHECKING:
    from scenario_compiler.perception.camera import Camera

Shows = Literal["view", "map", "both"]
"""Possible contents of a video."""

RATES = {".mp4": 25, ".gif": 5}
"""Pictures per second of a video, by its suffix."""

HEIGHTS = {".mp4": 480, ".gif": 240}
"""Height of its pictures above the timeline, pixels."""

BAR = 24
"""Height of the timeline, pixels."""

ABOVE, AHEAD, SEEN = 90.0, 22.0, math.radians(42.0)
"""The camera above: height above the road, distance ahead of the vehicle, m, and field of view, rad."""

CODECS = (
    ("libx264", {"crf": "28", "preset": "veryfast"}),
    ("libvpx-vp9", {"crf": "33", "b": "0", "deadline": "realtime", "cpu-used": "8"}),
)
"""Codecs of MP4 with their options: H.264, and VP9 if PyAV was built without it."""

Image = NDArray[np.uint8]


def write_video(run: Run, path: Path, shows: Shows = "both") -> None:
    """Write the video of a run; its suffix, .mp4 or .gif, determines the format.

    Raises:
        ValueError: The suffix is another one.
        OSError: The file cannot be written.
    """
    ending = path.suffix.lower()
    if ending not in RATES:
        raise ValueError(f"a film is written as .mp4 or .gif, not as '{path.suffix}'")
    content = io.BytesIO()
    frames = film(run, RATES[ending], HEIGHTS[ending], shows)
    (_write_mp4 if ending == ".mp4" else _write_gif)(content, frames, RATES[ending])
    write_whole(path, content.getvalue())


def film(run: Run, rate: int, height: int, shows: Shows) -> Iterator[Image]:
    """Yield the pictures of a video, (height + BAR, width, 3) uint8, RGB; equal runs give equal pictures."""
    rows = [row_at(run, t) for t in even_times(run, rate)]
    sights = Sights(run, 2 * height)
    bar = _timeline(run, height * {"view": 2, "map": 1, "both": 3}[shows])
    above = _above(height)
    for still in stills(run, rows):
        parts = []
        if shows != "map":
            parts.append(sights.draw(still, caption=True))
        if shows != "view":
            parts.append(sights.draw_from(still, above))
        image = np.concatenate([np.concatenate(parts, axis=1), _at(bar, run, still.row)])[..., ::-1]
        for _ in range(rows.count(still.row)):
            yield np.ascontiguousarray(image)


def _above(height: int) -> Camera:
    from scenario_compiler.perception.overlay import DRIVER

    return replace(
        DRIVER, width=height, height=height, fov=SEEN, x=AHEAD, z=ABOVE, pitch=-0.5 * math.pi, windscreen=False
    )


def _timeline(run: Run, width: int) -> Image:
    """Return the bar of the takeover's states with a line at each moment, (BAR, width, 3), BGR."""
    begin, end = float(run.recording.t[0]), float(run.recording.t[-1])
    bar = np.full((BAR, width, 3), 96, np.uint8)

    def column(t: float) -> int:
        return round((t - begin) / max(end - begin, 1e-6) * (width - 1))

    for interval in run.outcome.timeline if run.plan.controller is not None else ():
        bar[4:, column(interval.begin) : column(interval.end) + 1] = _bgr(STATE_COLOURS[interval.state])
    for kind, t in run.moments:
        bar[:, max(0, column(t) - 1) : column(t) + 1] = _bgr(MOMENT_COLOURS[kind])
    return bar


def _at(bar: Image, run: Run, row: int) -> Image:
    """Return the timeline with a mark at a row's time."""
    t = run.recording.t
    at = round(float(t[row] - t[0]) / max(float(t[-1] - t[0]), 1e-6) * (bar.shape[1] - 1))
    marked = bar.copy()
    marked[:, max(0, at - 2) : at + 3] = 255
    return marked


def _bgr(colour: str) -> tuple[int, int, int]:
    return int(colour[5:7], 16), int(colour[3:5], 16), int(colour[1:3], 16)


def _write_mp4(file: io.BytesIO, frames: Iterator[Image], rate: int) -> None:
    codec, options = next(one for one in CODECS if one[0] in av.codecs_available)
    first = next(frames)
    with av.open(file, "w", format="mp4") as container:
        stream = _video_stream(container, codec, rate, first, "yuv420p", options)
        for image in chain([first], frames):
            container.mux(stream.encode(av.VideoFrame.from_ndarray(image, format="rgb24")))
        container.mux(stream.encode())


def _write_gif(file: io.BytesIO, frames: Iterator[Image], rate: int) -> None:
    """Write a GIF with a palette made from all its pictures."""
    first = next(frames)
    with av.open(file, "w", format="gif") as container:
        stream = _video_stream(container, "gif", rate, first, "pal8", {})
        graph, count = _palette_graph(first.shape[1], first.shape[0], rate), 0
        for image in chain([first], frames):
            frame = av.VideoFrame.from_ndarray(image, format="rgb24")
            frame.pts, frame.time_base = count, Fraction(1, rate)
            graph.vpush(frame)
            count += 1
        graph.vpush(None)
        for _ in range(count):
            container.mux(stream.encode(graph.vpull()))
        container.mux(stream.encode())


def _video_stream(
    container: OutputContainer, codec: str, rate: int, first: Image, pixels: str, options: dict[str, str]
) -> VideoStream:
    """Add a stream to a video, for pictures of the size of the first one."""
    stream = container.add_stream(codec, rate=rate, options=options)
    if not isinstance(stream, VideoStream):
        raise TypeError(f"{codec} is not a video codec")
    stream.height, stream.width = first.shape[:2]
    stream.pix_fmt = pixels
    return stream


def _palette_graph(width: int, height: int, rate: int) -> Graph:
    """Return filters that reduce pictures to their best common palette."""
    graph = Graph()
    source = graph.add_buffer(width=width, height=height, format=av.VideoFormat("rgb24"), time_base=Fraction(1, rate))
    split = graph.add("split")
    palette, use = graph.add("palettegen", "max_colors=64"), graph.add("paletteuse", "dither=none")
    sink = graph.add("buffersink")
    source.link_to(split)
    split.link_to(palette, 0)
    palette.link_to(use, 0, 1)
    split.link_to(use, 1, 0)
    use.link_to(sink)
    graph.configure()
    return graph
