"""`report`, `frame`, `export-run`, `compare --html` and films, as a user sees them."""

from __future__ import annotations

import shutil
from importlib.util import find_spec
from pathlib import Path

import cv2
import pytest
from playwright.sync_api import Browser, expect

from scenario_compiler.recording.store import read_recording
from tests.browser import opened_page
from tests.command import call

LIBRARY = Path(__file__).parent.parent / "library"


@pytest.fixture(scope="module")
def run_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a run without a camera."""
    folder = tmp_path_factory.mktemp("runs") / "one"
    assert call("run", "obstacle_ahead", "--perception", "ideal", "--duration", "2", "-o", folder) == 0
    return folder


def test_a_frame_is_drawn_at_any_time(run_folder: Path, tmp_path: Path) -> None:
    for t in ("0", "1.23"):
        assert call("frame", run_folder, "--t", t, "-o", tmp_path / f"{t}.png") == 0
    images = [cv2.imread(str(tmp_path / f"{t}.png")) for t in ("0", "1.23")]
    assert images[0] is not None
    assert images[1] is not None
    assert images[0].shape == (480, 960, 3)
    assert (images[0] != images[1]).any()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("frame", "RUN", "--t", "9", "-o", "it.png"), "the run lasts from 0 to 2 s"),
        (("frame", "RUN", "--t", "1", "-o", "it.bmp"), "is drawn as .png"),
        (("export-run", "RUN"), "name a file"),
        (("report", "RUN", "--video", "it.avi"), ".mp4 or .gif"),
        (("export-run", "RUN", "--mcap", "RUN/recording.parquet"), "would be written over"),
        (("compare", "RUN", "RUN/recording.parquet", "--html", "it.html"), "shows run folders"),
    ],
)
def test_wrong_use_is_reported_in_one_line(
    run_folder: Path, words: tuple[str, ...], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert call(*(word.replace("RUN", str(run_folder)) for word in words)) == 2
    assert said in capsys.readouterr().err


def test_the_plan_of_another_run_is_a_finding(
    run_folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    mixed = tmp_path / "mixed"
    shutil.copytree(run_folder, mixed)
    assert (
        call("compile", f"{LIBRARY / 'conflicts' / 'obstacle_variants.xml'}#crossing_car", "-o", mixed / "plan.json")
        == 0
    )
    assert call("report", mixed) == 1
    assert "SC131" in (said := capsys.readouterr().err)
    assert "the recording of 'obstacle_ahead' has other entities than 'crossing_car'" in said


def test_a_report_gets_pictures_of_a_run_without_camera(run_folder: Path, browser: Browser) -> None:
    assert call("report", run_folder, "--camera") == 0
    with opened_page(browser, f"{(run_folder / 'report.html').as_uri()}#t=1.5") as page:
        expect(page.locator(".view figcaption")).to_have_text("View ahead at 1.40 s")
        page.wait_for_function("document.querySelector('.view img').naturalWidth === 640")


def test_two_folders_are_compared_in_a_page(run_folder: Path, tmp_path: Path, browser: Browser) -> None:
    page_file = tmp_path / "both.html"
    assert call("compare", run_folder, run_folder, "--html", page_file) == 0
    with opened_page(browser, page_file.as_uri()) as page:
        expect(page.locator("h1")).to_have_text("one and one")
        expect(page.locator(".pane")).to_have_count(2)


def test_a_run_is_filmed_and_exported(run_folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert call("report", run_folder, "--video", tmp_path / "it.gif", "--video-shows", "view") == 0
    assert (tmp_path / "it.gif").read_bytes()[:4] == b"GIF8"
    target = (*("run", "obstacle_ahead", "--perception", "ideal", "--duration", "1"), "--video", tmp_path / "it.mp4")
    assert call(*target) == 0
    assert (tmp_path / "it.mp4").read_bytes()[4:8] == b"ftyp"
    assert call("export-run", run_folder, "--mcap", tmp_path / "it.mcap") == 0
    assert (tmp_path / "it.mcap").read_bytes()[:5] == b"\x89MCAP"
    assert "it.mcap" in capsys.readouterr().out


@pytest.mark.skipif(find_spec("rerun") is not None, reason="the extra rerun is installed")
def test_nothing_is_exported_if_one_of_the_formats_lacks_its_extra(
    run_folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    mcap = tmp_path / "it.mcap"
    assert call("export-run", run_folder, "--mcap", mcap, "--rerun", tmp_path / "it.rrd") == 2
    assert "this needs rerun" in capsys.readouterr().err
    assert not mcap.exists()


ALONE = """\
<OpenSCENARIO>
  <FileHeader revMajor="1" revMinor="2" date="2025-01-01T00:00:00" description="" author=""/>
  <ParameterDeclarations/><CatalogLocations/>
  <RoadNetwork><LogicFile filepath="motorway"/></RoadNetwork>
  <Entities>{entities}</Entities>
  <Storyboard>
    <Init><Actions>{init}</Actions></Init>
    <Story name="s"><Act name="a">
      <ManeuverGroup name="m" maximumExecutionCount="1">
        <Actors selectTriggeringEntities="false"/>
        <Maneuver name="m">{events}</Maneuver>
      </ManeuverGroup>
      <StartTrigger/>
    </Act></Story>
    <StopTrigger>{stop}</StopTrigger>
  </Storyboard>
