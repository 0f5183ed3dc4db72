"""A command that serves a page, in a process of its own."""

from __future__ import annotations

import re
import resource
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass

from websockets.sync.client import ClientConnection, connect
from websockets.typing import Origin

COARSELY = ("--perception", "ideal", "--dt", "0.1")
"""Ten pictures a second instead of 25, each of which is drawn, sent and shown."""


@dataclass
class Served:
    """A server under way: its process and the address that it printed."""

    process: subprocess.Popen[str]
    address: str

    @property
    def host(self) -> str:
        """Host and port."""
        return self.address.split("/")[2]

    def connected(self, origin: str | None = None, cookie: str = "") -> ClientConnection:
        """Return a connection to the page's socket, as a page of an origin opens it; of the server's own when None."""
        here = f"127.0.0.1:{self.host.rpartition(':')[2]}"
        named = Origin(f"http://{here}" if origin is None else origin) if origin != "" else None
        sent = {"Cookie": cookie} if cookie else None
        return connect(f"ws://{here}/socket", origin=named, additional_headers=sent, open_timeout=60)


@contextmanager
def served(
    *words: object, port: int = 0, largest: int | None = None, program: str = "scenario_compiler"
) -> Iterator[Served]:
    """Yield the server that a command starts; it is interrupted if it has not ended by itself.

    `port` 0 takes a free one; `largest` is the size of the largest file that it can write, bytes; `program` is the
    module that is started. Whatever its pages have done, it must not have written a traceback.
    """
    command = [sys.executable, "-m", program, *map(str, words), "--port", str(port)]
    with nullcontext() if largest is None else file_sizes_limited(largest):
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        assert process.stdout is not None
        found = re.fullmatch(r"(?:page|participants): (http://\S+)\n", process.stdout.readline())
        if found is None:
            raise AssertionError(process.communicate(timeout=60)[1])
        yield Served(process, found.group(1))
    finally:
        if process.poll() is None:
            process.send_signal(signal.SIGINT)
        try:
            _, err = process.communicate(timeout=90)
        except subprocess.TimeoutExpired:
            process.kill()
            raise
    assert "Traceback" not in (err or ""), err


@contextmanager
def file_sizes_limited(size: int) -> Iterator[None]:
    """Limit the sizes of files, bytes, for this process and those that it starts: larger ones are not written."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def seated(page: ClientConnection) -> None:
    """Wait until a connection drives: the server may not know yet that the one before has ended."""
    while page.recv(timeout=60) != '{"role":"driver"}':
        pass


def waited_for(state: Callable[[], bool], seconds: float = 240.0) -> None:
    """Return once a state has come that must come; TimeoutError where it has not, long after it should have."""
    end = time.monotonic() + seconds
    while not state():
        if time.monotonic() > end:
            raise TimeoutError("the state has not come")
        time.sleep(0.05)
