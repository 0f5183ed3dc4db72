"""A page of a library's conflicts: a picture of each start, what happens, where it comes from, how to run it."""

from __future__ import annotations

import base64
import math
from collections.abc import Iterable
from dataclasses import dataclass
from html import escape
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from scenario_compiler.outputs import write_whole
from scenario_compiler.plan.model import Plan, StartPose
from scenario_compiler.plan.painted import lines_beside
from scenario_compiler.report.preview import start_of, way_ahead
from scenario_compiler.roads.network import Network
from scenario_compiler.roads.positions import Pose

if TYPE_CHECKING:
    from numpy.typing import NDArray

SHRINK = 3
"""How many pixels of the driver's view, in each direction, become one of a thumbnail."""


STYLE = """
:root { color-scheme: light dark; }
body { font: 15px/1.5 system-ui, sans-serif; margin: 0 auto; max-width: 1180px; padding: 1.5rem; }
h1 { font-size: 1.5rem; } h2 { font-size: 1.1rem; margin-top: 2.2rem; }
ul { display: grid; gap: 1.2rem; grid-template-columns: repeat(auto-fill, minmax(320px, 1fr)); }
ul { list-style: none; padding: 0; }
li { border: 1px solid #8886; border-radius: 8px; overflow: hidden; }
img { aspect-ratio: 2; display: block; height: auto; width: 100%; }
div { padding: .6rem .8rem .8rem; } h3 { font-size: 1rem; margin: 0; } p { margin: .2rem 0; }
.quiet { font-size: .85rem; opacity: .75; } code { font-size: .8rem; overflow-wrap: anywhere; }
"""


CLOSE = 32.0
"""Distance from which the first actor ahead is seen, m; what is farther at the start is looked at from the way."""

GREYS = 4.0
"""Steps that a thumbnail's grey levels are rounded to, so that its file is small."""


@dataclass(frozen=True, slots=True)
class Card:
    """What the gallery shows of one conflict.

    Attributes:
        group: Heading that it stands under.
        name: Its name.
        summary: What happens.
        source: Where the situation comes from.
        target: FILE#name that runs it.
        picture: The start, as a PNG file.
    """

    group: str
    name: str
    summary: str
    source: str
    target: str
    picture: bytes


def start_picture(plan: Plan, network: Network) -> bytes:
    """Return the start as a driver on the way to it sees it, as a small PNG file; equal plans give equal bytes.

    Raises:
        ValueError: No entity has a place before the run.
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
    """Return where the start is seen from: the first entity's start, or its way close to the first actor ahead."""
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
    """Return an image (height, width, 3) at a fraction of its size: each pixel the mean of times x times."""
    height, width = image.shape[0] // times * times, image.shape[1] // times * times
    blocks = image[:height, :width].reshape(height // times, times, width // times, times, 3)
    means: NDArray[np.float64] = blocks.mean(axis=(1, 3))
    return (np.round(means / GREYS) * GREYS).clip(0, 255).astype(np.uint8)


def write_gallery(cards: Iterable[Card], path: Path, *, title: str = "Conflicts") -> None:
    """Write the page: one file that needs nothing from outside."""
    groups: dict[str, list[Card]] = {}
    for card in cards:
        groups.setdefault(card.group, []).append(card)
    count = sum(map(len, groups.values()))
    body = "".join(
        f"<h2>{escape(group)}</h2>\n<ul>\n{''.join(map(_item, held))}</ul>\n" for group, held in groups.items()
    )
    write_whole(
        path,
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escape(title)}</title>\n<style>{STYLE}</style>\n</head>\n<body>\n"
        f"<h1>{escape(title)} ({count})</h1>\n{body}</body>\n</html>\n",
    )


def _item(card: Card) -> str:
    image = base64.b64encode(card.picture).decode()
    return (
        f'<li><img loading="lazy" width="320" height="160" alt="Start of {escape(card.name)}" '
        f'src="data:image/png;base64,{image}">'
        f"<div><h3>{escape(card.name)}</h3><p>{escape(card.summary)}.</p>"
        f'<p class="quiet">{escape(card.source)}</p><code>{escape(card.target)}</code></div></li>\n'
    )
