"""The two ports of the protocol: calls as msgpack on the first, streams of sensors on the second.

A message that breaks the protocol ends its connection, with one line in the log; it has no other effect.
"""

from __future__ import annotations

import asyncio
import struct
from collections import deque
from collections.abc import Awaitable, Callable
from typing import Any

import msgpack

REQUEST, RESPONSE, NOTIFICATION = 0, 1, 2
"""Kinds of messages in msgpack-rpc."""

MOST_BYTES = 64 << 20
"""Greatest size of a request, bytes."""

LONGEST_ARRAY = 1 << 20
"""Greatest number of elements of an array; maps and extensions are not part of the protocol."""

MOST_CONNECTIONS = 256
"""Greatest number of connections to a port at the same time."""

WAITING = 4096
"""Greatest number of unanswered requests of a connection; at this number it is not read further."""

SLOW = 128 << 20
"""Backlog of a listener from which messages to it are left out, bytes."""

LINGERING = 1.0
"""Time for which a connection to an ended stream is kept, s: a client that has not stopped its sensor comes again as
soon as it ends.
"""

PATIENCE = 4 << 20
"""Backlog of a listener from which a tick waits for it, bytes."""

MOST_MISSED = 1000
"""Greatest number of missing streams that are logged."""

SIZE = struct.Struct("<I")

OVERTAKING = frozenset(("version", "get_episode_info", "get_sensor_token"))
"""Calls with which a client joins the stream of snapshots. They are answered at once, also while their connection
waits for the answer to another call: one of its Traffic Manager, which runs in a thread of its own.
"""

ASIDE = frozenset(("get_episode_settings", "destroy_actor"))
"""Calls whose answers the others of their connection do not wait for: a Traffic Manager is held with the first, and the
second waits for that.
"""

Answer = Callable[[str, list[Any]], Any]
"""Answers a call: takes its name and arguments, returns the response, or an awaitable of it."""


