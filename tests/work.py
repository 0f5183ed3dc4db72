"""Counts the lines of Python that code executes, which do not depend on the machine's speed or load."""

from __future__ import annotations

import sys
from collections.abc import Callable
from types import FrameType
from typing import Any, TypeVar

T = TypeVar("T")


def counted(work: Callable[[], T]) -> tuple[T, int]:
    """Return what `work` returns, and how many lines of Python were run for it.

    A line counts as often as it is run, and a comprehension once for each element. What a function written in C does
    inside is not counted.
    """
    lines = 0

    def line(_frame: FrameType, event: str, _argument: Any) -> Callable[..., Any]:
        nonlocal lines
        if event == "line":
            lines += 1
        return line

    before = sys.gettrace()
    sys.settrace(line)
    try:
        result = work()
    finally:
        sys.settrace(before)
    return result, lines
