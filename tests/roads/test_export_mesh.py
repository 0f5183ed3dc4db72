"""Meshes: the files keep the rules of glTF 2.0 and of OBJ, and hold the network's surface and marks."""

from __future__ import annotations

import base64
import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from numpy.typing import NDArray

from scenario_compiler.roads import mesh
from scenario_compiler.roads.export_mesh import FORMATS, LAYER_STEP, MARK_LIFT, build_groups, export_mesh
from scenario_compiler.roads.network import Network, load_network
from scenario_compiler.roads.positions import MarkStretch
from tests.roads.make import shifted

SIZES = {5125: 4, 5126: 4}
COMPONENTS = {"SCALAR": 1, "VEC3": 3}


@pytest.fixture(scope="module")
def town(repository: Path) -> Network:
    network = load_network(repository / "maps/town_grid/town_grid.xodr", cache=False)
    assert network is not None
    return network


def read_glb(data: bytes) -> tuple[dict[str, Any], bytes]:
    """Take a binary file apart by the rules of its container."""
    magic, version, length = struct.unpack_from("<4sII", data)
    assert (magic, version, length) == (b"glTF", 2, len(data))
    at, chunks = 12, []
    while at < length:
        size, kind = struct.unpack_from("<I4s", data, at)
        assert size % 4 == 0
        chunks.append((kind, data[at + 8 : at + 8 + size]))
        at += 8 + size
    assert [kind for kind, _ in chunks] == [b"JSON", b"BIN\0"]
    return json.loads(chunks[0][1]), chunks[1][1]


def arrays_of(document: dict[str, Any], data: bytes) -> list[NDArray[Any]]:
    """Read every accessor, checking what the standard asks of views, counts and bounds."""
    assert document["asset"]["version"] == "2.0"
    assert document["buffers"][0]["byteLength"] == len(data)
    found = []
    for accessor in document["accessors"]:
        view = document["bufferViews"][accessor["bufferView"]]
        size, width = SIZES[accessor["componentType"]], COMPONENTS[accessor["type"]]
        assert view["byteOffset"] % size == 0
        assert view["byteOffset"] + view["byteLength"] <= len(data)
        assert accessor["count"] * size * width == view["byteLength"]
        kind = np.dtype("<f4") if accessor["componentType"] == 5126 else np.dtype("<u4")
        array = np.frombuffer(data, kind, accessor["count"] * width, view["byteOffset"]).reshape(-1, width)
        if "min" in accessor:
            assert accessor["min"] == array.min(axis=0).tolist()
            assert accessor["max"] == array.max(axis=0).tolist()
        found.append(array)
    return found


def triangles_of(document: dict[str, Any], data: bytes) -> dict[str, NDArray[np.float64]]:
    """Return the corners (N, 3, 3) of each mesh's triangles by its name."""
    arrays = arrays_of(document, data)
    found = {}
    for one in document["meshes"]:
        (primitive,) = one["primitives"]
        points, index = arrays[primitive["attributes"]["POSITION"]], arrays[primitive["indices"]].ravel()
        assert document["accessors"][primitive["attributes"]["POSITION"]]["type"] == "VEC3"
        assert index.max() < len(points)
        assert len(index) % 3 == 0
        assert document["materials"][primitive["material"]]["name"] == one["name"]
        found[one["name"]] = points[index].reshape(-1, 3, 3).astype(np.float64)
    return found