</OpenSCENARIO>
"""

CAR = """
<ScenarioObject name="{0}">
  <Vehicle name="car" vehicleCategory="car">
    <BoundingBox><Center x="1.4" y="0" z="0.75"/><Dimensions width="1.8" length="4.5" height="1.5"/></BoundingBox>
    <Performance maxSpeed="60" maxAcceleration="5" maxDeceleration="9"/>
    <Axles>
      <FrontAxle maxSteering="0.5" wheelDiameter="0.6" trackWidth="1.6" positionX="2.8" positionZ="0.3"/>
      <RearAxle maxSteering="0" wheelDiameter="0.6" trackWidth="1.6" positionX="0" positionZ="0.3"/>
    </Axles>
    <Properties/>
  </Vehicle>
</ScenarioObject>
"""

PUT = """
<Private entityRef="{0}"><PrivateAction><TeleportAction>
  <Position><LanePosition roadId="1" laneId="-1" s="{1}" offset="0"/></Position>
</TeleportAction></PrivateAction></Private>
"""

AFTER = """
<ConditionGroup><Condition name="c" delay="0" conditionEdge="none"><ByValueCondition>
  <SimulationTimeCondition value="{0}" rule="greaterThan"/>
</ByValueCondition></Condition></ConditionGroup>
"""

DELETED = """
<Event name="e" priority="parallel">
  <Action name="a">
    <GlobalAction><EntityAction entityRef="first"><DeleteEntityAction/></EntityAction></GlobalAction>
  </Action>
  <StartTrigger>{0}</StartTrigger>
</Event>
"""


def scripted(folder: Path, *names: str, deleted: bool = False) -> Path:
    """Write a run of 0.4 s in OpenSCENARIO with standing cars, of which the first may be deleted after 0.2 s."""
    file = folder / "scripted.xosc"
    text = ALONE.format(
        entities="".join(CAR.format(name) for name in names),
        init="".join(PUT.format(name, 50 + 20 * k) for k, name in enumerate(names)),
        events=DELETED.format(AFTER.format(0.2)) if deleted else "",
        stop=AFTER.format(0.4),
    )
    file.write_text(text, encoding="utf-8")
    return file


def test_a_run_without_vehicles_has_no_pictures_and_says_so(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = scripted(tmp_path)
    for words in (("--video", tmp_path / "it.mp4"), ("--watch",)):
        assert call("run", file, *words) == 2
        assert "this scenario has no entity" in capsys.readouterr().err
    out = tmp_path / "out"
    assert call("run", file, "-o", out) == 0
    assert call("compare", out, out, "--html", tmp_path / "both.html") == 2
    assert "one of these has no vehicle" in capsys.readouterr().err


def test_a_run_whose_first_vehicle_is_deleted_is_kept_without_its_film(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    file = scripted(tmp_path, "first", "other", deleted=True)
    assert call("run", file, "-o", out, "--video", tmp_path / "it.mp4") == 2
    assert "absent for a part of this run" in capsys.readouterr().err
    stored = read_recording(out / "recording.parquet")
    assert (stored.present[0].tolist(), stored.present[-1].tolist()) == ([True, True], [False, True])
    assert stored.t[-1] > 0.4
    before = (out / "report.html").read_bytes()
    assert call("report", out) == 0
    assert (out / "report.html").read_bytes() == before


def test_a_gallery_is_searched_and_filtered(tmp_path: Path, browser: Browser) -> None:
    page_file = tmp_path / "gallery.html"
    conflicts = LIBRARY / "conflicts"
    assert call("list", conflicts / "obstacle_ahead.xml", conflicts / "road_narrows.xml", "--html", page_file) == 0
    assert str(LIBRARY.parent) not in page_file.read_text(encoding="utf-8")
    with opened_page(browser, page_file.as_uri()) as page:
        cards = page.locator(".cards li:visible")
        everything = cards.count()
        assert everything >= 2
        page.get_by_label("Search").fill("obstacle BROKEN-down")
        expect(cards).to_have_count(1)
        expect(cards).to_contain_text("takeover request after")
        expect(cards).to_contain_text("scenario-compiler run obstacle_ahead")
        page.get_by_label("Search").fill("")
        page.get_by_label("File").select_option("road narrows")
        assert 0 < cards.count() < everything
        page.get_by_label("Search").fill("no such thing")
        expect(page.locator("#none")).to_be_visible()
