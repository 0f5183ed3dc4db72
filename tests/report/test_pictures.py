"""Pictures of a recorded run equal those that the world would have drawn; films and other formats."""

from __future__ import annotations

import io
import json
import math
from pathlib import Path

import av
import numpy as np
import pytest
from mcap.reader import make_reader
from numpy.typing import NDArray

from scenario_compiler.compiler import Overrides, compile_target
from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.engine.columns.state import make_draws
from scenario_compiler.engine.program.build import lowered
from scenario_compiler.engine.simulation import Simulation
from scenario_compiler.recording.outcome import judge
from scenario_compiler.report.mcap_file import write_mcap
from scenario_compiler.report.pictures import Sights, camera_pictures, row_at, stills
from scenario_compiler.report.replay import Picture, pictures_of
from scenario_compiler.report.run import Run
from scenario_compiler.report.video import BAR, write_video
from scenario_compiler.roads import Pose
from scenario_compiler.runtime import open_world
from scenario_compiler.runtime.loop import run
from scenario_compiler.vocabulary.weather import weather_of
from scenario_compiler.worlds.model import EntityState, Snapshot

CONFLICT = """\
<scenarios version="1">
  <scenario name="rain" map="town_grid" weather="ClearNoon" duration="0.6">
    <ego speed="13.9"><start><lane road="3" lane="-1" s="20"/></start></ego>
    <static id="blocker" model="vehicle.audi.tt"><at><ahead_of entity="ego" distance="60"/></at></static>
    <dynamic id="oncoming" model="vehicle.tesla.model3" speed="11">
      <start><lane road="3" lane="1" s="150"/></start>
    </dynamic>
    <when><time after="0.1"/><do><weather preset="HardRainSunset" over_time="0.4"/></do></when>
  </scenario>
</scenarios>
"""


@pytest.fixture(scope="module")
def rain(tmp_path_factory: pytest.TempPathFactory) -> Run:
    """A short run in which rain begins."""
    file = tmp_path_factory.mktemp("rain") / "rain.xml"
    file.write_text(CONFLICT, encoding="utf-8")
    compiled = compile_target(str(file), {}, Diagnostics(), overrides=Overrides(perception="ideal"))
    assert compiled is not None
    plan, network = compiled.plan, compiled.network
    with open_world("kinematic", plan, network) as world:
        recording = run(plan, world, 1)
    return Run(plan, network, recording, judge(plan, recording))


def as_it_was(of: Run, row: int) -> Snapshot:
    """Return a run as it was at a row, from running it again as a whole."""
    program = lowered(of.plan, of.network)
    simulation = Simulation(of.network.tables, program.program)
    simulation.reset(make_draws(1, 0))
    for _ in range(row):
        simulation.step()
    st = simulation.state
    entities = tuple(
        EntityState(
            True, True, Pose(st.x[i], st.y[i], st.z[i], st.h[i], st.pitch[i], st.roll[i]), braking=st.a[i] < -1.3
        )
        for i in range(len(of.plan.entities))
    )
    return Snapshot(st.clock[0], row, entities, weather=weather_of(st.weather))


def test_a_row_has_the_state_of_the_run_at_that_time(rain: Run) -> None:
    for still in stills(rain, [0, 3, 10, len(rain.recording.t) - 1]):
        known = as_it_was(rain, still.row)
        assert [number for number, _, _ in still.there] == [0, 1, 2]
        for _, pose, _ in still.there:
            assert any(
                pose[:3] == other[:3] and math.cos(pose.heading - other.heading) > 1 - 1e-9 for other in known.poses
            )
        assert still.weather == known.weather
    assert as_it_was(rain, 0).weather != as_it_was(rain, len(rain.recording.t) - 1).weather


def test_a_picture_is_what_the_world_would_have_drawn(rain: Run) -> None:
    """But for the outline of what blocks the path."""
    known = as_it_was(rain, 10)
    with open_world("kinematic", rain.plan, rain.network) as world:
        world.reset(as_it_was(rain, 0), 1)
        expected = world.picture(known)
    shown = Sights(rain).draw(next(stills(rain, [10])))
    different = (shown != expected).any(axis=2)
    assert 0 < different.mean() < 0.02
    assert not different[300:].any()


