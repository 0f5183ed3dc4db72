"""Checking hostile road files gives findings with bounded work and memory, never a traceback."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.document import parse_document

HEADER = '<OpenDRIVE><header revMajor="1" revMinor="7"/>'
LANES = (
    '<lanes><laneSection s="0"><center><lane id="0" type="none"/></center><right>'
    '<lane id="-1" type="driving"><width sOffset="0" a="3" b="0" c="0" d="0"/>{}</lane></right></laneSection></lanes>'
)
PLAN = '<planView><geometry s="0" x="0" y="0" hdg="0" length="{0}"><line/></geometry></planView>'

MEMORY = 3 * 1024**3
"""Address space of the checking process, bytes; libraries take some of it."""

MOST_LINES, MOST_LINES_A_BYTE = 240_000, 30
"""Lines of Python that may be run for a file: at most 20 a byte are needed for large ones."""

DEADLINE = 600.0
"""Time after which the checking process counts as hung, s: what C does inside is not counted in lines."""


def road(
    number: object = 1, length: object = 100, link: str = "", inside: str = "", lanes: str = "", more: str = ""
) -> str:
    """Return a road; `inside` stands in its only lane, `more` behind its lanes."""
    return (
        f'<road id="{number}" length="{length}" junction="-1"><link>{link}</link>{PLAN.format(length)}'
        f"{lanes or LANES.format(inside)}{more}</road>"
    )


def whole(*parts: str) -> str:
    return HEADER + "".join(parts) + "</OpenDRIVE>"


def times(count: int, text: str) -> str:
    """Return a text many times, with its number put in."""
    return "".join(text.format(i) for i in range(count))


def links(number: int, count: int) -> str:
    after, before = (number + 1) % count, (number - 1) % count
    return (
        f'<predecessor elementType="road" elementId="{before}" contactPoint="end"/>'
        f'<successor elementType="road" elementId="{after}" contactPoint="start"/>'
    )


def files() -> Iterator[tuple[str, str, set[str]]]:
    """Yield (name, text, codes that must be among the findings)."""
    bomb = "".join(f'<!ENTITY l{i} "{f"&l{i - 1};" * 10 if i else "lol"}">' for i in range(12))
    yield "external", '<!DOCTYPE x [<!ENTITY a SYSTEM "file:///etc/passwd">]><OpenDRIVE>&a;</OpenDRIVE>', {"SC103"}
    yield "bomb", f"<!DOCTYPE x [{bomb}]><OpenDRIVE>&l11;</OpenDRIVE>", {"SC103"}
    yield "late_bomb", f"<!--{'x' * 200_000}--><!DOCTYPE x [{bomb}]><OpenDRIVE a='&l11;'/>", {"SC103"}
    yield "open_comments", "<!--" * 100_000, {"SC102"}
    yield "attributes", "<OpenDRIVE " + times(40_000, 'a{}="1" ') + "/>", {"SC103"}
    yield "deep", "<OpenDRIVE>" + "<road>" * 200_000 + "</road>" * 200_000 + "</OpenDRIVE>", {"SC102"}
    for number in ("NaN", "INF", "-INF", "1e308", "9" * 5000):
        wild = road(number, number, links(1, 3)).replace('="0"', f'="{number}"')
        yield f"number_{number[:5]}", whole(wild, road(2)), {"SC323"} if number.endswith(("N", "F")) else set()
    thing = '<object id="1" s="0" t="0" zOffset="0"><repeat s="0" length="1e9" distance="1"/></object>'
    yield "repeats", whole(road(more=f"<objects>{thing}</objects>")), {"SC314", "SC322"}
    yield "circle", whole(*(road(i, 100, links(i, 3)) for i in range(3))), {"SC344"}
    yield "itself", whole(road(0, 100, links(0, 1))), {"SC344"}
    yield "no_length", whole(road(1, 0), road(2)), {"SC303", "SC323"}
    station = '<laneSection s="{}e4"><center><lane id="0" type="none"/></center></laneSection>'
    yield "sections", whole(road(lanes=f"<lanes>{times(2_400, station)}</lanes>")), {"SC349"}
    piece = '<geometry s="{}" x="0" y="0" hdg="0" length="1"><line/></geometry>'
    yield "geometries", whole(road(1, 6_000).replace("<planView>", f"<planView>{times(6_000, piece)}")), {"SC344"}
    yield "unknown_elements", whole(road(more=times(4_800, "<made_up_{}/>"))), {"SC307", "SC320"}
    made_up = times(900, 'made{}="1" ')
    yield "unknown_attributes", whole(f"<road {made_up}/>" * 30), {"SC307", "SC321"}
    yield "misplaced", whole(road(more="<objects/><signals/>" + "<objects/>" * 4_800)), {"SC307", "SC324"}
    words = '<type s="0" type="unheard of {}"/>'
    yield "words", whole(road().replace("<planView>", times(4_800, words) + "<planView>", 1)), {"SC307", "SC323"}
    access = times(4_800, '<access sOffset="{}" rule="allow" restriction="none"/>')
    yield "records", whole(road(inside=access)), {"SC307", "SC351"}
    linked = "<link>" + '<predecessor id="-1"/><successor id="-1"/>' * 4_800 + "</link>"
    twice = LANES.format(linked).replace("</lanes>", "").replace("<lanes>", "")
    behind = twice.replace('s="0"', 's="50"')
    yield "lane_links", whole(road(lanes=f"<lanes>{twice}{behind}</lanes>")), {"SC335"}
    connection = '<connection id="{0}" incomingRoad="{0}" connectingRoad="0" contactPoint="start"/>'
    into = '<successor elementType="junction" elementId="1"/>'
    many = (road(i, 100, into) for i in range(300))
    yield "junction", whole(*many, f'<junction id="1" name="">{times(1_800, connection)}</junction>'), {"SC328"}
    objects = times(2_400, '<object id="{0}" s="{0}" t="0" zOffset="0"><markings/></object>')
    yield "objects", whole(road(more=f"<objects>{objects}</objects>")), {"SC355"}
    yield "same_ids", whole(road() * 600), {"SC302", "SC327"}
    yield "nothing", "", {"SC102"}
    yield "text", whole("x" * 1_000_000), {"SC326"}


CHECK = """
import json, resource, sys
resource.setrlimit(resource.RLIMIT_AS, (int(sys.argv[1]), int(sys.argv[1])))
from pathlib import Path
from scenario_compiler.diagnostics import Diagnostics, as_text
from scenario_compiler.document import read_document
from scenario_compiler.roads.check import check_file, unread
from tests.work import counted

