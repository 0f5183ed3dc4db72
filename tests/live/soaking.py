"""Many runs through a server, one after the other, and the memory that its process holds after each."""

from __future__ import annotations

import itertools
import json
from collections.abc import Iterator
from pathlib import Path

from websockets.sync.client import connect
from websockets.typing import Origin

from tests.live.serving import Served, seated

SHORT = """\
<scenarios version="1">
  <scenario name="one" map="town_grid" duration="{duration}">
    <ego speed="10"><start><lane road="3" lane="-1" s="20"/></start></ego>
    <static id="blocker" model="vehicle.audi.tt"><at><ahead_of entity="ego" distance="45"/></at></static>
    <takeover><driver><person/></driver><message modality="text speech" content="what why"/></takeover>
    <criteria><no_collision/></criteria>
  </scenario>
</scenarios>
"""

LONG = """\
<scenarios version="1">
  <scenario name="one" map="motorway" duration="60">
    <ego speed="25"><start><spawn_point name="right_lane"/></start></ego>
    <dynamic id="leader" speed="25"><start><ahead_of entity="ego" distance="80"/></start></dynamic>
    <when><time after="25"/><do><request/></do></when>
    <when><time after="45"/><do><hand_back/></do></when>
    <takeover><driver takeover_time="3"/><message modality="text speech" content="what why"/></takeover>
    <criteria><no_collision/></criteria>
  </scenario>
</scenarios>
"""
"""A minute in which the automation requests a takeover, a person drives, and the automation drives again."""

STUDY = """\
<study version="1" name="soak" participants="{participants}" repetitions="{repetitions}" order="random">
  {scenarios}
</study>
"""

CONDITIONS = 10
"""Conditions that share the runs of a participant, where these are a multiple of it."""


def written(folder: Path, participants: int, runs: int, duration: float = 0.4, conflicts: str = SHORT) -> Path:
    """Write a study with so many runs for each participant, and its one conflict; return the study's file.

    `LONG` has a duration of its own.
    """
    (folder / "conflicts.xml").write_text(conflicts.format(duration=duration), encoding="utf-8")
    conditions = CONDITIONS if runs % CONDITIONS == 0 else 1
    scenarios = "".join(f'<scenario name="one{k}" target="conflicts.xml#one"/>' for k in range(conditions))
    study = STUDY.format(participants=participants, repetitions=runs // conditions, scenarios=scenarios)
    (folder / "study.xml").write_text(study, encoding="utf-8")
    return folder / "study.xml"


def resident(process: int) -> float:
    """Return the memory that a process holds, by its id, MiB."""
    text = Path(f"/proc/{process}/status").read_text(encoding="utf-8")
    return next(float(line.split()[1]) / 1024.0 for line in text.splitlines() if line.startswith("VmRSS"))


def runs(server: Served, count: int, path: str = "/socket") -> Iterator[float]:
    """Drive one run after the other, each by a page of its own; yield the memory after each, MiB.

    A page takes over when it is asked to. A participant's path has `{}` in the place of the step's number: the soaked
    study has no steps but its runs.
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
                asked = isinstance(told, bytes) and b'"state":"request"' in told[:200]
                page.send(json.dumps({"kind": "input", "seq": seq, "throttle": 0.1, "take_over": asked}))
        yield resident(server.process.pid)
