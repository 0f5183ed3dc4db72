"""The page of `drive` and of `run --watch`, served to a browser on this machine, or to others with a token."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import FileResponse, HTMLResponse, JSONResponse, PlainTextResponse, Response
from starlette.routing import Route, WebSocketRoute
from starlette.websockets import WebSocket

from scenario_compiler.live.cockpit import Cockpit, described
from scenario_compiler.live.session import Drive, Picture, Session
from scenario_compiler.live.web import LIVE, Door, Server, address_of, listening_at, new_token, server_of
from scenario_compiler.live.wording import WORDS
from scenario_compiler.report.run import Run
from scenario_compiler.report.templates import page_environment
from scenario_compiler.vocabulary.takeover import Language


class LiveServer:
    """Serves one scenario: one person drives, others may watch.

    Attributes:
        app: The application.
    """

    def __init__(
        self,
        drive: Drive,
        door: Door,
        *,
        watched: bool = False,
        kept: Callable[[Run], None] | None = None,
        done: Callable[[], None],
    ) -> None:
        """Prepare the pages.

        Args:
            drive: The runs; their folders are put into `folder`.
            door: Controls access.
            watched: Whether nobody drives, and the run begins with the first page.
            kept: Receives each run when it has ended; the server keeps none of them.
            done: Called when a watched run has ended and its page has been informed.
        """
        self.drive, self.door = drive, door
        self._runs, self._earlier = 0, 0 if drive.folder is None else _greatest_number(drive.folder)
        self._reported: set[int] = set()
        self._kept = kept
        self.cockpit = Cockpit(self._next, watched=watched, ended=done if watched else None)
        self._told_once = described(drive, watched=watched)
        page = drive_page(drive.plan.name, drive.language)
        self.app = Starlette(
            routes=[
                Route("/", lambda request: door.entered(request, lambda: HTMLResponse(page))),
                Route("/shared/{name}", door.shared),
                Route("/live/{name}", door.own),
                Route("/sounds/{name:path}", door.sound),
                Route("/about", lambda request: door.answer(request, lambda: JSONResponse(self._told_once))),
                Route("/runs/{number:int}", self._report),
                Route("/favicon.ico", lambda request: door.answer(request, lambda: Response(status_code=204))),
                WebSocketRoute("/socket", self._socket),
            ]
        )

    def stop(self) -> None:
        """End the present run and wait for its files."""
        self.cockpit.stop()

    @property
    def ended(self) -> str:
        """Description of how the last run ended; empty if there was none."""
        return "" if self.cockpit.session is None else self.cockpit.session.ended

    def _next(self, show: Callable[[Picture], bool]) -> Session:
        self._runs += 1
        drive = replace(self.drive, seed=self.drive.seed + self._runs - 1, folder=self._folder(self._runs))
        return Session(drive, show, self._runs, kept=self._ended)

    def _folder(self, number: int) -> Path | None:
        """Return the folder of a run; None if nothing is written."""
        return None if self.drive.folder is None else self.drive.folder / f"drive-{self._earlier + number:03d}"

    def _ended(self, session: Session, run: Run) -> None:
        self._reported.add(session.number)
        if self._kept is not None:
            self._kept(run)

    def _report(self, request: Request) -> Response:
        number = request.path_params["number"]

        def report() -> Response:
            folder = self._folder(number) if number in self._reported else None
            if folder is None or not (folder / "report.html").is_file():
                return PlainTextResponse("there is no report of that run", status_code=404)
            return FileResponse(folder / "report.html")

        answer = self.door.answer(request, report)
        if answer.status_code == 200:  # a report brings its modules as data URLs
            answer.headers["Content-Security-Policy"] = "default-src 'self' data: 'unsafe-inline'"
        return answer

    async def _socket(self, connection: WebSocket) -> None:
        if self.door.refusal(connection):
            await connection.close(code=1008)
        else:
            await self.cockpit.serve(connection)


def _greatest_number(folder: Path) -> int:
    """Return the greatest number of a run's folder that is there; 0 without one."""
    numbers = [one.name.removeprefix("drive-") for one in folder.glob("drive-*")]
    return max((int(one) for one in numbers if one.isascii() and one.isdecimal()), default=0)


def drive_page(name: str, language: Language, base: str = "") -> str:
    """Return the driving page of a run in a language; the paths of its data and its socket begin with `base`."""
    template = page_environment(LIVE).get_template("drive.html.jinja")
    return template.render(name=name, base=base, language=language, words=WORDS[language])


def serve(
    drive: Drive,
    *,
    host: str = "127.0.0.1",
    port: int = 0,
    watched: bool = False,
    kept: Callable[[Run], None] | None = None,
    told: Callable[[str], None],
) -> str:
    """Serve a scenario until the program is interrupted, or until a watched run has ended.

    Returns:
        Description of how the last run ended; empty if there was none.

    Args:
        drive: The runs.
        host: Address to serve; on an address other than this machine's own, pages need a token.
        port: Its port; 0 for a free one.
        watched: Whether nobody drives.
        kept: Receives each run when it has ended.
        told: Called with the address of the page once it can be opened.

    Raises:
        OSError: The address cannot be served.
    """
    with listening_at(host, port) as listening:
        door = Door(host, listening.getsockname()[1], new_token(host))
        server: list[Server] = []
        live = LiveServer(drive, door, watched=watched, kept=kept, done=lambda: server[0].end())
        server.append(server_of(live.app, lambda: told(address_of(door))))
        try:
            server[0].run(sockets=[listening])
        finally:
            live.stop()
        return live.ended
