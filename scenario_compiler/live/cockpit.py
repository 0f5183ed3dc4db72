"""One driver's place: the page that drives, the pages that watch, and the current run.

A page receives pictures with data over a WebSocket. Each is one binary message: the length of a JSON text (four bytes,
big-endian), the text, the length of the view ahead, its JPEG file, and the JPEG file of the mirror. The page sends the
person's inputs as JSON.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Literal, Protocol

from pydantic import ValidationError
from starlette.websockets import WebSocket, WebSocketDisconnect, WebSocketState

from scenario_compiler.live.session import Drive, Given, Picture, Session
from scenario_compiler.live.sounds import sounds_of
from scenario_compiler.live.wheel import Told
from scenario_compiler.live.wording import WORDS
from scenario_compiler.report.replay import MARGIN, roadmap
from scenario_compiler.report.surroundings import Window

REACH = 1500.0
"""Distance around the start that the map of the page covers, m."""


GONE_AFTER = 10.0
"""Time without a message after which a page counts as gone, s; a live one sends something every second.

A page that is frozen, or whose network is down, keeps its connection open and takes no pictures.
"""

MOST_UNSHOWN = 2
"""Greatest number of pictures on their way to a page, including those that wait in the browser, so that a slow page
gets fewer pictures instead of later ones.
"""

LOOKED_EVERY = 0.05
"""Time between two checks whether all pages have been informed, s."""

NO_MESSAGE = (ValueError, ValidationError, KeyError, TypeError, RecursionError)
"""Exceptions from reading a message of a page, after which its socket is closed."""


Role = Literal["driver", "viewer"]


@dataclass(eq=False)
class Viewer:
    """An open page.

    Attributes:
        socket: Its connection.
        role: Whether it drives or watches; the page is informed before anything else is sent.
        waiting: The next message for it; a later picture replaces one that has not been sent.
        fresh: Set if there is one.
        reports: Whether the page says what it has processed, as it does from the beginning: the first pictures must not
            be sent without limit either, because a slow network would deliver all of them.
        sent: Number of sent messages with pictures.
        shown: Number of those that the page has processed.
        room: Set if another picture may be sent.
    """

    socket: WebSocket
    role: Role = "viewer"
    waiting: bytes | None = None
    fresh: asyncio.Event = field(default_factory=asyncio.Event)
    reports: bool = False
    sent: int = 0
    shown: int = 0
    room: asyncio.Event = field(default_factory=asyncio.Event)

    def count(self, *, sent: int = 0, shown: int = 0) -> None:
        """Count messages that have been sent, or that the page has processed."""
        self.sent += sent
        self.shown += shown
        if self.reports and self.sent - self.shown >= MOST_UNSHOWN:
            self.room.clear()
        else:
            self.room.set()

    def offer(self, content: bytes, *, last: bool) -> None:
        """Have a message sent; the last one of a run does not wait until the page has processed the pictures."""
        self.waiting = content
        self.fresh.set()
        if last:
            self.room.set()

    def let_drive(self) -> None:
        """Have the page informed that it drives."""
        self.role = "driver"
        self.fresh.set()
        self.room.set()

    @property
    def informed(self) -> bool:
        """Whether it has processed everything; of a page that does not report it, whether everything was sent."""
        return self.waiting is None and (not self.reports or self.shown >= self.sent)


class Begin(Protocol):
    """Makes the next run, which has not started; None if there are no more runs."""

    def __call__(self, show: Callable[[Picture], bool]) -> Session | None:
        """Return a run that shows its pictures with a function."""
        ...


class Cockpit:
    """Connects pages and runs: the first page drives, later ones watch.

    If the page that drives is gone, the next one that is open drives. So a page that is loaded again drives as before,
    even if the server learns later that the old connection has ended.

    Attributes:
        session: The present run, or the last one; None before the first.
    """

    def __init__(
        self,
        begin: Begin,
        *,
        watched: bool = False,
        may_stop: bool = True,
        ended: Callable[[], None] | None = None,
        heard: Callable[[str, dict[str, Any]], dict[str, Any] | None] | None = None,
    ) -> None:
        """Wait for pages.

        Args:
            begin: Makes the next run.
            watched: Whether nobody drives, and the run begins with the first page.
            may_stop: Whether the page that drives may end the run.
            ended: Called when a run has ended and the pages have been informed.
            heard: Receives messages of a page other than those on driving, by their kind, and returns the answer, if
                there is one; ValueError for an invalid message.
        """
        self.session: Session | None = None
        self._begins, self._watched, self._may_stop, self._ended, self._heard = begin, watched, may_stop, ended, heard
        self._viewers: list[Viewer] = []
        self._driver: Viewer | None = None
        self._loop: asyncio.AbstractEventLoop | None = None
        self._informing: asyncio.Task[None] | None = None

    @property
    def driving(self) -> bool:
        """Whether a run is under way."""
        return self.session is not None and self.session.is_alive()

    @property
    def occupied(self) -> bool:
        """Whether a page drives."""
        return self._driver is not None

    def stop(self) -> None:
        """End the present run and wait for its files."""
        if self.session is not None and self.session.is_alive():
            self.session.stop()
            self.session.join(timeout=60.0)

    async def serve(self, connection: WebSocket) -> None:
        """Serve a page until its connection ends."""
        self._loop = asyncio.get_running_loop()
        await connection.accept()
        viewer = Viewer(connection)
        self._viewers.append(viewer)
        self._seat()
        sending = asyncio.create_task(self._send(viewer))
        with contextlib.suppress(WebSocketDisconnect, asyncio.TimeoutError, *NO_MESSAGE):
            try:
                if self._watched and self.session is None:
                    self._begin()
                while True:
                    await self._hear(viewer, await asyncio.wait_for(connection.receive_text(), GONE_AFTER))
            except RuntimeError:
                if connection.application_state is WebSocketState.CONNECTED:
                    raise  # otherwise a picture that was sent found the page gone before this loop did
            finally:
                sending.cancel()
                self._viewers.remove(viewer)
                if viewer is self._driver:
                    self._driver = None
                    if self.session is not None:
                        self.session.leave()
                    self._seat()
        with contextlib.suppress(RuntimeError, WebSocketDisconnect):
            await connection.close(code=1003)

    def _seat(self) -> None:
        """Let the page that has been open for longest drive if no page does."""
        if not self._watched and self._driver is None and self._viewers:
            self._driver = self._viewers[0]
            self._driver.let_drive()
            if self.session is not None:
                self.session.come_back()

    async def _hear(self, viewer: Viewer, text: str) -> None:
        """Process a message of a page; ValueError for an invalid one."""
        message = json.loads(text)
        if not isinstance(message, dict):
            raise ValueError("a message is an object")
        kind = message.pop("kind", "")
        session = self.session
        if kind == "ping":
            await viewer.socket.send_json({"pong": float(message["t"]), "at": 1e3 * time.perf_counter()})
        elif kind == "reports":
            viewer.reports = True
        elif kind == "shown":
            viewer.count(shown=1)
        elif viewer is not self._driver:
            raise ValueError("a page that watches tells nothing")
        elif kind == "input" and session is not None and session.wheel is not None:
            session.wheel.tell(Told.model_validate(message))
        elif kind == "start":
            await self._start(viewer)
        elif kind == "stop" and session is not None and self._may_stop:
            session.stop()
        elif kind == "given" and session is not None:
            if message.pop("run") == session.number:  # a browser may begin to speak after the run, in the next one
                session.give(Given.model_validate(message))
        elif kind == "latency" and session is not None:
            session.latencies += [float(one) for one in message["samples"][:200]]
            session.clock_offset = float(message["offset"])
        elif self._heard is not None:
            said = await asyncio.to_thread(self._heard, kind, message)
            if said is not None:
                await viewer.socket.send_json(said)

    async def _start(self, viewer: Viewer) -> None:
        """Begin the next run if none is under way; the page that asks is informed if there is none or no folder."""
        if self.session is not None and self.session.ended:  # the page knows of the end before its thread is over
            await asyncio.to_thread(self.session.join)
        try:
            if not self.driving and not self._begin():
                await viewer.socket.send_json({"refused": True})
        except OSError as fault:
            await viewer.socket.send_json({"unwritten": str(fault)})

    def _begin(self) -> bool:
        """Begin the next run; return whether there is one."""
        begun = self._begins(self._show)
        if begun is None:
            return False
        self.session = begun
        begun.start()
        return True

    def _show(self, picture: Picture) -> bool:
        """Give a picture to every page; called in the thread of the run."""
        assert self._loop is not None
        text = json.dumps(picture.about, separators=(",", ":")).encode()
        parts = (len(text).to_bytes(4, "big"), text, len(picture.ahead).to_bytes(4, "big"))
        content = b"".join((*parts, picture.ahead, picture.mirror))
        taken = all(viewer.waiting is None for viewer in self._viewers)
        try:
            self._loop.call_soon_threadsafe(self._offer, content, "end" in picture.about)
        except RuntimeError:  # the server has ended, and its loop is closed
            return False
        return taken

    def _offer(self, content: bytes, last: bool) -> None:
        for viewer in self._viewers:
            viewer.offer(content, last=last)
        if last and self._ended is not None:
            self._informing = asyncio.create_task(self._inform(self._ended))

    async def _inform(self, ended: Callable[[], None]) -> None:
        """Call a function when each page has been informed of the end of a run, or is gone."""
        while not all(viewer.informed for viewer in self._viewers):
            await asyncio.sleep(LOOKED_EVERY)
        ended()

    async def _send(self, viewer: Viewer) -> None:
        with contextlib.suppress(WebSocketDisconnect, RuntimeError):
            role: Role | None = None
            while True:
                if viewer.role != role:
                    role = viewer.role
                    await viewer.socket.send_json({"role": role})
                await viewer.fresh.wait()
                viewer.fresh.clear()
                content, viewer.waiting = viewer.waiting, None
                if content is not None:
                    await viewer.socket.send_bytes(content)
                    viewer.count(sent=1)
                    await viewer.room.wait()


def described(drive: Drive, *, watched: bool = False) -> dict[str, Any]:
    """Return the data that a page needs only once: the entities of the run, and the roads around the start."""
    plan = drive.plan
    starts = list(plan.derived.values())
    origin = (round(starts[0].x), round(starts[0].y)) if starts else (0, 0)
    reach = min(REACH, plan.duration * 40.0) + MARGIN
    window = Window(origin[0] - reach, origin[1] - reach, origin[0] + reach, origin[1] + reach)
    return {
        "summary": plan.summary,
        "watched": watched,
        "words": WORDS[drive.language],
        "sounds": sounds_of(plan),
        "origin": origin,
        "writes": drive.folder is not None,
        "entities": [
            {
                "id": one.id,
                "length": one.vehicle.length,
                "width": one.vehicle.width,
                "center": one.vehicle.center,
                "category": one.vehicle.category,
            }
            for one in plan.entities
        ],
        "roadmap": roadmap(plan, drive.network, window, origin, ()),
    }
