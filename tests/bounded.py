"""A limit on the time of something that might never end."""

from __future__ import annotations

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import NoReturn


@contextmanager
def bounded(seconds: int, overdue: Callable[[], NoReturn]) -> Iterator[None]:
    """Call `overdue`, which raises, if the context is still open after some seconds."""

    def stop(number: int, frame: FrameType | None) -> None:
        del number, frame
        overdue()

    before = signal.signal(signal.SIGALRM, stop)
    signal.alarm(seconds)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)
