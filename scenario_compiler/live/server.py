"""The page of a run under way, served to a browser on this machine, or to others with a token.

A page gets pictures and what belongs to them over a WebSocket, each as one binary message: the length of the JSON text
(four bytes, big-endian), the text, the length of the view ahead, that JPEG file, and the mirror's. It tells what the
person does as JSON. Only files that are named here are served; a socket is opened only for pages of this server.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
import secrets
import socket
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import uvicorn
from pydantic import ValidationError
from starlette.applications import Starlette
from starlette.requests import HTTPConnection, Request
from starlette.responses import FileResponse, HTMLResponse, JSONResponse, PlainTextResponse, RedirectResponse, Response
from starlette.routing import Route, WebSocketRoute
from starlette.websockets import WebSocket, WebSocketDisconnect

from scenario_compiler.live.session import Drive, Picture, Session
from scenario_compiler.live.wheel import Told
from scenario_compiler.report.embedding import FOLDER as PAGES
from scenario_compiler.report.replay import MARGIN, roadmap
from scenario_compiler.report.surroundings import Window

LIVE = Path(__file__).parent / "pages"
SHARED = ("data.js", "map.js")
"""Modules of the reports' player that the page uses too."""

OWN = ("drive.js", "wheel.js", "sounds.js", "drive.css")

TYPES = {".js": "text/javascript", ".css": "text/css"}

LARGEST = 16_384
"""Bytes of a message of a page at most."""

REACH = 1500.0
"""How far around the start the map of the page reaches, m."""

LOOPBACK = ("127.0.0.1", "localhost", "::1")

COOKIE = "token"

HEADERS = {
    "Content-Security-Policy": "default-src 'self'; img-src 'self' blob: data:; style-src 'self' 'unsafe-inline'; "
    "script-src 'self' 'unsafe-inline'; connect-src 'self'; frame-ancestors 'none'",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cache-Control": "no-store",
}


@dataclass(eq=False)
class Viewer:
    """A page that is open.

    Attributes:
        socket: Its connection.
        waiting: The next picture for it; a later one takes the place of one that has not been sent.
        fresh: Set when there is one.
    """

    socket: WebSocket
    waiting: bytes | None = None
    fresh: asyncio.Event = field(default_factory=asyncio.Event)


