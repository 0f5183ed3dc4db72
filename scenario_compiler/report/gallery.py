"""A page with all conflicts of a library: a picture, a summary and the command for each; with search and filters."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from scenario_compiler.outputs import write_whole
from scenario_compiler.plan.model import Plan, StartPose
from scenario_compiler.plan.painted import lines_beside
from scenario_compiler.recording.outcome import judge
from scenario_compiler.report.embedding import page_script
from scenario_compiler.report.palette import WORDS, words_of
from scenario_compiler.report.pictures import Sights, row_at, stills
from scenario_compiler.report.preview import start_of, way_ahead
from scenario_compiler.report.run import Run
from scenario_compiler.report.templates import page_environment
from scenario_compiler.report.wording import decimal
from scenario_compiler.roads.network import Network
from scenario_compiler.roads.positions import Pose
from scenario_compiler.runtime.loop import open_world, run

if TYPE_CHECKING:
    from numpy.typing import NDArray

TEMPLATE = "gallery.html.jinja"

SHRINK = 3
"""Number of pixels of the driver's view, in each direction, for one pixel of a thumbnail."""


CLOSE = 32.0
"""Distance from which the first actor ahead is shown, m; if it is farther away at the start, the view is from the
route.
"""

THUMBNAIL_VIEW = math.radians(36.0)
"""Field of view of a thumbnail at the moment, rad: half of the driver's, so that distant things are visible."""

GREYS = 4.0
"""Step to which a thumbnail's grey levels are rounded, so that its file is small."""


@dataclass(frozen=True, slots=True)
class Card:
    """The gallery's information on one conflict.

    Attributes:
        group: Heading of its group.
        name: Its name.
        summary: Its summary.
        source: Source of the situation.
        command: The command that runs it, without a path of the machine on which the page was made.
        map: Name of the map.
        moment: The contents of the picture.
    """

    group: str
    name: str
    summary: str
    source: str
    command: str
    map: str
    moment: Moment


@dataclass(frozen=True, slots=True)
class Moment:
    """The moment of a conflict.

    Attributes:
        words: Its description and time, for readers.
        cause: Cause of the takeover request, in words; empty if there is none.
        picture: The view ahead, as a PNG file.
    """

    words: str
    cause: str
    picture: bytes


def moment_of(plan: Plan, network: Network) -> Moment:
    """Return the moment of a plan without a camera: its takeover request or collision, or else its start.

    Equal plans give equal bytes.

    Raises:
        ValueError: No entity has a start position, and nothing happens in the run.
    """
    from scenario_compiler.perception.overlay import encode_png

    with open_world("kinematic", plan, network) as world:
        recording = run(plan, world, 1)
    shown = Run(plan, network, recording, judge(plan, recording))
    kind, t = shown.focus
    if kind not in ("request", "collision") or not recording.present[:, :1].all():
        return Moment("at the start", "", start_picture(plan, network))
    sights = Sights(shown, fov=THUMBNAIL_VIEW)
    still = next(stills(shown, [row_at(shown, t)]))
    cause = words_of(shown.outcome.cause)
    words = f"{WORDS[kind]} after {decimal(t)} s" + (f": {cause}" if cause else "")
    return Moment(words, cause, encode_png(shrunk(sights.draw(still, labelled=False), SHRINK)))


def start_picture(plan: Plan, network: Network) -> bytes:
    """Return the start as seen by an approaching driver, as a small PNG file; equal plans give equal bytes.

    Raises:
        ValueError: No entity has a start position.
    """
    from scenario_compiler.perception.overlay import DRIVER, encode_png
    from scenario_compiler.perception.road_camera import RoadCamera
    from scenario_compiler.perception.stage import Stage

    shown = plan.model_copy(update={"entities": tuple(one for one in plan.entities if one.id in plan.derived)})
    starts = [_viewpoint(plan, network), *(plan.derived[one.id] for one in shown.entities[1:])]
    poses = [Pose(one.x, one.y, one.z, one.heading, 0.0, 0.0) for one in starts]
    stage = Stage(shown, network, lines_beside(shown, network, poses))
    boxes = stage.boxes((number, pose, False) for number, pose in enumerate(poses) if number > 0)
    camera = RoadCamera(stage.scene, DRIVER, 1, plan.ego.vehicle.center)
    picture = camera.frame(poses[0], boxes, plan.weather, 0.0, 0)
    return encode_png(shrunk(picture, SHRINK))


def _viewpoint(plan: Plan, network: Network) -> StartPose:
    """Return the viewpoint of the start: the first entity's start, or its route close to the first actor ahead."""
    start = start_of(plan)
    if start is None:
        raise ValueError(f"no entity of '{plan.name}' has a place before the run")
    others = [pose for pose in plan.derived.values() if pose is not start]
    way = way_ahead(plan, network)
    if not others or min(math.dist((start.x, start.y), (one.x, one.y)) for one in others) <= CLOSE:
        return start
    for (x, y), (x_next, y_next) in pairwise(way):
        if min(math.dist((x, y), (one.x, one.y)) for one in others) <= CLOSE:
            heading = math.atan2(y_next - y, x_next - x)
            return StartPose(x=x, y=y, z=start.z, heading=heading)
    return start


def shrunk(image: NDArray[np.uint8], times: int) -> NDArray[np.uint8]:
    """Return an image (height, width, 3) reduced in size: each pixel is the mean of times x times."""
    height, width = image.shape[0] // times * times, image.shape[1] // times * times
    blocks = image[:height, :width].reshape(height // times, times, width // times, times, 3)
    means: NDArray[np.float64] = blocks.mean(axis=(1, 3))
    return (np.round(means / GREYS) * GREYS).clip(0, 255).astype(np.uint8)


def write_gallery(cards: Iterable[Card], path: Path) -> None:
    """Write the page: one file without external resources."""
    groups: dict[str, list[Card]] = {}
    for card in cards:
        groups.setdefault(card.group, []).append(card)
    held = [card for group in groups.values() for card in group]
    environment = page_environment()
    page = environment.get_template(TEMPLATE).render(
        groups=groups,
        count=len(held),
        maps=sorted({card.map for card in held}),
        causes=sorted({card.moment.cause for card in held} - {""}),
        script=page_script("gallery.js"),
    )
    write_whole(path, page)
