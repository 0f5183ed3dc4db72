"""The pages of a study: those of the participants, and that of the experimenter.

A participant's page is made again at each step, so that a page that is loaded again shows the participant's present
step.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any
from urllib.parse import parse_qs

from pydantic import BaseModel, ConfigDict, Field, ValidationError
from starlette.applications import Starlette
from starlette.requests import ClientDisconnect, Request
from starlette.responses import HTMLResponse, JSONResponse, PlainTextResponse, RedirectResponse, Response
from starlette.routing import Route, WebSocketRoute
from starlette.websockets import WebSocket

from scenario_compiler.live.cockpit import described
from scenario_compiler.live.server import drive_page
from scenario_compiler.live.web import Door, Server, address_of, listening_at, new_token, server_of
from scenario_compiler.report.templates import page_environment
from scenario_compiler.study.attendance import Attendance, OutOfPlaceError, Rules
from scenario_compiler.study.dataset import write_dataset
from scenario_compiler.study.situation import CHOICES
from scenario_compiler.study.wording import WORDS
from scenario_compiler.study_plans import StudyCompilation
from scenario_compiler.trust import Trust

PAGES = Path(__file__).parent / "pages"

OWN = ("study.css", "waiting.js", "step.js", "experimenter.js")

LARGEST = 65_536
"""Greatest size of a form, bytes."""

ACTIONS: dict[str, Callable[[Attendance], None]] = {
    "start": Attendance.start,
    "pause": Attendance.pause,
    "abort": Attendance.abort,
    "request": Attendance.request,
}


class Order(BaseModel):
    """A request of the experimenter's page."""

    model_config = ConfigDict(extra="forbid")

    participant: int = Field(ge=1, description="Number of the participant.")
    action: str = Field(description="A key of `ACTIONS`, or `note`.")
    text: str = Field(default="", description="The note.")


