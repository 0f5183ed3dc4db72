"""The description of a map (map.toml): its faults are reported in words for its author."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.resources import find_map
from scenario_compiler.roads.spawn_points import read_spawn_points

POINT = '[[spawn_point]]\nname = "a"\nroad = "1"\nlane = -1\ns = 20.0\n'


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (POINT.replace("lane = -1\n", "").encode(), "a [[spawn_point]] has no lane"),
        (POINT.replace("20.0", '"far"').encode(), "a [[spawn_point]] has a text instead of a number"),
        (b"spawn_point = 3", "a [[spawn_point]] has a text instead of a number, or is not a table"),
        (b"[[spawn_point", "it is not TOML"),
        (b"\xff\xfe", "it is not written in UTF-8"),
    ],
)
def test_faults_of_a_description_are_reported(tmp_path: Path, content: bytes, reason: str) -> None:
    (tmp_path / "map.toml").write_bytes(content)
    sink = Diagnostics()
    read_spawn_points(str(tmp_path / "map.xodr"), sink)
    assert [one.code.id for one in sink] == ["SC378"]
    assert reason in next(iter(sink)).message


def test_the_points_come_in_the_order_of_the_file(tmp_path: Path) -> None:
    (tmp_path / "map.toml").write_text(POINT.replace('"a"', '"b"') + POINT, encoding="utf-8")
    assert list(read_spawn_points(str(tmp_path / "map.xodr"), Diagnostics())) == ["b", "a"]


def test_a_copy_of_a_packaged_map_has_its_points_unless_it_is_described_or_changed(tmp_path: Path) -> None:
    original = find_map("town_grid")
    copy = tmp_path / "copy.xodr"
    shutil.copy(original, copy)
    points = read_spawn_points(str(original), Diagnostics())
    assert points
    assert read_spawn_points(str(copy), Diagnostics()) == points
    (tmp_path / "map.toml").write_text(POINT, encoding="utf-8")
    assert list(read_spawn_points(str(copy), Diagnostics())) == ["a"]
    (tmp_path / "map.toml").unlink()
    copy.write_bytes(copy.read_bytes() + b"\n")
    assert read_spawn_points(str(copy), Diagnostics()) == {}