def test_pictures_of_a_page_show_even_times_and_moments(rain: Run) -> None:
    taken = camera_pictures(rain, per_second=2.0, width=320)
    times = [one.t for one in taken]
    assert times == sorted(times)
    assert {0.0, 0.5} <= {round(t, 6) for t in times}
    assert {one.label for one in taken if one.label} == {kind for kind, _ in rain.moments}
    assert taken[0].data[8:12] == b"WEBP"


@pytest.mark.parametrize(("ending", "rate", "height"), [(".mp4", 25, 480), (".gif", 5, 240)])
def test_a_film_lasts_as_long_as_its_run(rain: Run, tmp_path: Path, ending: str, rate: int, height: int) -> None:
    path = tmp_path / f"film{ending}"
    write_video(rain, path, "map" if ending == ".gif" else "view")
    pictures = decoded(path)
    assert len(pictures) == round(0.6 * rate) + 1
    assert pictures[0].shape == (height + BAR, height if ending == ".gif" else 2 * height, 3)
    if ending == ".mp4":
        darker = pictures[0][: height // 2].mean() - pictures[-1][: height // 2].mean()
        assert darker > 20


def test_a_film_is_vp9_where_there_is_no_encoder_of_h264(
    rain: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(av, "codecs_available", av.codecs_available - {"libx264"})
    write_video(rain, tmp_path / "film.mp4", "map")
    with av.open(str(tmp_path / "film.mp4")) as film:
        assert film.streams.video[0].codec_context.name == "vp9"
    first, *_, last = decoded(tmp_path / "film.mp4")
    assert first[:480].mean() - last[:480].mean() > 20


def decoded(path: Path) -> list[NDArray[np.uint8]]:
    with av.open(str(path)) as film:
        return [np.asarray(frame.to_ndarray(format="rgb24"), np.uint8) for frame in film.decode(video=0)]


def test_a_film_of_another_kind_is_refused(finished: Run, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"\.avi"):
        write_video(finished, tmp_path / "it.avi")


def test_times_before_and_after_a_run_are_its_ends(finished: Run) -> None:
    assert row_at(finished, -1.0) == 0
    assert row_at(finished, 0.12) == 2
    assert row_at(finished, 99.0) == len(finished.recording.t) - 1


def test_an_mcap_file_has_every_row_event_and_picture(finished: Run, tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    write_mcap(finished, path, pictures_of(finished))
    reader = make_reader(io.BytesIO(path.read_bytes()))
    found = [
        (channel.topic, message.log_time, json.loads(message.data)) for _, channel, message in reader.iter_messages()
    ]
    by_topic = {topic: [one for one in found if one[0] == topic] for topic in {one[0] for one in found}}
    recording = finished.recording
    rows = len(recording.t)
    assert {topic: len(held) for topic, held in by_topic.items()} == {
        "/scene": rows,
        "/values": rows,
        "/takeover": rows,
        "/log": len(recording.events),
        "/camera": len(recording.frames),
    }
    _, time, scene = by_topic["/scene"][80]
    assert time == 4_000_000_000
    ego = next(one for one in scene["entities"] if one["id"] == "ego")
    vehicle = finished.plan.entities[0].vehicle
    ahead = np.array([np.cos(recording.h[80, 0]), np.sin(recording.h[80, 0])]) * vehicle.center
    place = ego["cubes"][0]["pose"]["position"]
    assert (place["x"], place["y"]) == pytest.approx((recording.x[80, 0] + ahead[0], recording.y[80, 0] + ahead[1]))
    assert by_topic["/takeover"][0][2] == {"state": "automated", "cause": ""}


def test_equal_runs_give_equal_mcap_files(finished: Run, tmp_path: Path) -> None:
    nothing: tuple[Picture, ...] = ()
    for name in ("a", "b"):
        write_mcap(finished, tmp_path / name, nothing)
    assert (tmp_path / "a").read_bytes() == (tmp_path / "b").read_bytes()