class StudyServer:
    """Serves a study.

    Attributes:
        attendances: The participants' sessions by their numbers, as in addresses.
        app: The application.
    """

    def __init__(self, rules: Rules, door: Door, desk: Door) -> None:
        """Prepare the pages.

        Args:
            rules: The common settings of all participants.
            door: Controls access to the participants' pages.
            desk: Controls access to the experimenter's page.
        """
        self.rules, self.door, self.desk = rules, door, desk
        study = rules.compilation.study
        self.words = WORDS[study.language]
        self.attendances = {str(one): Attendance(rules, one) for one in range(1, study.participants + 1)}
        self._environment = page_environment(PAGES)
        self.app = Starlette(
            routes=[
                Route("/", self._first),
                Route("/participant/{number}", self._page, methods=["GET"]),
                Route("/participant/{number}", self._sent, methods=["POST"]),
                Route("/participant/{number}/about", self._about),
                Route("/participant/{number}/state", self._state),
                WebSocketRoute("/participant/{number}/socket", self._socket),
                Route("/experimenter", self._experimenter),
                Route("/experimenter/state", self._overview),
                Route("/experimenter/do", self._ordered, methods=["POST"]),
                Route("/shared/{name}", door.shared),
                Route("/live/{name}", door.own),
                Route("/sounds/{name:path}", door.sound),
                Route("/study/{name}", self._own),
                Route("/favicon.ico", lambda request: door.answer(request, lambda: Response(status_code=204))),
            ]
        )

    def close(self) -> None:
        """End all current runs, and close the journals."""
        for one in self.attendances.values():
            one.stop()  # all of them first: a run that went on meanwhile would count as driven
        for one in self.attendances.values():
            one.close()

    def _own(self, request: Request) -> Response:
        """Return a file of the pages, if access to either kind of page is allowed."""
        who = self.desk if self.door.refusal(request) else self.door
        return who.file(request, PAGES, OWN)

    def _rendered(self, template: str, **values: Any) -> Response:
        study = self.rules.compilation.study
        page = self._environment.get_template(template)
        given = {"words": self.words, "study": study, "language": study.language} | values
        return HTMLResponse(page.render(**given))

    # The participant's pages.

    def _first(self, request: Request) -> Response:
        def page() -> Response:
            number = request.query_params.get("participant", "").strip().lstrip("0")
            if number in self.attendances:
                return RedirectResponse(f"/participant/{number}", status_code=303)
            return self._rendered("first.html.jinja", most=len(self.attendances))

        return self.door.entered(request, page)

    def _of(self, request: Request, make: Callable[[Attendance], Response]) -> Response:
        def found() -> Response:
            attendance = self.attendances.get(request.path_params["number"])
            if attendance is None:
                return PlainTextResponse("there is no such participant", status_code=404)
            return make(attendance)

        return self.door.answer(request, found)

    def _page(self, request: Request) -> Response:
        return self._of(request, self._step_page)

    def _step_page(self, attendance: Attendance, fault: str = "") -> Response:
        step, source = attendance.step, self.rules.compilation.file
        base = f"/participant/{attendance.participant}"
        values: dict[str, Any] = {"base": base, "step": step, "token": attendance.token, "fault": fault}
        if attendance.presence == "declined":
            return self._rendered("message.html.jinja", **values, message=self.words["declined"])
        if attendance.presence == "finished":
            return self._rendered("message.html.jinja", **values, message=self.words["thanks"])
        if attendance.presence in ("waiting", "paused") and attendance.session is None:
            return self._rendered("waiting.html.jinja", **values)
        if step.trial is not None:
            name = f"{self.words['run']} {step.trial.number}"
            return HTMLResponse(drive_page(name, attendance.drive(step.trial).language, base))
        if step.kind == "ask":
            asked = source.questionnaires[step.file]
            return self._rendered("questionnaire.html.jinja", **values, asked=asked)
        return self._rendered("page.html.jinja", **values, text=source.pages.get(step.file, ""))

    async def _sent(self, request: Request) -> Response:
        refusal = self.door.refusal(request)
        attendance = self.attendances.get(request.path_params["number"])
        if refusal or attendance is None:
            return self._of(request, self._step_page)
        body = await _body(request)
        if body is None:
            return self.door.answer(request, lambda: PlainTextResponse("that is too large", status_code=413))
        try:
            fields = {name: values[-1] for name, values in parse_qs(body.decode("utf-8"), max_num_fields=500).items()}
            number = int(fields.pop("step"))
            with attendance.writing():
                await asyncio.to_thread(attendance.go_on, number, fields)
        except OSError:
            return self.door.answer(request, lambda: _status(self._step_page(attendance, self.words["wait"]), 507))
        except (KeyError, ValueError) as error:
            known = isinstance(error, OutOfPlaceError)
            fault = str(error) if known else "this is not an answer to this page"
            return self.door.answer(request, lambda: _status(self._step_page(attendance, fault), 400))
        return self.door.answer(request, lambda: RedirectResponse(request.url.path, status_code=303))

    def _state(self, request: Request) -> Response:
        return self._of(request, lambda one: JSONResponse({"token": one.token}))

    def _about(self, request: Request) -> Response:
        def about(attendance: Attendance) -> Response:
            step = attendance.step
            if step.trial is None:
                return PlainTextResponse("nothing is driven here", status_code=404)
            study, words = self.rules.compilation.study, self.words
            queries = [
                {
                    "name": one.name,
                    "text": one.text,
                    "choices": [(value, words[value]) for value in CHOICES.get(one.about, ())],
                }
                for one in (() if study.probe is None else study.probe.queries)
            ]
            texts = {key: words[key] for key in ("continue", "probe", "paused", "over", "wait")}
            told = described(attendance.drive(step.trial))
            told["summary"] = ""
            told["study"] = {"step": step.number, "words": texts, "queries": queries}
            told["study"] |= {"search": None if study.task is None else {"words": words["search"]}}
            return JSONResponse(told)

        return self._of(request, about)

    async def _socket(self, connection: WebSocket) -> None:
        attendance = self.attendances.get(connection.path_params["number"])
        cockpit = None
        if attendance is not None and not self.door.refusal(connection):
            cockpit = await asyncio.to_thread(attendance.cockpit_at, connection.query_params.get("step", ""))
        if cockpit is None:
            await connection.close(code=1008)
        else:
            await cockpit.serve(connection)

    # The experimenter's page.

    def _experimenter(self, request: Request) -> Response:
        return self.desk.entered(request, lambda: self._rendered("experimenter.html.jinja", language="en"))

    def _overview(self, request: Request) -> Response:
        def rows() -> Response:
            return JSONResponse([_row(one) for one in self.attendances.values()])

        return self.desk.answer(request, rows)

    async def _ordered(self, request: Request) -> Response:
        if self.desk.refusal(request):
            return self.desk.answer(request, Response)
        body = await _body(request)
        try:
            order = Order.model_validate_json(body or b"")
            attendance = self.attendances[str(order.participant)]
            with attendance.writing():
                if order.action == "note":
                    await asyncio.to_thread(attendance.note, order.text)
                else:
                    await asyncio.to_thread(ACTIONS[order.action], attendance)
        except OSError as error:
            fault = f"it cannot be written: {error}"
            return self.desk.answer(request, lambda: PlainTextResponse(fault, status_code=507))
        except (KeyError, ValidationError, OutOfPlaceError):
            return self.desk.answer(request, lambda: PlainTextResponse("this is not a command", status_code=400))
        return self.desk.answer(request, lambda: JSONResponse(_row(attendance)))


