"""The page of `drive` and of `run --watch`, served to a browser on this machine, or to others with a token."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import FileResponse, HTMLResponse, JSONResponse, PlainTextResponse, Response
from starlette.routing import Route, WebSocketRoute
from starlette.websockets import WebSocket

from scenario_compiler.live.cockpit import Cockpit, described
from scenario_compiler.live.session import Drive, Picture, Session
from scenario_compiler.live.web import LIVE, Door, Server, address_of, listening_at, new_token, server_of
from scenario_compiler.report.templates import page_environment


class LiveServer:
    """Serves one scenario: one person drives, others may watch.

    Attributes:
        sessions: The runs so far, the present one last.
        app: The application.
    """

    def __init__(self, drive: Drive, door: Door, *, watched: bool = False, done: Callable[[], None]) -> None:
        """Prepare the pages.

        Args:
            drive: What is driven; `folder` is where the folders of the runs come to lie.
            door: Who is let in.
            watched: Whether nobody drives, and the run begins with the first page.
            done: Called when a watched run has ended and its page knows.
        """
        self.drive, self.door = drive, door
        self.sessions: list[Session] = []
        self.cockpit = Cockpit(self._next, watched=watched, ended=done if watched else None)
        self._told_once = described(drive, watched=watched)
        self.app = Starlette(
            routes=[
                Route("/", lambda request: door.entered(request, lambda: HTMLResponse(drive_page()))),
                Route("/shared/{name}", door.shared),
                Route("/live/{name}", door.own),
                Route("/about", lambda request: door.answer(request, lambda: JSONResponse(self._told_once))),
                Route("/runs/{number:int}", self._report),
                Route("/favicon.ico", lambda request: door.answer(request, lambda: Response(status_code=204))),
                WebSocketRoute("/socket", self._socket),
            ]
        )

    def stop(self) -> None:
        """End the present run and wait for its files."""
        self.cockpit.stop()

    def _next(self, show: Callable[[Picture], bool]) -> Session:
        number = len(self.sessions) + 1
        folder = None if self.drive.folder is None else self.drive.folder / f"drive-{number:03d}"
        drive = replace(self.drive, seed=self.drive.seed + number - 1, folder=folder)
        self.sessions.append(Session(drive, show, number))
        return self.sessions[-1]

    def _report(self, request: Request) -> Response:
        number = request.path_params["number"]

        def report() -> Response:
            known = [one for one in self.sessions if one.number == number and one.folder is not None and one.finished]
            path = known[0].folder / "report.html" if known and known[0].folder is not None else None
            if path is None or not path.is_file():
                return PlainTextResponse("there is no report of that run", status_code=404)
            return FileResponse(path)

        answer = self.door.answer(request, report)
        if answer.status_code == 200:  # a report brings its modules as data URLs
            answer.headers["Content-Security-Policy"] = "default-src 'self' data: 'unsafe-inline'"
        return answer

    async def _socket(self, connection: WebSocket) -> None:
        if self.door.refusal(connection):
            await connection.close(code=1008)
        else:
            await self.cockpit.serve(connection)


def drive_page(base: str = "") -> str:
    """Return the page at the wheel; `base` is what the paths of its data and its socket begin with."""
    return page_environment(LIVE).get_template("drive.html.jinja").render(base=base)


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
    with listening_at(host, port) as listening:
        door = Door(host, listening.getsockname()[1], new_token(host))
        server: list[Server] = []
        live = LiveServer(drive, door, watched=watched, done=lambda: server[0].end())
        server.append(server_of(live.app, lambda: told(address_of(door))))
        try:
            server[0].run(sockets=[listening])
        finally:
            live.stop()
        return live.sessions
