"""Who is served: this machine's own pages, with the token others; no file but those that belong to the page."""

from __future__ import annotations

import http.client
import json
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import ClientConnection

from tests.command import call
from tests.live.scenarios import OPEN
from tests.live.serving import COARSELY, Served, seated, served
from tests.test_cli import CONFLICT


@pytest.fixture(scope="module")
def conflict(tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("live") / "it.xml"
    file.write_text(CONFLICT, encoding="utf-8")
    return file


@pytest.fixture(scope="module")
def own(conflict: Path) -> Iterator[Served]:
    """A server for this machine alone."""
    with served("drive", conflict, "--perception", "ideal") as one:
        yield one


@pytest.fixture(scope="module")
def foreign(conflict: Path) -> Iterator[Served]:
    """A server for other machines too."""
    with served("drive", conflict, "--perception", "ideal", "--host", "0.0.0.0") as one:
        yield one


def asked(server: Served, path: str, **headers: str) -> tuple[int, str]:
    """Return the status and the text of an answer, to a path as it is written."""
    connection = http.client.HTTPConnection("127.0.0.1", int(server.host.rpartition(":")[2]), timeout=30)
    connection.putrequest("GET", path, skip_host="Host" in headers)
    for name, value in headers.items():
        connection.putheader(name, value)
    connection.endheaders()
    answer = connection.getresponse()
    text = answer.read().decode(errors="replace")
    connection.close()
    return answer.status, text


def closes(connection: ClientConnection) -> bool:
    """Read on until the server closes the connection."""
    with suppress(ConnectionClosed):
        for _ in connection:
            pass
    return connection.close_code is not None


def test_the_page_and_its_files_are_served(own: Served) -> None:
    for path in ("/", "/live/drive.js", "/live/wheel.js", "/live/sounds.js", "/live/drive.css", "/shared/map.js"):
        assert asked(own, path)[0] == 200, path
    assert "<title>fade</title>" in asked(own, "/")[1]
    about = json.loads(asked(own, "/about")[1])
    assert about["roadmap"]["strips"]


@pytest.mark.parametrize(
    "path",
    [
        *(
            "/live/drive.html.jinja",
            "/live/../server.py",
            "/live/%2e%2e/server.py",
            "/live/..%2fserver.py",
            "/shared/player.css",
        ),
        *("/shared/....//embedding.py", "/runs/1", "/runs/../../etc/passwd", "//etc/passwd", "/live/%00"),
    ],
)
def test_no_other_file_is_served(own: Served, path: str) -> None:
    assert asked(own, path)[0] == 404


def test_another_name_for_this_machine_is_refused(own: Served) -> None:
    """A name that another site made point here (DNS rebinding)."""
    status, text = asked(own, "/", Host="evil.example:80")
    assert status == 403
    assert "does not serve that name" in text


def test_a_page_of_another_site_gets_nothing(own: Served) -> None:
    assert asked(own, "/about", Origin="http://evil.example")[0] == 403
    for origin in ("http://evil.example", "null", ""):
        with pytest.raises(InvalidStatus) as refused, own.connected(origin=origin):
            pass
        assert refused.value.response.status_code == 403


def test_the_printed_address_is_one_that_other_machines_can_open(foreign: Served) -> None:
    host, _, port = foreign.host.rpartition(":")
    assert host not in ("0.0.0.0", "[::]", "127.0.0.1")
    connection = http.client.HTTPConnection(host, int(port), timeout=30)
    connection.request("GET", foreign.address.partition(foreign.host)[2])
    assert connection.getresponse().status == 303
    connection.close()


def test_on_another_address_a_page_needs_the_token(foreign: Served) -> None:
    token = foreign.address.partition("?token=")[2]
    assert len(token) >= 16
    for path, cookie in (("/", ""), ("/about", "token=wrong"), ("/?token=", "")):
        status, text = asked(foreign, path, **({"Cookie": cookie} if cookie else {}))
        assert status == 403
        assert token not in text
    status, _ = asked(foreign, f"/?token={token}")
    assert status == 303
    assert asked(foreign, "/about", Cookie=f"token={token}")[0] == 200
    with pytest.raises(InvalidStatus), foreign.connected():
        pass
    with foreign.connected(cookie=f"token={token}") as one:
        seated(one)


@pytest.mark.parametrize(
    "message",
    ["no json", "[]", '{"kind": "input", "seq": 1, "steer": 7}', '{"kind": "ping"}', "x" * 20_000, "[" * 10_000],
)
def test_what_is_no_message_of_ours_closes_the_socket_alone(own: Served, message: str) -> None:
    with own.connected() as one:
        seated(one)
        one.send('{"kind": "start"}')
        assert isinstance(one.recv(timeout=60), bytes)
        one.send(message)
        assert closes(one)
    assert asked(own, "/")[0] == 200


def picture(page: ClientConnection, seconds: int) -> dict[str, Any]:
    """Return what belongs to the next picture; TimeoutError where none comes. The page says that it is there."""
    for _ in range(seconds):
        page.send('{"kind": "ping", "t": 0}')
        with suppress(TimeoutError):
            while isinstance(told := page.recv(timeout=1), str):
                pass
            about: dict[str, Any] = json.loads(told[4 : 4 + int.from_bytes(told[:4], "big")])
            return about
    raise TimeoutError


@pytest.mark.slow
def test_a_page_that_is_slow_is_sent_fewer_pictures_and_no_late_ones(open_road: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    with served("drive", open_road, *COARSELY, "-o", out) as server, server.connected() as page:
        seated(page)
        page.send('{"kind": "reports"}')
        page.send('{"kind": "start"}')
        waiting = [picture(page, 60), picture(page, 60)]
        while time_of_run(out / "drive-001" / "inputs.jsonl") < waiting[-1]["t"] + 2.0:
            with suppress(TimeoutError):
                waiting.append(picture(page, 1))
        assert len(waiting) == 2  # from the first one on: a slow network would deliver all that were sent meanwhile
        for _ in waiting:
            page.send('{"kind": "shown"}')
        picture(page, 60)  # the latest one when there was no room
        page.send('{"kind": "shown"}')
        assert picture(page, 60)["t"] > waiting[-1]["t"] + 0.2


def time_of_run(inputs: Path) -> float:
    """Return the time that a run has reached, s, as far as the file of its inputs goes."""
    *_, last = inputs.read_text(encoding="utf-8").rpartition("\n")[0].splitlines() or ['{"t": 0}']
    return float(json.loads(last)["t"])


@pytest.mark.slow
def test_the_end_of_a_run_does_not_wait_for_a_page_that_is_slow(tmp_path: Path) -> None:
    """A page that the screen does not show may keep pictures for as long as it is hidden."""
    file = tmp_path / "open.xml"
    file.write_text(OPEN.replace('duration="600"', 'duration="3"'), encoding="utf-8")
    with served("drive", file, *COARSELY) as server, server.connected() as page:
        seated(page)
        page.send('{"kind": "reports"}')
        page.send('{"kind": "start"}')
        while "end" not in picture(page, 60):
            pass


def test_the_page_that_waits_drives_when_the_one_that_drove_is_gone(own: Served) -> None:
    """A page that is loaded again is a second one as long as the server does not know that the first is gone."""
    with own.connected() as one:
        seated(one)
        with own.connected() as other:
            assert json.loads(other.recv(timeout=60)) == {"role": "viewer"}
            one.close()
            seated(other)
            other.send('{"kind": "start"}')
            assert isinstance(other.recv(timeout=60), bytes)


def test_a_second_page_watches(own: Served) -> None:
    with own.connected() as one:
        seated(one)
        with own.connected() as other:
            assert json.loads(other.recv(timeout=60)) == {"role": "viewer"}
            other.send('{"kind": "start"}')
            assert closes(other)


@pytest.mark.slow
def test_a_run_is_written_after_those_that_are_there(conflict: Path, tmp_path: Path) -> None:
    earlier = tmp_path / "drive-007" / "outcome.json"
    earlier.parent.mkdir()
    earlier.write_text("kept", encoding="utf-8")
    (tmp_path / "drive-notes").mkdir()
    with served("drive", conflict, *COARSELY, "-o", tmp_path, "--force", "--duration", "0.3") as server:
        with server.connected() as page:
            seated(page)
            page.send('{"kind": "start"}')
            while "end" not in picture(page, 60):
                pass
        assert asked(server, "/runs/1")[0] == 200
    assert sorted(one.name for one in tmp_path.glob("drive-*")) == ["drive-007", "drive-008", "drive-notes"]
    assert earlier.read_text(encoding="utf-8") == "kept"
    assert (tmp_path / "drive-008" / "report.html").is_file()


def test_an_address_that_cannot_be_served_is_named(
    own: Served, conflict: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    port = own.host.rpartition(":")[2]
    assert call("drive", conflict, "--perception", "ideal", "--port", port) == 2
    assert f"127.0.0.1:{port}: cannot be served: Address already in use" in capsys.readouterr().err


def test_an_interrupted_server_ends_in_one_line(conflict: Path) -> None:
    with served("drive", conflict, "--perception", "ideal") as one:
        one.process.send_signal(2)
        _, err = one.process.communicate(timeout=60)
        assert one.process.returncode == 130
        assert "Traceback" not in err
        assert err.splitlines()[-1] == "scenario-compiler: interrupted"


FAILING = """
from scenario_compiler import Control, ControllerModel

class Mine(ControllerModel):
    def control(self, sensor_data, speed, vehicle):
        if sensor_data.t > 0.3:
            raise RuntimeError("lost")
        return Control(throttle=0.0, steer=0.0, brake=0.0)
"""


@pytest.mark.slow
def test_a_controller_that_fails_while_a_person_drives_is_reported(open_road: Path, tmp_path: Path) -> None:
    controller = tmp_path / "mine.py"
    controller.write_text(FAILING, encoding="utf-8")
    words = ("--perception", "camera", "--dt", "0.1", "--controller", f"{controller}:Mine", "-o", tmp_path / "out")
    said = f"controller '{controller}:Mine', mine.py:7: RuntimeError: lost"
    with served("drive", open_road, *words) as server:
        with server.connected() as page:
            seated(page)
            page.send('{"kind": "reports"}')
            page.send('{"kind": "start"}')
            while "end" not in (about := picture(page, 60)):
                page.send('{"kind": "shown"}')
        assert about["end"] == f"the run broke off: {said}"
        server.process.send_signal(2)
        _, err = server.process.communicate(timeout=60)
        assert server.process.returncode == 130
    assert f"error[SC521]: {said}" in err
    assert (tmp_path / "out" / "drive-001" / "recording.parquet").is_file()
