"""How much work code does, counted in calls of functions: the same on a fast machine, a slow one and a busy one."""

from __future__ import annotations

import cProfile
from collections.abc import Callable


def calls_of(work: Callable[[], object]) -> int:
    """Return how many calls of functions, of Python and of C, `work` makes while it runs."""
    profile = cProfile.Profile()
    profile.enable()
    try:
        work()
    finally:
        profile.disable()
    return sum(int(entry.callcount) for entry in profile.getstats())