def _row(one: Attendance) -> dict[str, Any]:
    """Return a participant's row on the experimenter's page."""
    step, session, cockpit = one.step, one.session, one.cockpit
    trial = step.trial
    what = f"{step.kind} {step.file}".strip() if trial is None else f"{trial.role} {trial.what}"
    return {
        "participant": one.participant,
        "id": one.seat.sub,
        "session": one.seat.session,
        "step": step.number + 1,
        "steps": len(one.steps),
        "what": what,
        "presence": one.presence,
        "page": cockpit is not None and cockpit.occupied,
        "run": None if session is None else {"t": round(session.now, 1), "state": session.state, "held": session.held},
        "fault": one.fault,
        "notes": sum(record["kind"] == "note" for record in one.journal.records),
    }


async def _body(request: Request) -> bytes | None:
    """Return the body of a request; None for one that is too large."""
    found = b""
    try:
        async for part in request.stream():
            found += part
            if len(found) > LARGEST:
                return None
    except ClientDisconnect:
        return None
    return found


def _status(response: Response, code: int) -> Response:
    response.status_code = code
    return response


def serve_study(
    compilation: StudyCompilation,
    root: Path,
    *,
    host: str = "127.0.0.1",
    port: int = 0,
    trust: Trust | None = None,
    size: tuple[int, int] = (1280, 720),
    world: str = "kinematic",
    options: Mapping[str, object] = MappingProxyType({}),
    mark: Callable[[dict[str, Any]], None] | None = None,
    told: Callable[[str, str], None],
) -> None:
    """Serve a study until the program is interrupted; existing data in its folder are continued.

    Args:
        compilation: The study, whose plans must have a person as the driver.
        root: Folder of its data, which the caller owns.
        host: Address to serve; on an address other than this machine's own, participants and the experimenter need a
            token each.
        port: Its port; 0 for a free one.
        trust: The user's own code that plans may use.
        size: Width and height of the view ahead, pixels.
        world: Name of the world.
        options: Options of the world.
        mark: Receives the events of all participants at once.
        told: Called with the participants' address and the experimenter's, once they can be opened.

    Raises:
        OSError: The address cannot be served.
    """
    with listening_at(host, port) as listening:
        taken = listening.getsockname()[1]
        door = Door(host, taken, new_token(host))
        desk = Door(host, taken, new_token(host), cookie="experimenter")
        write_dataset(compilation, root, pilot=False)
        study = StudyServer(Rules(compilation, root, trust, size, world, options, mark), door, desk)
        server: list[Server] = []
        server.append(server_of(study.app, lambda: told(address_of(door), address_of(desk, "/experimenter"))))
        try:
            server[0].run(sockets=[listening])
        finally:
            study.close()