def ground_areas(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Area of each triangle seen from above (glTF's +y), positive when its front looks up."""
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area: NDArray[np.float64] = (a[:, 2] * b[:, 0] - a[:, 0] * b[:, 2]) / 2.0
    return area


def quad_area(quads: NDArray[np.float32]) -> float:
    x, y = quads[:, :, 0].astype(np.float64), quads[:, :, 1].astype(np.float64)
    crosses = x * np.roll(y, -1, axis=1) - np.roll(x, -1, axis=1) * y
    return float(np.abs(crosses.sum(axis=1)).sum() / 2.0)


def test_glb_keeps_the_rules_and_the_surface(town: Network, tmp_path: Path) -> None:
    assert export_mesh(town, tmp_path / "town.glb") == [tmp_path / "town.glb"]
    found = triangles_of(*read_glb((tmp_path / "town.glb").read_bytes()))
    assert list(found) == ["lane driving", "lane shoulder", "lane sidewalk", "mark white 100"]
    surface, marks = mesh.road_surface(town), mesh.road_marks(town)
    lanes = sum(ground_areas(corners).sum() for name, corners in found.items() if name.startswith("lane"))
    assert lanes == pytest.approx(quad_area(surface.quads), rel=1e-4)
    assert ground_areas(found["mark white 100"]).sum() == pytest.approx(quad_area(marks.quads), rel=1e-3)
    assert all((ground_areas(corners) > -1e-3).all() for corners in found.values())


def test_bounds_are_the_networks(town: Network, tmp_path: Path) -> None:
    export_mesh(town, tmp_path / "town.glb")
    found = triangles_of(*read_glb((tmp_path / "town.glb").read_bytes()))
    corners = np.concatenate([found[name].reshape(-1, 3) for name in found if name.startswith("lane")])
    x0, y0, x1, y1 = town.bounds()
    low, high = corners.min(axis=0), corners.max(axis=0)
    assert (low[0], high[0]) == pytest.approx((x0, x1), abs=0.05)
    assert (-high[2], -low[2]) == pytest.approx((y0, y1), abs=0.05)
    assert low[1] >= -3 * LAYER_STEP - 1e-6
    assert high[1] <= 1e-6
    assert found["mark white 100"][:, :, 1].min() == pytest.approx(MARK_LIFT)


def test_text_form_holds_the_same_as_the_binary_one(town: Network, tmp_path: Path) -> None:
    export_mesh(town, tmp_path / "town.glb")
    export_mesh(town, tmp_path / "town.gltf")
    document, data = read_glb((tmp_path / "town.glb").read_bytes())
    text = json.loads((tmp_path / "town.gltf").read_text(encoding="utf-8"))
    uri = text["buffers"][0].pop("uri")
    assert base64.b64decode(uri.removeprefix("data:application/octet-stream;base64,")) == data
    assert text == document


@pytest.mark.parametrize("ending", FORMATS)
def test_an_independent_reader_agrees(town: Network, tmp_path: Path, ending: str) -> None:
    export_mesh(town, tmp_path / f"town{ending}")
    scene = trimesh.load_scene(tmp_path / f"town{ending}", group_material=False, split_objects=True)
    groups = {group.name.replace(" ", "_"): group for group in build_groups(town)}
    found = {name.replace(" ", "_"): one for name, one in scene.geometry.items()}
    assert set(found) == set(groups)
    for name, group in groups.items():
        assert len(found[name].faces) == len(group.triangles)
        assert (found[name].face_normals[:, 1] > 0.9).all()
    lanes = sum(one.area for name, one in found.items() if name.startswith("lane"))
    assert lanes == pytest.approx(quad_area(mesh.road_surface(town).quads), rel=1e-3)


@pytest.mark.parametrize("ending", FORMATS)
def test_a_map_far_out_is_as_fine_and_lies_where_it_is(
    town: Network, repository: Path, tmp_path: Path, ending: str
) -> None:
    text = (repository / "maps/town_grid/town_grid.xodr").read_text(encoding="utf-8")
    (tmp_path / "far.xodr").write_text(shifted(text, 500_000.0, 5_400_000.0), encoding="utf-8")
    far = load_network(tmp_path / "far.xodr", cache=False)
    assert far is not None
    export_mesh(far, tmp_path / f"far{ending}")
    scene = trimesh.load_scene(tmp_path / f"far{ending}")
    (x0, _, z0), (x1, _, z1) = scene.bounds
    assert (x0, -z1, x1, -z0) == pytest.approx(far.bounds(), abs=0.05)
    export_mesh(town, tmp_path / f"town{ending}")
    here = trimesh.load_scene(tmp_path / f"town{ending}").geometry
    for name, one in here.items():
        there = scene.geometry[name]
        assert there.area == pytest.approx(one.area, rel=1e-4)
        assert np.ptp(there.bounds, axis=0) == pytest.approx(np.ptp(one.bounds, axis=0), abs=1e-3)


def test_quality_of_marks_becomes_steps_of_opacity(town: Network, tmp_path: Path) -> None:
    worn = town.with_mark_quality([MarkStretch("1", None, 0.0, 200.0, 1.0, 0.0)])
    export_mesh(worn, tmp_path / "town.glb")
    document, _ = read_glb((tmp_path / "town.glb").read_bytes())
    marks = {one["name"]: one for one in document["materials"] if one["name"].startswith("mark")}
    assert len(marks) == 10
    faint = marks["mark white 30"]
    assert faint["pbrMetallicRoughness"]["baseColorFactor"][3] == pytest.approx(0.3)
    assert faint["alphaMode"] == "BLEND"
    assert "alphaMode" not in marks["mark white 100"]


def test_obj_has_the_same_triangles(town: Network, tmp_path: Path) -> None:
    files = export_mesh(town, tmp_path / "town.obj")
    assert [path.name for path in files] == ["town.obj", "town.mtl"]
    lines = [line.split() for line in files[0].read_text(encoding="utf-8").splitlines()]
    points = np.array([line[1:] for line in lines if line[0] == "v"], np.float64)
    faces = np.array([line[1:] for line in lines if line[0] == "f"], np.int64) - 1
    groups = build_groups(town)
    assert len(faces) == sum(len(group.triangles) for group in groups)
    assert faces.max() == len(points) - 1
    area = sum(ground_areas(group.points[group.triangles].astype(np.float64)).sum() for group in groups)
    assert ground_areas(points[faces]).sum() == pytest.approx(area, rel=1e-3)
    used = [line[1] for line in lines if line[0] == "usemtl"]
    assert used == [
        line.split()[1] for line in files[1].read_text(encoding="utf-8").splitlines() if line.startswith("newmtl")
    ]


@pytest.mark.parametrize("ending", FORMATS)
def test_equal_networks_give_equal_bytes(town: Network, tmp_path: Path, ending: str) -> None:
    for folder in ("one", "other"):
        (tmp_path / folder).mkdir()
        export_mesh(town, tmp_path / folder / f"town{ending}")
    assert (tmp_path / f"one/town{ending}").read_bytes() == (tmp_path / f"other/town{ending}").read_bytes()


def test_an_unknown_ending_is_refused(town: Network, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"not as '\.fbx'"):
        export_mesh(town, tmp_path / "town.fbx")


def test_hills_keep_their_height(corpus: Path, tmp_path: Path) -> None:
    network = load_network(corpus / "Scenic/assets/maps/CARLA/Town04.xodr", cache=False)
    assert network is not None
    export_mesh(network, tmp_path / "town.glb")
    found = triangles_of(*read_glb((tmp_path / "town.glb").read_bytes()))
    driving = found["lane driving"].reshape(-1, 3)
    for x, y, z in driving[:: len(driving) // 50].tolist():
        held = network.locate(x, -z, nearest=True)
        heights = [network.lane_pose(one.road, one.lane, one.s, one.offset).z for one in held]
        assert min(abs(height - y) for height in heights) < 0.02
    assert driving[:, 1].max() > 10.0
    assert "mark yellow 100" in found
    assert "verge" in found