class Calls(asyncio.Protocol):
    """A client's connection for calls: they are answered in order, one after the other."""

    def __init__(self, answer: Answer, open_ones: set[asyncio.BaseTransport], log: Callable[[str], None]) -> None:
        """Store the handler of calls, the set of all connections, and the function that logs faults."""
        self._answer, self._open, self._log = answer, open_ones, log
        self._transport: asyncio.Transport | None = None
        self._unpacker = msgpack.Unpacker(
            raw=False,
            unicode_errors="surrogateescape",
            max_buffer_size=MOST_BYTES,
            max_array_len=LONGEST_ARRAY,
            max_map_len=0,
            max_ext_len=0,
        )
        self._packer = msgpack.Packer(use_bin_type=True, unicode_errors="surrogateescape")
        self._waiting: deque[Any] = deque()
        self._task: asyncio.Task[None] | None = None
        self._aside: set[asyncio.Task[None]] = set()

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Accept a connection, unless there are too many."""
        assert isinstance(transport, asyncio.Transport)
        self._transport = transport
        if len(self._open) >= MOST_CONNECTIONS:
            self._refuse(f"there are {MOST_CONNECTIONS} connections already")
            return
        self._open.add(transport)

    def connection_lost(self, exc: Exception | None) -> None:
        """Drop the unanswered calls."""
        del exc
        if self._transport is not None:
            self._open.discard(self._transport)
        self._waiting.clear()
        self._transport = None

    def data_received(self, data: bytes) -> None:
        """Answer the calls that have arrived completely."""
        try:
            self._unpacker.feed(data)
            for message in self._unpacker:
                if self._task is not None and _overtakes(message):
                    self._take_up(message)
                else:
                    self._waiting.append(message)
        except (msgpack.UnpackException, ValueError) as fault:
            self._refuse(f"the message is not msgpack: {type(fault).__name__} {fault}".strip())
            return
        except RecursionError:
            self._refuse("the message is nested too deeply")
            return
        if self._task is None:
            self._go_on()
        elif len(self._waiting) > WAITING and self._transport is not None:
            self._transport.pause_reading()

    def _refuse(self, why: str) -> None:
        if self._transport is None:
            return
        peer = self._transport.get_extra_info("peername")
        self._log(f"connection of {peer[0]}:{peer[1]} ended: {why}" if peer else f"connection ended: {why}")
        self._waiting.clear()
        self._transport.abort()

    def _go_on(self) -> None:
        """Answer the waiting calls in order, until one of them has to wait for its answer."""
        while self._waiting and self._transport is not None and self._task is None:
            self._take_up(self._waiting.popleft())

    def _take_up(self, message: Any) -> None:
        """Answer a call, now or when its answer is there."""
        if type(message) is not list or len(message) not in (3, 4) or message[0] not in (REQUEST, NOTIFICATION):
            self._refuse("the message is not a call")
            return
        if message[0] == NOTIFICATION:
            number, (name, arguments) = None, message[1:3]
        else:
            number, name, arguments = message[1], message[2], message[-1]
        if len(message) == (4 if message[0] == NOTIFICATION else 3) or type(number) not in (int, type(None)):
            self._refuse("the message is not a call")
            return
        if type(name) is not str or type(arguments) is not list:
            self._refuse("the message is not a call")
            return
        found = self._answer(name, arguments)
        if not isinstance(found, Awaitable):
            self._send(number, found)
        elif name in ASIDE:
            aside = asyncio.ensure_future(self._answer_aside(found, number))
            self._aside.add(aside)
            aside.add_done_callback(self._aside.discard)
        else:
            self._task = asyncio.ensure_future(self._wait_for(found, number))

    async def _answer_aside(self, found: Awaitable[Any], number: int | None) -> None:
        self._send(number, await found)

    async def _wait_for(self, found: Awaitable[Any], number: int | None) -> None:
        try:
            self._send(number, await found)
        finally:
            self._task = None
        if self._transport is not None and not self._transport.is_closing():
            self._transport.resume_reading()
            self._go_on()

    def _send(self, number: int | None, found: Any) -> None:
        if number is not None and self._transport is not None:
            self._transport.write(self._packer.pack([RESPONSE, number, None, found]))


def _overtakes(message: Any) -> bool:
    return type(message) is list and len(message) == 4 and type(message[2]) is str and message[2] in OVERTAKING


class Streams:
    """The listeners of each stream."""

    def __init__(self, knows: Callable[[int], bool], log: Callable[[str], None]) -> None:
        """Store a function that returns whether a stream exists, and the function that logs faults."""
        self._knows, self._log = knows, log
        self._listeners: dict[int, set[asyncio.Transport]] = {}
        self._arrivals: dict[int, asyncio.Event] = {}
        self._joins: dict[int, asyncio.Event] = {}
        self._missed: set[int] = set()
        self.open: set[asyncio.BaseTransport] = set()

    def connection(self) -> Stream:
        """Return a new protocol for a connection."""
        return Stream(self, self._log)

    def heard(self, number: int) -> bool:
        """Return whether somebody listens to a stream."""
        return number in self._listeners

    def announce(self, number: int) -> None:
        """Note that a client will connect to a stream next."""
        if number not in self._listeners:
            self._arrivals.setdefault(number, asyncio.Event())

    async def wait_for_announced(self, seconds: float) -> None:
        """Wait for at most some seconds until all expected listeners have connected."""
        waiting = [asyncio.ensure_future(event.wait()) for event in self._arrivals.values()]
        if waiting:
            _, late = await asyncio.wait(waiting, timeout=seconds)
            for one in late:
                one.cancel()
            self._arrivals.clear()

    async def wait_for_another(self, number: int, seconds: float) -> None:
        """Wait for at most some seconds until one more listener has connected to a stream."""
        event = self._joins.setdefault(number, asyncio.Event())
        await asyncio.wait([asyncio.ensure_future(event.wait())], timeout=seconds)
        event.set()  # lets the task end
        self._joins.pop(number, None)

    @property
    def announced(self) -> bool:
        """Whether a listener is expected."""
        return bool(self._arrivals)

    def join(self, number: int, transport: asyncio.Transport) -> bool:
        """Let a connection listen to a stream; return whether the stream exists."""
        if not self._knows(number):
            return False
        self._listeners.setdefault(number, set()).add(transport)
        arrived = self._arrivals.pop(number, None)
        for event in (arrived, self._joins.get(number)):
            if event is not None:
                event.set()
        return True

    def note_missing(self, number: int) -> None:
        """Log that a client asked for a missing stream, once for each stream."""
        if number not in self._missed and len(self._missed) < MOST_MISSED:
            self._missed.add(number)
            self._log(f"stream {number} does not exist")

    def leave(self, transport: asyncio.Transport) -> None:
        """Forget a connection."""
        for number in [one for one, listening in self._listeners.items() if transport in listening]:
            self._listeners[number].discard(transport)
            if not self._listeners[number]:
                del self._listeners[number]

    def close(self, number: int) -> None:
        """End a stream and its connections."""
        for transport in self._listeners.pop(number, set()):
            transport.close()

    def send(self, number: int, message: bytes) -> None:
        """Send a message to all listeners except those that are too far behind."""
        size = SIZE.pack(len(message))
        for transport in self._listeners.get(number, ()):
            if transport.get_write_buffer_size() < SLOW:
                transport.writelines((size, message))

    @property
    def behind(self) -> bool:
        """Whether a listener is so far behind that a tick should wait."""
        return any(
            transport.get_write_buffer_size() > PATIENCE
            for listening in self._listeners.values()
            for transport in listening
        )


class Stream(asyncio.Protocol):
    """A client's connection for one stream: it sends the stream's number and then only listens."""

    def __init__(self, streams: Streams, log: Callable[[str], None]) -> None:
        """Store the streams, and the function that logs faults."""
        self._streams, self._log = streams, log
        self._transport: asyncio.Transport | None = None
        self._begun = b""
        self._joined = False

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Accept a connection, unless there are too many."""
        assert isinstance(transport, asyncio.Transport)
        self._transport = transport
        if len(self._streams.open) >= MOST_CONNECTIONS:
            self._refuse(f"there are {MOST_CONNECTIONS} connections already")
            return
        self._streams.open.add(transport)

    def data_received(self, data: bytes) -> None:
        """Read the number of the stream; no more data may follow."""
        if self._transport is None or self._transport.is_closing():
            return
        self._begun += data[: SIZE.size + 1]
        if self._joined or len(self._begun) > SIZE.size:
            self._refuse("a listener may only send the number of its stream")
        elif len(self._begun) == SIZE.size:
            self._joined = self._streams.join(SIZE.unpack(self._begun)[0], self._transport)
            if not self._joined:
                self._turn_away(SIZE.unpack(self._begun)[0])

    def _turn_away(self, number: int) -> None:
        """End the connection after a while; the log has one line for each missing stream that was asked for."""
        self._streams.note_missing(number)
        asyncio.get_running_loop().call_later(LINGERING, self._end)

    def _end(self) -> None:
        if self._transport is not None:
            self._transport.abort()

    def _refuse(self, why: str) -> None:
        if self._transport is not None:
            peer = self._transport.get_extra_info("peername")
            self._log(f"stream of {peer[0]}:{peer[1]} ended: {why}" if peer else f"stream ended: {why}")
            self._transport.abort()

    def connection_lost(self, exc: Exception | None) -> None:
        """Stop listening."""
        del exc
        if self._transport is not None:
            self._streams.open.discard(self._transport)
            self._streams.leave(self._transport)
        self._transport = None
