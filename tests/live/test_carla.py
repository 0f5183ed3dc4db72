"""`drive` and `study` in a CARLA server: a person takes over there, and what is drawn is driven there."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import expect

from scenario_compiler.recording.store import read_recording
from scenario_compiler.study.tables import tidy_rows
from tests.browser import opened_browser, opened_page
from tests.carla_server import conftest
from tests.live.scenarios import SOON
from tests.live.serving import served
from tests.live.test_drive import begun, driven, ended, kinds
from tests.study import made
from tests.study.test_live import answered, consented, left, ordered, probed, serving, started
from tests.study.test_live import begun as begun_in_study

pytestmark = [pytest.mark.slow, pytest.mark.apart]
"""Run by `make test-carla`."""

client_version = conftest.client_version


@pytest.fixture
def carla(tmp_path: Path, client_version: str) -> Iterator[conftest.Served]:
    with conftest.served(tmp_path, "--carla-version", client_version) as running:
        yield running


def test_a_person_takes_over_and_brakes_in_carla(tmp_path: Path, carla: conftest.Served) -> None:
    scenario, out = tmp_path / "soon.xml", tmp_path / "out"
    scenario.write_text(SOON, encoding="utf-8")
    words = ("drive", scenario, "--perception", "ideal", "--world", "carla", "--carla-port", carla.port, "-o", out)
    with (
        served(*words) as server,
        opened_browser() as browser,
        opened_page(browser, server.address, bypass_csp=True) as page,
    ):
        begun(page)
        page.wait_for_function("page.latest.state === 'request'")
        there = carla.client().get_world()
        there.wait_for_tick()
        hero = next(one for one in there.get_actors() if one.attributes.get("role_name") == "hero")
        assert there.get_settings().synchronous_mode
        assert hero.get_velocity().length() > 3.0
        page.keyboard.down("ArrowDown")
        page.wait_for_function("page.latest.byHand")
        page.wait_for_function("page.latest.speed < 1")
        page.keyboard.up("ArrowDown")
        assert hero.get_velocity().length() < 3.0
        ended(page)
        expect(page.locator("#ended")).to_have_text("Driver took over, no collision")
        page.get_by_role("button", name="Again").click()  # a second run begins in a new world of the same server
        page.wait_for_function("page.latest.run === 2 && page.latest.t > 0.5")
        ended(page)
    assert not carla.client().get_world().get_settings().synchronous_mode
    for number in (1, 2):
        recording = driven(out, number)
        assert recording.header.world == "carla"
        assert recording.stop_reason == "user"
    first = driven(out)
    assert kinds(first).index("request") < kinds(first).index("response")
    assert np.hypot(np.diff(first.x[:, 0]), np.diff(first.y[:, 0])).sum() > 2.0


def test_a_participant_of_a_study_takes_over_in_carla(tmp_path: Path, carla: conftest.Served) -> None:
    study, data = made.study(tmp_path), tmp_path / "data"
    conflicts = tmp_path / "conflicts.xml"
    lasting = (
        conflicts.read_text(encoding="utf-8")
        .replace('duration="8"', 'duration="600"')
        .replace('after="60"', 'after="600"')
    )
    conflicts.write_text(lasting, encoding="utf-8")
    words = (*serving(study), "--world", "carla", "--carla-port", carla.port)
    with served(*words) as server, opened_browser() as browser:
        started(server, 1)
        with opened_page(browser, f"{server.address}participant/1", bypass_csp=True) as page:
            consented(page)
            begun_in_study(page)
            probed(page)
            expect(page.locator("#held")).to_be_hidden()  # keys belong to its form until then
            page.wait_for_function("page.latest?.state === 'request'")
            page.keyboard.down("ArrowDown")
            page.wait_for_function("page.latest.byHand && page.latest.speed < 1")
            page.keyboard.up("ArrowDown")
            with opened_page(browser, f"{server.address}experimenter", bypass_csp=True) as desk:
                ordered(desk, 1, "Abort")
            left(page)
            answered(page)
    (recording,) = (read_recording(one) for one in data.rglob("recording.parquet"))
    assert recording.header.world == "carla"
    assert kinds(recording).index("request") < kinds(recording).index("response")
    assert recording.person_brake.max() > 0.5
    (row,) = tidy_rows(data)
    assert (row["driven_by"], row["marks"], row["effort.effort"]) == ("person", "aborted", "1.5")
    assert not carla.client().get_world().get_settings().synchronous_mode
