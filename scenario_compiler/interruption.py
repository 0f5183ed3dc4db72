"""Turns Ctrl-C and SIGTERM into one interruption of the program, which its worker processes ignore."""

from __future__ import annotations

import contextlib
import signal
import sys
import threading
from collections.abc import Iterator
from dataclasses import dataclass
from types import FrameType, ModuleType
from typing import Any


def _interrupt(number: int, frame: FrameType | None) -> None:
    del number, frame
    raise KeyboardInterrupt


def raise_when_ended() -> None:
    """Make SIGTERM a KeyboardInterrupt like Ctrl-C, and repeat interruptions that Python would suppress."""
    signal.signal(signal.SIGTERM, _interrupt)
    sys.unraisablehook = _raise_again


def _raise_again(fault: Any) -> None:
    """Interrupt the program again after Python has suppressed an interruption, in a destructor or a callback."""
    if fault.exc_type is not None and issubclass(fault.exc_type, KeyboardInterrupt):
        threading.Timer(0.01, signal.raise_signal, [signal.SIGINT]).start()
    else:
        sys.__unraisablehook__(fault)


def ignore_from_now_on() -> None:
    """Ignore further interruptions, because the program is ending."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.SIG_IGN)


@contextlib.contextmanager
def left_to_this_process() -> Iterator[None]:
    """Start processes that ignore Ctrl-C, which a terminal sends to all processes; this process ends them.

    An interruption in the meantime is delayed until the context ends. A new process inherits the blocked SIGINT, but no
    handler.

    The processes run only functions of this package, and do not import the script that started this one: a script of a
    user without `if __name__ == "__main__"` would run in each of them from its beginning.
    """
    with put_off(), _no_script():
        if sys.platform == "win32" or threading.current_thread() is not threading.main_thread():
            yield
            return
        from multiprocessing import resource_tracker

        resource_tracker.ensure_running()  # it unblocks SIGINT when it starts, so it is started first
        before = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
        try:
            yield
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextlib.contextmanager
def _no_script() -> Iterator[None]:
    """Hide the script of this process from `multiprocessing`, which has new processes import it."""
    script = sys.modules["__main__"]
    sys.modules["__main__"] = ModuleType("__main__")
    try:
        yield
    finally:
        sys.modules["__main__"] = script


@dataclass
class Interruption:
    """Whether the program has been interrupted."""

    came: bool = False


@contextlib.contextmanager
def noted() -> Iterator[Interruption]:
    """Note an interruption instead of raising it, for work that looks for it and ends early; a second one is raised."""
    noted_one = Interruption()
    if threading.current_thread() is not threading.main_thread():
        yield noted_one
        return

    def note(number: int, frame: FrameType | None) -> None:
        if noted_one.came:
            _interrupt(number, frame)
        noted_one.came = True

    before = {number: signal.signal(number, note) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield noted_one
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


@contextlib.contextmanager
def ended_with_this() -> Iterator[None]:
    """If the user interrupts, end the processes that were started in the context, because they ignore Ctrl-C.

    They are those that `left_to_this_process` started. In a pool of processes, this context is the inner one.
    """
    from multiprocessing import active_children

    before = set(active_children())
    try:
        yield
    except (KeyboardInterrupt, GeneratorExit):
        for process in set(active_children()) - before:
            process.kill()
        raise


@contextlib.contextmanager
def put_off() -> Iterator[None]:
    """Delay an interruption until the context ends, for short tasks that must be completed."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    came: list[int] = []
    before = {
        number: signal.signal(number, lambda one, _: came.append(one)) for number in (signal.SIGINT, signal.SIGTERM)
    }
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        if came:
            signal.raise_signal(came[0])
