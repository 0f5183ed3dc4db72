"""Access to the pages: from this machine or with the printed token, only to this server's pages and listed files."""

from __future__ import annotations

import secrets
import socket
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import urlsplit

import uvicorn
from starlette.applications import Starlette
from starlette.requests import HTTPConnection, Request
from starlette.responses import PlainTextResponse, RedirectResponse, Response

from scenario_compiler.addresses import LOOPBACK, bracketed
from scenario_compiler.live.sounds import SOUNDS, sound_files
from scenario_compiler.report.embedding import FOLDER as PAGES

LIVE = Path(__file__).parent / "pages"

SHARED = ("data.js", "map.js")
"""Modules of the reports' player that pages also use."""

OWN = ("drive.js", "wheel.js", "sounds.js", "search.js", "drive.css")

TYPES = {".js": "text/javascript", ".css": "text/css", ".opus": "audio/ogg"}

LARGEST = 16_384
"""Greatest size of a message from a page, bytes."""

ANYWHERE = {"0.0.0.0": (socket.AF_INET, "192.0.2.1"), "::": (socket.AF_INET6, "2001:db8::1")}
"""Addresses that stand for all those of this machine, with an address elsewhere, reserved for documentation."""

HEADERS = {
    "Content-Security-Policy": "default-src 'self'; img-src 'self' blob: data:; style-src 'self' 'unsafe-inline'; "
    "script-src 'self' 'unsafe-inline'; connect-src 'self'; form-action 'self'; frame-ancestors 'none'",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "same-origin",
    "Cache-Control": "no-store",
}


@dataclass(frozen=True)
class Door:
    """Controls access.

    Attributes:
        host: Served address.
        port: Its port.
        token: The token that a page needs; empty if only this machine has access.
        cookie: Name of the cookie with the token.
    """

    host: str
    port: int
    token: str = ""
    cookie: str = "token"

    def refusal(self, connection: HTTPConnection) -> str:
        """Return why a request is refused; empty if it is accepted.

        A page of another site can send requests here, but neither with this server's host name nor with the token. A
        request that changes something (a socket, a form) must come from a page, and therefore name its origin.
        """
        name = connection.headers.get("host", "")
        allowed = {f"{bracketed(one)}:{self.port}" for one in (*LOOPBACK, self.host)}
        if self.host not in ("0.0.0.0", "::") and name not in allowed:
            return "this server does not serve that name"
        given = connection.query_params.get("token") or connection.cookies.get(self.cookie, "")
        if self.token and not secrets.compare_digest(given.encode(), self.token.encode()):
            return "the address lacks the token that was printed when the server started"
        origin = connection.headers.get("origin")
        if origin is None and connection.scope["type"] == "websocket":
            return "only a page may open a socket"
        if origin is None and connection.scope["method"] not in ("GET", "HEAD"):
            return "only a page may send a form"
        if origin is not None and urlsplit(origin).netloc != name:
            return "a page of another site sent this request"
        return ""

    def answer(self, request: Request, make: Callable[[], Response]) -> Response:
        """Return the response of a function if access is allowed, otherwise the reason for the refusal."""
        refusal = self.refusal(request)
        response = PlainTextResponse(refusal, status_code=403) if refusal else make()
        response.headers.update(HEADERS)
        return response

    def entered(self, request: Request, make: Callable[[], Response]) -> Response:
        """Return a first page. If the address has the token, redirect to one without it and set the token's cookie."""

        def page() -> Response:
            if self.token and "token" in request.query_params:
                redirected = RedirectResponse(request.url.path, status_code=303)
                redirected.set_cookie(self.cookie, self.token, httponly=True, samesite="strict")
                return redirected
            return make()

        return self.answer(request, page)

    def file(self, request: Request, folder: Path, names: tuple[str, ...]) -> Response:
        """Return one of the listed files."""
        name = request.path_params["name"]

        def content() -> Response:
            if name not in names:
                return PlainTextResponse("there is no such file", status_code=404)
            return Response((folder / name).read_bytes(), media_type=TYPES[Path(name).suffix])

        return self.answer(request, content)

    def shared(self, request: Request) -> Response:
        """Return a module of the reports' player."""
        return self.file(request, PAGES, SHARED)

    def own(self, request: Request) -> Response:
        """Return a file of the driving page."""
        return self.file(request, LIVE, OWN)

    def sound(self, request: Request) -> Response:
        """Return a sound of a message."""
        return self.file(request, SOUNDS, sound_files())


def new_token(host: str) -> str:
    """Return a token for pages of an address; empty for this machine's own."""
    return "" if host in LOOPBACK else secrets.token_urlsafe(16)


def address_of(door: Door, path: str = "/") -> str:
    """Return the address of a page, with the token that it needs, as other machines can open it."""
    host = bracketed(own_address(door.host))
    return f"http://{host}:{door.port}{path}" + (f"?token={door.token}" if door.token else "")


def own_address(host: str) -> str:
    """Return an address at which other machines reach this one if `host` stands for all its addresses, or else `host`.

    Nothing is sent: the address is that from which the system would send. Without a network it is the machine's name.
    """
    if host not in ANYWHERE:
        return host
    family, elsewhere = ANYWHERE[host]
    try:
        with socket.socket(family, socket.SOCK_DGRAM) as outward:
            outward.connect((elsewhere, 9))
            return str(outward.getsockname()[0])
    except OSError:
        return socket.gethostname()


class Server(uvicorn.Server):
    """A server that reports when it is ready."""

    def __init__(self, config: uvicorn.Config, serves: Callable[[], None]) -> None:
        """Store uvicorn's configuration, and the function to call when pages can be opened."""
        super().__init__(config)
        self._serves = serves

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Start to serve, and report it."""
        await super().startup(sockets=sockets)
        self._serves()

    def end(self) -> None:
        """Stop serving."""
        self.should_exit = True


def listening_at(host: str, port: int) -> socket.socket:
    """Return a socket that listens at an address; port 0 for a free one.

    Raises:
        OSError: The address cannot be served; the error names it.
    """
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    listening = socket.socket(family, socket.SOCK_STREAM)
    try:
        listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listening.bind((host, port))
        listening.listen(64)
    except OSError as fault:
        listening.close()
        raise OSError(fault.errno, f"cannot be served: {fault.strerror}", f"{bracketed(host)}:{port}") from None
    return listening


def server_of(app: Starlette, serves: Callable[[], None]) -> Server:
    """Return a server of an application; `serves` is called once its pages can be opened."""
    config = uvicorn.Config(
        app,
        log_level="error",
        ws_max_size=LARGEST,
        ws_max_queue=64,
        ws_per_message_deflate=False,
        timeout_graceful_shutdown=1,
        lifespan="off",
    )
    return Server(config, serves)