def check(path):
    sink = Diagnostics()
    check_file(path, sink)
    document = read_document(path, Diagnostics())
    if document is not None:
        unread(document)
    for finding in sink:
        as_text(finding)
    return list(sink)

for path in sorted(Path(sys.argv[2]).iterdir()):
    found, lines = counted(lambda: check(path))
    codes = sorted({finding.code.id for finding in found})
    most = int(sys.argv[3]) + int(sys.argv[4]) * path.stat().st_size
    print(json.dumps([path.stem, codes, len(found), lines / most]), flush=True)
"""


@pytest.fixture(scope="module")
def checked() -> dict[str, tuple[set[str], int, float]]:
    """What checking each file in one bounded process gives: codes, number of findings, share of the lines allowed."""
    with tempfile.TemporaryDirectory() as folder:
        for name, text, _ in files():
            Path(folder, f"{name}.xodr").write_text(text, encoding="utf-8")
        root = str(Path(__file__).resolve().parents[2])
        command = [sys.executable, "-c", CHECK, str(MEMORY), folder, str(MOST_LINES), str(MOST_LINES_A_BYTE)]
        environment = {**os.environ, "PYTHONPATH": root, "OPENBLAS_NUM_THREADS": "1"}
        done = subprocess.run(command, capture_output=True, text=True, env=environment, timeout=DEADLINE, check=False)
    assert done.returncode == 0, done.stdout[-300:] + done.stderr[-3000:]
    found = (json.loads(line) for line in done.stdout.splitlines())
    return {name: (set(codes), count, share) for name, codes, count, share in found}


@pytest.mark.parametrize(("name", "expected"), [(name, expected) for name, _, expected in files()])
def test_a_diagnostic_with_bounded_work(
    checked: dict[str, tuple[set[str], int, float]], name: str, expected: set[str]
) -> None:
    codes, count, share = checked[name]
    assert expected <= codes
    assert count < 3000
    assert share < 1.0


@pytest.mark.parametrize(
    ("raw", "line"),
    [
        (b"<!--" + b"x" * 100_000 + b"-->\n<!DOCTYPE a><a/>", 2),
        (b'<?xml version="1.0"?>\n\n<?made up?><!DOCTYPE a SYSTEM "b"><a/>', 3),
        ('<?xml version="1.0" encoding="utf-16"?>\n<!DOCTYPE a><a/>'.encode("utf-16"), 2),
        (b'<?xml version="1.0" encoding="utf-7"?>+ADwAIQ-DOCTYPE a+AD4APA-a/+AD4-', 1),
    ],
)
def test_document_types_are_found_wherever_they_stand(raw: bytes, line: int) -> None:
    sink = Diagnostics()
    assert parse_document(raw, "made.xml", sink) is None
    assert [(one.code.id, one.place.line) for one in sink] == [("SC103", line)]


def test_a_document_type_in_a_comment_is_ignored() -> None:
    assert parse_document(b"<!--> <!DOCTYPE a> --><a/>", "made.xml", Diagnostics()) is not None
