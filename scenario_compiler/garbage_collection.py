"""When Python's garbage collector runs: seldom in a command that ends soon, as usual in one that runs for hours."""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager

USUAL = gc.get_threshold()
"""Python's own thresholds; this module is imported before they are changed."""


def collect_seldom() -> None:
    """Turn off most rounds of the collector.

    A command keeps nearly everything that it loads until it ends, so collecting garbage frees little, and takes a
    noticeable part of the time of `validate` for one file.
    """
    gc.set_threshold(100_000, 50, 50)


@contextmanager
def paused() -> Iterator[None]:
    """Turn the collector off while a large input is read.

    Its many objects, none of which refer to each other in a circle, would start the collector again and again.
    """
    on = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if on:
            gc.enable()


def keep_loaded() -> None:
    """Exempt everything loaded so far from garbage collection, which would take 40 ms or more as the process ends.

    It is called before any code of the user's is loaded, so that the collector still closes what that leaves open.
    """
    gc.freeze()


def stay_small() -> None:
    """Restore Python's own thresholds of the garbage collector, for a command that runs until it is interrupted.

    Everything loaded so far is exempt, so that a round only looks at what runs, requests and edits have made since.
    """
    keep_loaded()
    gc.set_threshold(*USUAL)
