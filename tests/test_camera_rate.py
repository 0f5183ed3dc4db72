"""A camera with a rate of its own: between two images the last detection is kept."""

from __future__ import annotations

from itertools import groupby
from pathlib import Path

import numpy as np
import pytest

from scenario_compiler import Recording, open_world, run
from scenario_compiler.compiler import Overrides, compile_target
from scenario_compiler.diagnostics import Diagnostics, as_text
from scenario_compiler.vocabulary.sensors import Perception

FILE = """<scenarios version="1"><scenario name="rate" map="highway_loop" weather="HardRainNoon" duration="3">
<ego speed="20"><start><spawn_point name="straight"/></start><camera {rate} sensor_noise="8"/></ego>
<markings road="1" from="0" to="250" quality="1" quality_to="0"/>
<takeover><driver takeover_time="60"/></takeover></scenario></scenarios>"""


def played(folder: Path, rate: str, perception: Perception, duration: float = 3.0) -> Recording:
    path = folder / "rate.xml"
    path.write_text(FILE.format(rate=rate), encoding="utf-8")
    sink = Diagnostics()
    found = compile_target(path, {}, sink, overrides=Overrides(perception=perception, step=0.05, duration=duration))
    assert found is not None, [as_text(one) for one in sink]
    world = open_world("kinematic", found.plan, found.network)
    recording = run(found.plan, world, seed=1)
    world.close()
    return recording


@pytest.mark.parametrize("perception", ["camera", "ideal"])
def test_a_detection_is_kept_until_the_next_image(tmp_path: Path, perception: Perception) -> None:
    recording = played(tmp_path, 'rate="5"', perception)
    lengths = [len(list(same)) for _, same in groupby(recording.confidence_left[1:].tolist())]
    assert all(length % 4 == 0 for length in lengths)
    assert len(lengths) > (10 if perception == "camera" else 2)


def test_without_a_rate_there_is_one_image_per_control_step(tmp_path: Path) -> None:
    one, other = (played(tmp_path, rate, "camera", 1.0) for rate in ('rate="20"', ""))
    assert one.trajectory_hash == other.trajectory_hash
    assert np.array_equal(one.confidence_left, other.confidence_left)


def test_between_images_the_car_keeps_its_lane(tmp_path: Path) -> None:
    recording = played(tmp_path, 'rate="4"', "camera")
    assert float(np.abs(recording.off[:, 0]).max()) < 0.3


def test_a_step_of_the_command_line_makes_a_rate_uneven(tmp_path: Path) -> None:
    (tmp_path / "rate.xml").write_text(FILE.format(rate='rate="20"'), encoding="utf-8")
    sink = Diagnostics()
    assert compile_target(tmp_path / "rate.xml", {}, sink, overrides=Overrides(step=0.04)) is None
    (found,) = [one for one in sink if one.code.id == "SC251"]
    assert found.hint == "even rates near it: 25 and 12.5"
