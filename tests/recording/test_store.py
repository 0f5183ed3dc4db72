"""A recording survives its file, and equal recordings give equal bytes."""

from __future__ import annotations

import contextlib
import json
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenario_compiler.recording.names import CAUSES, SOURCES, TAKEOVER_STATES, WISHES
from scenario_compiler.recording.recording import COLUMNS, Column, Header, Recording, RecordingBuilder
from scenario_compiler.recording.store import RecordingError, read_recording, write_recording

NUMBERS = st.floats(width=64, allow_nan=False, allow_infinity=False)
ROADS = ("4", "road with, comma", "0", "7")


def header(*entities: str) -> Header:
    return Header(
        plan_digest="d1",
        plan_name="cut_in",
        seed=7,
        step=0.05,
        entities=entities,
        perception="ideal",
        parameters={"gap": 12.5, "wet": True},
        versions={"numpy": "2"},
    )


def value_of(column: Column, entities: int) -> st.SearchStrategy[Any]:
    kinds: dict[str, st.SearchStrategy[Any]] = {
        "float": NUMBERS | st.just(float("nan")),
        "flag": st.integers(0, 1),
        "integer": st.integers(-9, 9),
        "road": st.integers(-1, len(ROADS) - 1),
        "entity": st.integers(-1, entities - 1),
        "state": st.sampled_from(sorted(TAKEOVER_STATES)),
        "cause": st.sampled_from(sorted(CAUSES)),
        "source": st.sampled_from(sorted(SOURCES)),
        "wish": st.sampled_from(sorted(WISHES)),
    }
    return kinds[column.kind]


@st.composite
def recordings(draw: st.DrawFn) -> Recording:
    entities = tuple(f"e{i}" for i in range(draw(st.integers(1, 3))))
    named = [c for c in COLUMNS if c.name != "t" and draw(st.booleans())]
    live: dict[str, list[float]] = {c.name: [0] * (len(entities) if c.per == "entity" else 1) for c in named}
    builder = RecordingBuilder(header(*entities), ROADS, live)
    for k in range(draw(st.integers(0, 5))):
        for c in named:
            live[c.name][:] = [draw(value_of(c, len(entities))) for _ in live[c.name]]
        if "present" in live and not any(live["present"]):
            live["present"][draw(st.integers(0, len(entities) - 1))] = 1
        builder.append(k * 0.05)
    for t in draw(st.lists(st.floats(0, 10), max_size=3)):
        message, value = draw(st.text(max_size=5)), draw(st.none() | st.floats(-5, 5))
        builder.event(t, draw(st.sampled_from(("warning", "collision"))), message=message, value=value)
        builder.frame(t, "request", draw(st.binary(max_size=9)))
    return builder.finish(draw(st.sampled_from(("duration", "error"))), draw(st.integers(0, 3)))


@given(recordings())
def test_what_is_read_is_what_was_written(tmp_path_factory: pytest.TempPathFactory, recording: Recording) -> None:
    path = tmp_path_factory.mktemp("recording") / "recording.parquet"
    write_recording(recording, path)
    back = read_recording(path)
    assert back == recording
    assert back.trajectory_hash == recording.trajectory_hash
    written = path.read_bytes()
    write_recording(back, path)
    assert path.read_bytes() == written


def two_rows(**changes: list[float]) -> Recording:
    columns: dict[str, list[float]] = {
        "present": [1, 1],
        "x": [1.0, 2.0],
        "h": [0.0, 1.0],
        "v": [5.0, 0.0],
        "road": [3, 1],
        "lane": [-1, 2],
        "towed_by": [-1, 0],
        "takeover_state": [0],
    }
    builder = RecordingBuilder(header("ego", "other"), ROADS, columns)
    builder.append(0.0)
    for name, values in changes.items():
        columns[name][:] = values
    builder.append(0.05)
    return builder.finish("duration")


def test_rows_of_an_absent_entity_are_left_out_and_codes_are_names(tmp_path: Path) -> None:
    write_recording(two_rows(present=[1, 0], takeover_state=[2]), tmp_path / "r.parquet")
    table = pq.read_table(tmp_path / "r.parquet").to_pydict()
    assert table["t"] == [0.0, 0.0, 0.05]
    assert table["name"] == ["ego", "other", "ego"]
    assert table["road"] == ["7", "road with, comma", "7"]
    assert table["towed_by"] == [None, "ego", None]
    assert table["takeover_state"] == ["automated", None, "request"]


