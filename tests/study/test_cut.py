"""A study whose server is killed at random moments: at most one second of a drive is lost, and the study goes on."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect
from websockets.typing import Origin

from scenario_compiler.study.journal import attempts_at, read_journal
from tests.live import soaking
from tests.live.serving import Served, served
from tests.study.test_server import ordered, origin

CUTS = 10
LOST = 1.0
"""What may be lost of a drive, s."""


def driven_until_cut(server: Served, pictures: int) -> float:
    """Drive, and kill the server after some pictures; return the time of the last one, s."""
    here, t = origin(server), 0.0
    with connect(
        here.replace("http", "ws") + "/participant/1/socket?step=0", origin=Origin(here), max_size=None
    ) as page:
        page.recv()
        page.send('{"kind": "start"}')
        try:
            for seq in range(1, 100_000):
                if seq > pictures:
                    server.process.kill()
                told = page.recv()
                assert isinstance(told, bytes)
                about = json.loads(told[4 : 4 + int.from_bytes(told[:4], "big")])
                t = about["t"]
                page.send(f'{{"kind": "input", "seq": {seq}, "throttle": 0.1}}')
        except ConnectionClosed:
            pass
    return t


@pytest.mark.slow
def test_a_server_that_is_killed_loses_at_most_a_second(tmp_path: Path) -> None:
    study, data = soaking.written(tmp_path, 1, 1, duration=600), tmp_path / "data"
    source = data / "sourcedata" / "sub-01" / "ses-01"
    words = ("study", study, "--perception", "ideal", "--size", "640x360", "-o", data)
    moments = np.random.default_rng(1).integers(1, 80, CUTS)
    for cut, pictures in enumerate(moments, start=1):
        with served(*words) as server:
            ordered(server, participant=1, action="start")
            last = driven_until_cut(server, int(pictures))
        records = read_journal(source / "journal.jsonl")
        assert attempts_at(records, 0) == cut
        assert records[-1]["kind"] == "begun"
        lines = (
            (source / f"run-01_attempt-{cut}" / "inputs.jsonl")
            .read_text(encoding="utf-8")
            .rpartition("\n")[0]
            .splitlines()
        )
        kept = json.loads(lines[-1])["t"] if lines else 0.0
        assert last - kept <= LOST
    assert not list(source.glob("*/outcome.json"))
    with served(*words) as server:
        ordered(server, participant=1, action="start")
        assert json.loads((data / "sourcedata" / "study.json").read_text(encoding="utf-8"))["study"] == "soak"
