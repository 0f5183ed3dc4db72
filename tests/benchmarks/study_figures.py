"""Participants who drive at once on one server: pictures and delay of each, as their runs record them.

    python -m tests.benchmarks.study_figures [COUNT] [SIZE]

The pages are WebSocket clients that take pictures and decode none.
"""

from __future__ import annotations

import json
import sys
import tempfile
import threading
import time
from pathlib import Path

from websockets.sync.client import connect
from websockets.typing import Origin

from tests.live.serving import Served, served
from tests.study import made
from tests.study.test_server import ordered, origin

SECONDS = 20.0

ENDLESS = """\
<scenarios version="1">
  <scenario name="blocked" map="motorway" duration="600">
    <ego speed="13.9"><start><spawn_point name="right_lane"/></start></ego>
  </scenario>
</scenarios>
"""


def drive(server: Served, participant: int) -> None:
    """Take the pictures of a participant's run for some time."""
    here = origin(server)
    address = f"{here.replace('http', 'ws')}/participant/{participant}/socket?step=0"
    with connect(address, origin=Origin(here), max_size=None) as page:
        page.recv()
        page.send('{"kind": "start"}')
        end = time.perf_counter() + SECONDS
        while time.perf_counter() < end:
            page.recv()
            page.send('{"kind": "ping", "t": 0}')


def main(count: int, size: str) -> None:
    """Let participants drive, and print what their runs have recorded."""
    with tempfile.TemporaryDirectory() as folder:
        study = made.study(Path(folder))
        text = study.read_text(encoding="utf-8").replace('participants="2"', f'participants="{count}"')
        head, _, rest = text.replace('from="0.5" to="1.5"', 'from="900" to="900"').partition("  <before>")
        study.write_text(head + rest.partition("</before>\n")[2], encoding="utf-8")
        study.with_name("conflicts.xml").write_text(ENDLESS, encoding="utf-8")
        data = study.parent / "data"
        with served("study", study, "--perception", "ideal", "--size", size, "-o", data) as server:
            people = range(1, count + 1)
            for one in people:
                ordered(server, participant=one, action="start")
            pages = [threading.Thread(target=drive, args=(server, one)) for one in people]
            for page in pages:
                page.start()
            for page in pages:
                page.join()
            for one in people:
                ordered(server, participant=one, action="abort")
            while len(found := sorted(data.glob("sourcedata/*/*/*/live.json"))) < count:
                time.sleep(0.1)
        for one, file in zip(people, found, strict=True):
            print(one, json.loads(file.read_text(encoding="utf-8")))


if __name__ == "__main__":
    words = sys.argv[1:]
    main(int(words[0]) if words else 4, words[1] if len(words) > 1 else "960x540")
