"""The reliability of the confidence: figures of observations, leaving out one map after the other from the fit."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from scenario_compiler.perception.calibration.bank import BANK
from scenario_compiler.perception.calibration.collect import RIGHT, Looks, as_used
from scenario_compiler.perception.calibration.fit import Reliability, fit_confidence, largest_by_chance, reliability
from scenario_compiler.perception.calibration.gather import Gathered
from scenario_compiler.perception.confidence import Confidence

Mask = NDArray[np.bool_]

OUTPUTS = ("geometry", "paint", "both")

SURE, CONFIDENT, FAR_OFF = 0.8, 0.6, 1.0
"""Confidences from which a side counts as sure and as confident, and the error from which one is far off, m."""

REMEMBERING = 3
"""Index of the image of a clip from which the memory has settled."""

FITTED = (0, 2, 4, 5)
"""Images of a clip that are used for the fit; neighbouring ones are redundant."""

FIRST_WEIGHT = 3.0
"""Weight of a clip's first image in the fit: it is seen without memory, and counts like the three seen with memory."""

DRAWN_WEIGHT = 5.0
"""Weight of a look at a drawn situation: there are few, and they have bends and grades that maps lack."""


@dataclass(frozen=True)
class Worth:
    """The reliability of the outputs over some observations.

    Attributes:
        name: Name of the observations.
        outputs: For each of `OUTPUTS`.
        sure: Share of the observations with a confidence above `SURE`.
        wrong: Share of those with an error above 0.25 m; NaN if there are none.
        far_off: Share of those with an error above 1 m; NaN if there are none.
        by_chance: Largest error of a bin that chance alone explains (see `largest_by_chance`).
    """

    name: str
    outputs: tuple[Reliability, ...]
    sure: float
    wrong: float
    far_off: float
    by_chance: float


@dataclass(frozen=True)
class Asked:
    """Result of a situation of the bank.

    Attributes:
        name: The situation's.
        right: Share of the boundaries that are right.
        confidence: Mean confidence.
        misled: Share of the boundaries that are confident and wrong.
    """

    name: str
    right: float
    confidence: float
    misled: float


@dataclass(frozen=True)
class Figures:
    """All figures.

    Attributes:
        single: Single images of each map.
        driving: Images of each map that were seen with memory.
        conditions: Images of all maps with memory, by condition.
        bank: The bank.
        left_out: Maps that were not part of the fit that was applied to them.
    """

    single: tuple[Worth, ...]
    driving: tuple[Worth, ...]
    conditions: tuple[Worth, ...]
    bank: tuple[Asked, ...]
    left_out: tuple[str, ...]


def fitted(gathered: Gathered, without: Collection[str] = ()) -> Confidence:
    """Return the confidence fitted to all observations except those on some maps."""
    parts = [looks for name, looks in gathered.maps.items() if name not in without]
    of_maps = Looks.joined(parts)
    chosen = of_maps.only(np.isin(of_maps.condition("number"), FITTED) & (of_maps.clip < gathered.clips))
    return fitted_to(chosen, gathered.drawn, FIRST_WEIGHT)


def fitted_to(of_maps: Looks, drawn: Looks, first_weight: float = 1.0) -> Confidence:
    """Return the confidence fitted to looks at maps and at drawn situations; `first_weight` is that of first images."""
    looks = Looks.joined([of_maps, drawn])
    of_images = np.where(of_maps.condition("number") == 0, first_weight, 1.0)
    weight = np.concatenate([of_images, np.full(len(drawn.error), DRAWN_WEIGHT)])
    return fit_confidence(looks.rows, looks.labels, weight)


def judged(looks: Looks, confidence: Confidence) -> Looks:
    """Return the observations with the probabilities of another confidence; the memory is unchanged."""
    return replace(looks, p=as_used(confidence(looks.rows), looks.worth))


def figures_of(gathered: Gathered, left_out: Sequence[str], confidence: Confidence | None) -> Figures:
    """Return the figures.

    Args:
        gathered: The observations.
        left_out: Maps that the tables contain, seen with a confidence that was fitted to others; empty for all maps.
        confidence: The confidence for everything else; None for the detector's own.
    """
    chosen = {name: looks for name, looks in gathered.maps.items() if not left_out or name in left_out}
    if confidence is not None and not left_out:
        chosen = {name: judged(looks, confidence) for name, looks in chosen.items()}
    together = Looks.joined(list(chosen.values()))
    chosen["all"] = together
    numbers = {name: looks.condition("number") for name, looks in chosen.items()}
    with_memory = together.only(numbers["all"] >= REMEMBERING)
    bank = gathered.bank if confidence is None else tuple(judged(looks, confidence) for looks in gathered.bank)
    return Figures(
        single=tuple(worth(name, looks.only(numbers[name] == 0)) for name, looks in chosen.items()),
        driving=tuple(worth(name, looks.only(numbers[name] >= REMEMBERING)) for name, looks in chosen.items()),
        conditions=tuple(
            worth(name, with_memory.only(mask)) for name, mask in conditions_of(with_memory) if mask.any()
        ),
        bank=tuple(_asked(one.name, looks) for one, looks in zip(BANK, bank, strict=True)),
        left_out=tuple(left_out),
    )


def worth(name: str, looks: Looks) -> Worth:
    """Return the reliability of the outputs over observations."""
    labels, sure = looks.labels, looks.p[:, 2] > SURE
    wrong, far_off = (
        float((looks.error[sure] >= limit).mean()) if sure.any() else math.nan for limit in (RIGHT, FAR_OFF)
    )
    return Worth(
        name,
        tuple(reliability(looks.p[:, k], labels[:, k]) for k in range(len(OUTPUTS))),
        float(sure.mean()),
        wrong,
        far_off,
        largest_by_chance(looks.p[:, 2], labels[:, 2], looks.clip),
    )


def conditions_of(looks: Looks) -> list[tuple[str, Mask]]:
    """Return conditions by name, with the observations to which they apply."""
    curvature, leader = looks.condition("curvature"), looks.condition("leader")
    contrast, sigma, pitch = looks.condition("contrast"), looks.condition("sigma"), np.abs(looks.condition("pitch"))
    junction = looks.condition("junction") > 0.0
    return [
        ("outside junctions", ~junction),
        ("junction within 25 m", junction),
        ("radius over 200 m", ~junction & (curvature < 1 / 200)),
        ("radius 60 to 200 m", ~junction & (curvature >= 1 / 200) & (curvature < 1 / 60)),
        ("radius 15 to 60 m", ~junction & (curvature >= 1 / 60)),
        ("dry", contrast > 0.95),
        ("wet or rain", (contrast > 0.3) & (contrast <= 0.95)),
        ("hard rain towards a low sun", contrast <= 0.3),
        ("noise over 20 grey levels", sigma > 20.0),
        ("body pitched by over 0.5 degrees", pitch > np.radians(0.5)),
        ("leader at 6 to 12 m", leader < 12.0),
        ("leader at 12 to 25 m", (leader >= 12.0) & (leader < 26.0)),
        ("truck beside", looks.condition("beside") > 0.0),
    ]


def _asked(name: str, looks: Looks) -> Asked:
    wrong = looks.error >= RIGHT
    misled = wrong & (looks.p[:, 2] > CONFIDENT)
    return Asked(name, float(1.0 - wrong.mean()), float(looks.p[:, 2].mean()), float(misled.mean()))