class LiveServer:
    """Serves one scenario: one person drives, others may watch.

    Attributes:
        sessions: The runs so far, the present one last.
        app: The application.
    """

    def __init__(
        self, drive: Drive, *, host: str, port: int, watched: bool = False, token: str = "", done: Callable[[], None]
    ) -> None:
        """Prepare the pages.

        Args:
            drive: What is driven.
            host: Address that is served.
            port: Its port.
            watched: Whether nobody drives, and the run begins with the first page.
            token: What a page must know; empty on this machine alone.
            done: Called when a watched run has ended and its page has been told.
        """
        self.drive, self.watched, self.token = drive, watched, token
        self.sessions: list[Session] = []
        self._allowed = {f"{_bracketed(one)}:{port}" for one in (*LOOPBACK, host)}
        self._any_host = host in ("0.0.0.0", "::")
        self._viewers: list[Viewer] = []
        self._driver: Viewer | None = None
        self._loop: asyncio.AbstractEventLoop | None = None
        self._done = done
        self._told_once = self._described()
        self.app = Starlette(
            routes=[
                Route("/", self._page),
                Route("/shared/{name}", self._shared),
                Route("/live/{name}", self._own),
                Route("/about", self._about),
                Route("/runs/{number:int}", self._report),
                Route("/favicon.ico", lambda request: self._answer(request, lambda: Response(status_code=204))),
                WebSocketRoute("/socket", self._socket),
            ]
        )

    @property
    def session(self) -> Session | None:
        """The present run, or the last one."""
        return self.sessions[-1] if self.sessions else None

    def stop(self) -> None:
        """End the present run and wait for its files."""
        if self.session is not None and self.session.is_alive():
            self.session.stop()
            self.session.join(timeout=60.0)

    # Pages.

    def _refusal(self, connection: HTTPConnection) -> str:
        """Return why a request is refused; empty where it is not.

        A page of another site can send requests here, but neither under our name nor with the token.
        """
        if not self._any_host and connection.headers.get("host", "") not in self._allowed:
            return "this server does not serve that name"
        given = connection.query_params.get("token") or connection.cookies.get(COOKIE, "")
        if self.token and not secrets.compare_digest(given.encode(), self.token.encode()):
            return "the address lacks the token that was printed when the server started"
        origin = connection.headers.get("origin")
        if connection.scope["type"] == "websocket" and origin is None:
            return "a socket is opened by a page alone"
        if origin is not None and urlsplit(origin).netloc != connection.headers.get("host"):
            return "a page of another site asks"
        return ""

    def _answer(self, request: Request, make: Callable[[], Response]) -> Response:
        refusal = self._refusal(request)
        response = PlainTextResponse(refusal, status_code=403) if refusal else make()
        response.headers.update(HEADERS)
        return response

    def _page(self, request: Request) -> Response:
        def page() -> Response:
            if self.token and "token" in request.query_params:
                redirected = RedirectResponse("/", status_code=303)
                redirected.set_cookie(COOKIE, self.token, httponly=True, samesite="strict")
                return redirected
            return HTMLResponse((LIVE / "drive.html").read_text(encoding="utf-8"))

        return self._answer(request, page)

    def _shared(self, request: Request) -> Response:
        return self._file(request, PAGES, SHARED)

    def _own(self, request: Request) -> Response:
        return self._file(request, LIVE, OWN)

    def _file(self, request: Request, folder: Path, names: tuple[str, ...]) -> Response:
        name = request.path_params["name"]

        def file() -> Response:
            if name not in names:
                return PlainTextResponse("there is no such file", status_code=404)
            return Response((folder / name).read_bytes(), media_type=TYPES[Path(name).suffix])

        return self._answer(request, file)

    def _about(self, request: Request) -> Response:
        return self._answer(request, lambda: JSONResponse(self._told_once))

    def _described(self) -> dict[str, Any]:
        """Return what the page needs once: who is in the run, and the roads around the start."""
        plan = self.drive.plan
        starts = list(plan.derived.values())
        origin = (round(starts[0].x), round(starts[0].y)) if starts else (0, 0)
        reach = min(REACH, plan.duration * 40.0) + MARGIN
        window = Window(origin[0] - reach, origin[1] - reach, origin[0] + reach, origin[1] + reach)
        return {
            "name": plan.name,
            "summary": plan.summary,
            "watched": self.watched,
            "origin": origin,
            "writes": self.drive.folder is not None,
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
            "roadmap": roadmap(plan, self.drive.network, window, origin, ()),
        }

    def _report(self, request: Request) -> Response:
        number = request.path_params["number"]

        def report() -> Response:
            known = [one for one in self.sessions if one.number == number and one.folder is not None and one.finished]
            path = known[0].folder / "report.html" if known and known[0].folder is not None else None
            if path is None or not path.is_file():
                return PlainTextResponse("there is no report of that run", status_code=404)
            return FileResponse(path)

        answer = self._answer(request, report)
        if answer.status_code == 200:  # a report brings its modules as data URLs
            answer.headers["Content-Security-Policy"] = "default-src 'self' data: 'unsafe-inline'"
        return answer

    # The socket.

    async def _socket(self, connection: WebSocket) -> None:
        self._loop = asyncio.get_running_loop()
        if self._refusal(connection):
            await connection.close(code=1008)
            return
        await connection.accept()
        viewer = Viewer(connection)
        self._viewers.append(viewer)
        if not self.watched and self._driver is None:
            self._driver = viewer
            if self.session is not None and self.session.is_alive():
                self.session.come_back()
        await connection.send_json({"role": "driver" if viewer is self._driver else "viewer"})
        if self.watched and self.session is None:
            self._begin()
        sending = asyncio.create_task(self._send(viewer))
        try:
            with contextlib.suppress(WebSocketDisconnect, ValueError, ValidationError):
                while True:
                    await self._hear(viewer, await connection.receive_text())
        finally:
            sending.cancel()
            self._viewers.remove(viewer)
            if viewer is self._driver:
                self._driver = None
                if self.session is not None and self.session.is_alive():
                    self.session.leave()
        with contextlib.suppress(RuntimeError):
            await connection.close(code=1003)

    async def _hear(self, viewer: Viewer, text: str) -> None:
        """Do what a page says; ValueError where it is no message of ours."""
        message = json.loads(text)
        if not isinstance(message, dict):
            raise ValueError("a message is an object")
        kind = message.pop("kind", "")
        session = self.session
        if kind == "ping":
            await viewer.socket.send_json({"pong": float(message["t"]), "at": 1e3 * time.perf_counter()})
        elif viewer is not self._driver:
            raise ValueError("a page that watches tells nothing")
        elif kind == "input" and session is not None and session.wheel is not None:
            session.wheel.tell(Told.model_validate(message))
        elif kind == "start" and (session is None or not session.is_alive()):
            self._begin()
        elif kind == "stop" and session is not None:
            session.stop()
        elif kind == "latency" and session is not None:
            session.latencies += [float(one) for one in message["samples"][:200]]
            session.clock_offset = float(message["offset"])

    def _begin(self) -> None:
        self.sessions.append(Session(self.drive, len(self.sessions) + 1, self._show))
        self.sessions[-1].start()

    def _show(self, picture: Picture) -> bool:
        """Give a picture to every page; called in the thread of the run."""
        loop = self._loop
        if loop is None or loop.is_closed():
            return False
        text = json.dumps(picture.about, separators=(",", ":")).encode()
        parts = (len(text).to_bytes(4, "big"), text, len(picture.ahead).to_bytes(4, "big"))
        content = b"".join((*parts, picture.ahead, picture.mirror))
        taken = all(viewer.waiting is None for viewer in self._viewers)
        loop.call_soon_threadsafe(self._offer, content, "end" in picture.about)
        return taken

    def _offer(self, content: bytes, last: bool) -> None:
        for viewer in self._viewers:
            viewer.waiting = content
            viewer.fresh.set()
        if last and self.watched:
            asyncio.get_running_loop().call_later(1.0, self._done)

    async def _send(self, viewer: Viewer) -> None:
        with contextlib.suppress(WebSocketDisconnect, RuntimeError):
            while True:
                await viewer.fresh.wait()
                content, viewer.waiting = viewer.waiting, None
                viewer.fresh.clear()
                if content is not None:
                    await viewer.socket.send_bytes(content)