def test_steps_without_the_first_vehicle_are_read_again(tmp_path: Path) -> None:
    """In OpenSCENARIO, the first vehicle may come late or be deleted."""
    recording = two_rows(present=[0, 1], x=[0.0, 3.0])
    write_recording(recording, tmp_path / "r.parquet")
    back = read_recording(tmp_path / "r.parquet")
    assert back.t.tolist() == [0.0, 0.05]
    assert back.x[:, 1].tolist() == [2.0, 3.0]
    assert back.present.tolist() == [[True, True], [False, True]]


def test_the_file_has_the_columns_and_their_units(tmp_path: Path) -> None:
    write_recording(two_rows(), tmp_path / "r.parquet")
    assert pq.read_schema(tmp_path / "r.parquet").names == [
        *("t", "name"),
        *(c.name for c in COLUMNS if c.name not in ("t", "present")),
    ]
    about = json.loads(pq.read_metadata(tmp_path / "r.parquet").metadata[b"scenario-compiler"])
    assert about["columns"]["v"]["unit"] == "m/s"


def test_roads_keep_only_those_that_occur_in_order_of_occurrence() -> None:
    recording = two_rows(road=[-1, 0])
    assert recording.roads == ("7", "road with, comma", "4")
    assert recording.road.tolist() == [[0, 1], [-1, 2]]


def test_headings_are_brought_into_one_turn() -> None:
    recording = two_rows(h=[-1e-20, 2 * np.pi])
    assert recording.h[1].tolist() == [0.0, 0.0]


def test_the_hash_tells_trajectories_apart_and_nothing_else() -> None:
    same = two_rows()
    assert same.trajectory_hash == two_rows(takeover_state=[2]).trajectory_hash
    assert same.trajectory_hash != two_rows(x=[1.0, np.nextafter(2.0, 3.0)]).trajectory_hash


def test_a_column_that_does_not_exist_or_does_not_fit_is_refused() -> None:
    with pytest.raises(ValueError, match="speed"):
        RecordingBuilder(header("ego"), ROADS, {"speed": [1.0]})
    with pytest.raises(ValueError, match="2 values instead of 1"):
        RecordingBuilder(header("ego"), ROADS, {"cause": [0, 0]})


def test_a_row_without_the_first_vehicle_has_no_values_of_it() -> None:
    recording = two_rows(present=[0, 1])
    assert recording.x[0, 0] == 1.0
    assert np.isnan(recording.x[1, 0])


@pytest.mark.parametrize("content", [b"", b"PAR1", b"no parquet at all"])
def test_a_file_that_is_not_a_recording_is_refused(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "r.parquet"
    path.write_bytes(content)
    with pytest.raises(RecordingError, match="not a recording"):
        read_recording(path)


def test_a_table_that_is_not_a_recording_is_refused(tmp_path: Path) -> None:
    pq.write_table(pa.table({"a": [1]}), tmp_path / "r.parquet")
    with pytest.raises(RecordingError, match="is not a recording"):
        read_recording(tmp_path / "r.parquet")


def test_a_recording_of_a_version_with_fewer_columns_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "r.parquet"
    write_recording(two_rows(), path)
    written = pq.read_table(path)
    pq.write_table(written.drop_columns(["towed_by"]).replace_schema_metadata(pq.read_metadata(path).metadata), path)
    with pytest.raises(RecordingError, match=r"lacks columns that this version needs \(towed_by\); repeat the run$"):
        read_recording(path)


def test_a_missing_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match=r"none.parquet cannot be read: No such file or directory$"):
        read_recording(tmp_path / "none.parquet")


@given(st.data())
def test_a_damaged_file_is_read_or_refused(tmp_path_factory: pytest.TempPathFactory, data: st.DataObject) -> None:
    path = tmp_path_factory.mktemp("damaged") / "r.parquet"
    write_recording(two_rows(), path)
    content = bytearray(path.read_bytes())
    at = data.draw(st.integers(0, len(content) - 1))
    content[at] = data.draw(st.integers(0, 255))
    path.write_bytes(content[: data.draw(st.integers(at, len(content)))])
    with contextlib.suppress(RecordingError):
        read_recording(path)


def test_metadata_of_another_shape_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "r.parquet"
    table = pa.table({"a": [1]}).replace_schema_metadata({"scenario-compiler": "[1]"})
    pq.write_table(table, path)
    with pytest.raises(RecordingError, match="not a recording"):
        read_recording(path)
