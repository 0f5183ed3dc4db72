"""Many short runs through a server, one after the other, and the memory that its process holds after each."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from pathlib import Path

from websockets.sync.client import connect
from websockets.typing import Origin

from tests.live.serving import Served, seated

SHORT = """\
<scenarios version="1">
  <scenario name="short" map="town_grid" duration="{duration}">
    <ego speed="10"><start><lane road="3" lane="-1" s="20"/></start></ego>
    <static id="blocker" model="vehicle.audi.tt"><at><ahead_of entity="ego" distance="45"/></at></static>
    <takeover><driver><person/></driver><message modality="text speech" content="what why"/></takeover>
    <criteria><no_collision/></criteria>
  </scenario>
</scenarios>
"""

STUDY = """\
<study version="1" name="soak" participants="{participants}" repetitions="{repetitions}" order="random">
  {scenarios}
</study>
"""

CONDITIONS = 10
"""Conditions that share the runs of a participant, where these are a multiple of it."""


def written(folder: Path, participants: int, runs: int, duration: float = 0.4) -> Path:
    """Write a study of short runs, so many for each participant, and its conflicts; return its file."""
    (folder / "conflicts.xml").write_text(SHORT.format(duration=duration), encoding="utf-8")
    conditions = CONDITIONS if runs % CONDITIONS == 0 else 1
    scenarios = "".join(f'<scenario name="short{k}" target="conflicts.xml#short"/>' for k in range(conditions))
    study = STUDY.format(participants=participants, repetitions=runs // conditions, scenarios=scenarios)
    (folder / "study.xml").write_text(study, encoding="utf-8")
    return folder / "study.xml"


def resident(server: Served) -> float:
    """Return the memory that a server's process holds, MiB."""
    text = Path(f"/proc/{server.process.pid}/status").read_text(encoding="utf-8")
    return next(float(line.split()[1]) / 1024.0 for line in text.splitlines() if line.startswith("VmRSS"))


def runs(server: Served, count: int, path: str = "/socket") -> Iterator[float]:
    """Drive one run after the other, each by a page of its own; yield the memory after each, MiB.

    A participant's path has `{}` in the place of the step's number: the soaked study has no steps but its runs.
    """
    here = f"http://127.0.0.1:{server.host.rpartition(':')[2]}"
    for run in range(count):
        with connect(here.replace("http", "ws") + path.format(run), origin=Origin(here), max_size=None) as page:
            seated(page)
            page.send('{"kind": "start"}')
            for seq in itertools.count(1):
                try:
                    told = page.recv(timeout=1.0)
                except TimeoutError:  # a run that has ended writes its files; a page says each second that it is there
                    page.send('{"kind": "ping", "t": 0}')
                    continue
                if isinstance(told, bytes) and b'"end":' in told[:200]:
                    break
                page.send(f'{{"kind": "input", "seq": {seq}, "throttle": 0.1}}')
        yield resident(server)