def _bracketed(host: str) -> str:
    return f"[{host}]" if ":" in host else host


class _Server(uvicorn.Server):
    """A server that says when it serves."""

    def __init__(self, config: uvicorn.Config, serves: Callable[[], None]) -> None:
        super().__init__(config)
        self._serves = serves

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Begin to serve, and say so."""
        await super().startup(sockets=sockets)
        self._serves()

    def end(self) -> None:
        """Serve no longer."""
        self.should_exit = True


def serve(
    drive: Drive, *, host: str = "127.0.0.1", port: int = 0, watched: bool = False, told: Callable[[str], None]
) -> list[Session]:
    """Serve a scenario until the program is interrupted, or until a watched run has ended; return the runs.

    Args:
        drive: What is driven.
        host: Address to serve; on another than this machine's own, pages need a token.
        port: Its port; 0 takes a free one.
        watched: Whether nobody drives.
        told: Is given the address of the page once it can be opened.

    Raises:
        OSError: The address cannot be served.
    """
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    with socket.socket(family, socket.SOCK_STREAM) as listening:
        listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listening.bind((host, port))
        listening.listen(64)
        port = listening.getsockname()[1]
        token = "" if host in LOOPBACK else secrets.token_urlsafe(16)
        server: list[_Server] = []
        live = LiveServer(drive, host=host, port=port, watched=watched, token=token, done=lambda: server[0].end())
        config = uvicorn.Config(
            live.app,
            log_level="error",
            ws_max_size=LARGEST,
            ws_max_queue=64,
            ws_per_message_deflate=False,
            timeout_graceful_shutdown=1,
            lifespan="off",
        )
        address = f"http://{_bracketed(host)}:{port}/" + (f"?token={token}" if token else "")
        server.append(_Server(config, lambda: told(address)))
        try:
            server[0].run(sockets=[listening])
        finally:
            live.stop()
        return live.sessions
