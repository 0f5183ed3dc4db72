"""The page: self-contained, well-formed, the same for the same run, and with everything that a reader needs."""

from __future__ import annotations

import dataclasses
import re
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path

import pytest

from scenario_compiler.recording.outcome import judge
from scenario_compiler.recording.recording import Frame
from scenario_compiler.report.html import render, write_report
from scenario_compiler.report.run import Run
from scenario_compiler.roads.network import Network
from tests.recording.made import Row, record
from tests.report import made

VOID = {"meta", "br", "img", "link", "input", "hr"}


class Page(HTMLParser):
    """Collects what a page holds and checks that its elements close in order."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.ids: list[str] = []
        self.references: list[str] = []
        self.sources: list[str] = []
        self.tags: list[str] = []
        self.text = ""
        self.source = text
        self.open: list[str] = []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Take down an element and what it refers to."""
        self.tags.append(tag)
        for name, value in attrs:
            self.ids += [value or ""] if name == "id" else []
            self.references += [value or ""] if name in ("href", "xlink:href") else []
            self.references += re.findall(r"url\((.*?)\)", value or "")
            self.sources += [value or ""] if name in ("src", "srcset", "data") else []
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Take down an element that closes itself."""
        self.handle_starttag(tag, attrs)
        if tag not in VOID:
            self.open.pop()

    def handle_endtag(self, tag: str) -> None:
        """Check that the element open last is the one that closes."""
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        """Take down text that readers see."""
        self.text += data if not self.open or self.open[-1] not in ("style", "script") else ""


@pytest.fixture(scope="module")
def page(finished: Run) -> Page:
    return Page(render([finished]))


@pytest.fixture(scope="module")
def several(finished: Run, network: Network) -> Page:
    return Page(render([finished, made.run(network, pictures=False)]))


def test_the_page_needs_nothing_from_outside(page: Page) -> None:
    assert all(source.startswith("data:image/png;base64,") for source in page.sources)
    assert all(reference.startswith("#") for reference in page.references)
    assert not {"link", "iframe", "object"} & set(page.tags)
    assert not re.search(r"<script[^>]*\ssrc=", page.source)


@pytest.mark.parametrize("name", ["page", "several"])
def test_elements_close_and_ids_are_unique_and_found(name: str, request: pytest.FixtureRequest) -> None:
    found: Page = request.getfixturevalue(name)
    assert found.open == []
    assert len(found.ids) == len(set(found.ids))
    assert {reference[1:] for reference in found.references} <= set(found.ids)


@pytest.mark.parametrize(
    "words",
    [
        *(
            "obstacle_ahead",
            "Gold et al. 2018, situation 9, urgency 3, response 1-3",
            "driver took over, no collision",
        ),
        *("path blocked", "Takeover request, 4.00 s", "Driver takes over, 6.40 s", "5f" * 32),
        *("takeover time", "Time from the request to the driver's response", "no collision", "nothing was touched"),
        *("Take over: the lane ahead is blocked", "<slow down>", "lognormal takeover time, median 2.4 s"),
        *("path blocked (margin 0.4 m)", "warning below 0.6", "5 of 8 control steps"),
        *("scenario-compiler run plan.json --seed 1 -o again", "town_grid", "2.4.6", "How it ended"),
    ],
)
def test_the_page_has_the_expected_texts(page: Page, words: str) -> None:
    assert words in re.sub(r"\s+", " ", page.text)


@pytest.mark.parametrize(
    "cells",
    [
        '<td>requests</td><td class="n">1</td>',
        '<td>request time</td><td class="n">4.00</td>',
        "<td>maximum DRAC</td>",
        "the response by more than <code>steering</code> of &lt;inputs&gt;",
    ],
)
def test_measures_are_shown_as_readers_write_them(page: Page, cells: str) -> None:
    assert cells in page.source


def test_the_page_shows_three_pictures_and_three_plots(page: Page) -> None:
    assert (page.tags.count("img"), page.tags.count("svg")) == (3, 3)


def test_pictures_stand_in_order_of_time(finished: Run) -> None:
    frames = (Frame(5.0, "before response", made.picture("b")), *finished.recording.frames)
    text = render([dataclasses.replace(finished, recording=dataclasses.replace(finished.recording, frames=frames))])
    times = [float(t) for t in re.findall(r"View ahead at ([0-9.]+) s", text)]
    assert len(times) == 4
    assert times == sorted(times)


def test_without_a_request_others_stand_as_at_the_end(finished: Run) -> None:
    quiet = dataclasses.replace(finished, recording=dataclasses.replace(finished.recording, events=()))
    text = re.sub(r"\s+", " ", Page(render([quiet])).text)
    assert "others as they stood at the end of the run." in text
    assert "stood at the request" not in text


def test_several_runs_have_a_table_that_leads_to_their_sections(several: Page) -> None:
    assert [r for r in several.references if r in ("#run-1", "#run-2")] == ["#run-1", "#run-2"]
    assert several.tags.count("article") == 2
    assert "No pictures were taken in this run." in several.text


def test_a_run_without_others_request_or_confidence_has_a_page(network: Network) -> None:
    def row(t: float) -> Row:
        pose = network.lane_pose("1", -1, 50 + 10 * t)
        return {"x": (pose.x,), "y": (pose.y,), "h": (pose.heading,), "v": (10.0,), "road": (0,), "lane": (-1,)}

    plan = made.plan().model_copy(update={"entities": made.plan().entities[:1], "classifications": ()})
    for rows in (0, 1, 30):
        recording = record(("ego",), rows, row)
        text = render([Run(plan, network, recording, judge(plan, recording))])
        assert "no takeover request" in text


def test_a_report_of_nothing_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="at least one run"):
        write_report([], tmp_path)


WRITE = """
import sys
from pathlib import Path
from scenario_compiler.report.folder import write_run_folder
from tests.report import made
write_run_folder(made.run(made.town(Path(sys.argv[1])), pictures=False), Path(sys.argv[2]))
"""


@pytest.mark.slow
def test_another_process_with_another_hash_seed_writes_the_same_bytes(
    repository: Path, tmp_path: Path, network: Network
) -> None:
    from scenario_compiler.report.folder import write_run_folder

    subprocess.run(
        [sys.executable, "-c", WRITE, str(repository), str(tmp_path / "a")],
        cwd=repository,
        env={"PYTHONHASHSEED": "77", "PATH": "/usr/bin:/bin"},
        check=True,
        timeout=120,
    )
    write_run_folder(made.run(network, pictures=False), tmp_path / "b")
    assert sorted(path.name for path in (tmp_path / "a").iterdir()) == sorted(made.RUN_FILES)
    for name in made.RUN_FILES:
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes(), name


def test_a_map_that_changed_during_the_run_is_left_out_of_its_folder(tmp_path: Path) -> None:
    from scenario_compiler.report.folder import write_run_folder

    changed = made.run(made.town(Path(__file__).resolve().parents[2]), pictures=False)
    changed.network.sha256 = "0" * 64
    write_run_folder(changed, tmp_path, report=False)
    assert {path.name for path in tmp_path.iterdir()} == set(made.RUN_FILES) - {"map.xodr", "report.html"}


def test_equal_runs_are_drawn_equally(finished: Run) -> None:
    assert render([finished]) == render([dataclasses.replace(finished)])
