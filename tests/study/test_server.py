"""Who may do what with a study's server, and what it makes of requests that are none of its pages'."""

from __future__ import annotations

import http.client
import json
from collections.abc import Iterator
from pathlib import Path

import pytest

from scenario_compiler.study.journal import read_journal
from tests.command import call
from tests.live.serving import Served, served
from tests.study import made


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("study")


@pytest.fixture(scope="module")
def own(folder: Path) -> Iterator[Served]:
    """A server for this machine alone."""
    with served("study", made.study(folder), "--perception", "ideal", "-o", folder / "data") as one:
        yield one


@pytest.fixture(scope="module")
def foreign(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Served, str]]:
    """A server for other machines too, and the experimenter's address."""
    study = made.study(tmp_path_factory.mktemp("foreign"))
    words = ("study", study, "--perception", "ideal", "--host", "0.0.0.0", "-o", study.parent / "data")
    with served(*words) as one:
        assert one.process.stdout is not None
        yield one, one.process.stdout.readline().split()[1]


def asked(server: Served, path: str, body: str | None = None, **headers: str) -> tuple[int, str]:
    """Return the status and the text of an answer; a body is sent as a form or an order is."""
    connection = http.client.HTTPConnection("127.0.0.1", int(server.host.rpartition(":")[2]), timeout=60)
    connection.request("GET" if body is None else "POST", path, body, headers)
    answer = connection.getresponse()
    text = answer.read().decode(errors="replace")
    connection.close()
    return answer.status, text


def ordered(server: Served, **order: object) -> int:
    return asked(server, "/experimenter/do", json.dumps(order), Origin=origin(server))[0]


def origin(server: Served) -> str:
    return f"http://127.0.0.1:{server.host.rpartition(':')[2]}"


@pytest.mark.parametrize(
    "path",
    [
        *("/participant/3", "/participant/0", "/participant/-1", "/participant/1/../../etc/passwd", "/participant/x"),
        *("/study/../server.py", "/study/%2e%2e/server.py", "/study/first.html.jinja", "/study/..%2fserver.py"),
        *("/participant/3/about", "/participant/1/about", "/participant/3/state", "/sourcedata/study.json", "/data"),
        f"/participant/{'9' * 5000}",
    ],
)
def test_nothing_else_is_served(own: Served, path: str) -> None:
    assert asked(own, path)[0] == 404


def test_a_page_of_another_site_changes_nothing(own: Served, folder: Path) -> None:
    order = json.dumps({"participant": 1, "action": "start"})
    for headers in ({}, {"Origin": "http://evil.example"}, {"Origin": "null"}):
        assert asked(own, "/experimenter/do", order, **headers)[0] == 403
        assert asked(own, "/participant/1", "step=0&agree=yes", **headers)[0] == 403
    assert asked(own, "/experimenter/state", Host="evil.example")[0] == 403
    assert read_journal(folder / "data" / "sourcedata" / "sub-01" / "ses-01" / "journal.jsonl") == []


def test_answers_are_taken_where_they_belong_alone(own: Served, folder: Path) -> None:
    def sent(body: str) -> tuple[int, str]:
        return asked(own, "/participant/2", body, Origin=origin(own))

    assert sent("step=0&agree=yes")[0] == 400  # the experimenter has not started
    assert ordered(own, participant=2, action="start") == 200
    for wrong in ("", "step=x", "step=5&agree=yes", "step=", "agree=yes", "step=0&" * 600, "\xff"):
        assert sent(wrong)[0] == 400, wrong
    assert sent("step=0&agree=" + "x" * 70_000)[0] == 413
    assert sent("step=0&agree=yes")[0] == 303
    assert sent("step=0&agree=no")[0] == 303  # sent again: what was said first stands
    assert sent("step=1")[0] == 303
    assert sent("step=2")[0] == 400  # it is driven, not sent
    records = read_journal(folder / "data" / "sourcedata" / "sub-02" / "ses-01" / "journal.jsonl")
    assert [(one["kind"], one["step"]) for one in records] == [("started", 0), ("done", 0), ("done", 1)]


@pytest.mark.parametrize(
    "body",
    [
        *("", "[]", "{", '{"participant": 9, "action": "start"}', '{"participant": 1, "action": "fly"}'),
        *('{"participant": 1, "action": "note"}', '{"participant": 1, "action": "note", "text": "' + "x" * 3000 + '"}'),
        *('{"participant": 1, "action": "start", "more": 1}', "x" * 70_000),
    ],
)
def test_what_is_no_order_is_refused(own: Served, body: str) -> None:
    assert asked(own, "/experimenter/do", body, Origin=origin(own))[0] == 400


def test_participants_and_the_experimenter_have_tokens_of_their_own(foreign: tuple[Served, str]) -> None:
    server, desk = foreign
    tokens = [address.partition("?token=")[2] for address in (server.address, desk)]
    assert len(set(tokens)) == 2
    assert all(len(token) >= 16 for token in tokens)
    participant, experimenter = f"token={tokens[0]}", f"experimenter={tokens[1]}"
    for path in (
        "/",
        "/participant/1",
        "/participant/1/state",
        "/experimenter",
        "/experimenter/state",
        "/study/study.css",
    ):
        assert asked(server, path)[0] == 403
        assert asked(server, path, Cookie="token=wrong; experimenter=wrong")[0] == 403
    assert asked(server, "/participant/1", Cookie=participant)[0] == 200
    assert asked(server, "/experimenter/state", Cookie=experimenter)[0] == 200
    assert asked(server, "/experimenter/state", Cookie=participant)[0] == 403
    assert asked(server, "/participant/1", Cookie=experimenter)[0] == 403
    assert asked(server, "/study/study.css", Cookie=experimenter)[0] == 200
    assert asked(server, f"/experimenter?{experimenter.replace('experimenter', 'token')}")[0] == 303


def test_a_folder_is_written_by_one_server(own: Served, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    del own
    assert call("study", folder / "study.xml", "--perception", "ideal", "-o", folder / "data", "--port", "0") == 2
    assert "is in use by another program" in capsys.readouterr().err


@pytest.mark.parametrize("path", ["/", "/participant/1", "/participant/2"])
def test_no_page_of_a_participant_tells_what_is_studied(own: Served, path: str) -> None:
    """Who knows the question of a study may answer and drive accordingly."""
    status, page = asked(own, path)
    assert status == 200
    assert "shorten takeovers" not in page
    assert "<title>short" not in page
    assert "shorten takeovers" in asked(own, "/experimenter")[1]
