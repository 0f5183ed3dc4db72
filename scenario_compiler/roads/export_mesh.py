"""A network as a mesh for other programs: binary or text glTF 2.0 (.glb, .gltf), or Wavefront OBJ with its MTL (.obj).

Lane surfaces are grouped by lane type, marks by colour and quality; each group is a mesh of one material, named after
it ("lane driving", "mark white 70"). Metres. The axes are glTF's: x stays east, up is y, so that OpenDRIVE's (x, y, z)
becomes (x, z, -y); importers that use z as up (Blender, Unreal) turn it back. Front faces look up.

The points of a glTF file have single precision, so those of a map far from the world's origin count from an origin of
their own (`mesh.mesh_origin`), which is the translation of the scene's root node. An OBJ file is text, in world
coordinates.

Surfaces of one height would flicker where they overlap, as lanes in junctions do: each layer below the carriageway lies
`LAYER_STEP` lower, the marks `MARK_LIFT` higher. A mark's quality is the opacity of its material.
"""

from __future__ import annotations

import base64
import json
import struct
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from scenario_compiler.outputs import write_whole
from scenario_compiler.roads import lanes, mesh
from scenario_compiler.roads.lane_types import LANE_TYPES
from scenario_compiler.roads.network import Network

LAYER_STEP = 0.003
"""Distance of a layer of the surface below the one on top of it, m."""

MARK_LIFT = 0.005
"""Height of marks above the surface, m."""

QUALITY_STEPS = 10
"""Number of steps of a mark's quality from gone (which is left out) to new; a mark has the nearest one."""

FORMATS = (".glb", ".gltf", ".obj")
"""The suffixes of the file's name, which determine the format."""

Colour = tuple[float, float, float, float]

_ROAD: Colour = (0.055, 0.055, 0.06, 1.0)
_SURFACES: dict[str, Colour] = {
    "shoulder": (0.085, 0.08, 0.075, 1.0),
    "border": (0.085, 0.08, 0.075, 1.0),
    "restricted": (0.085, 0.08, 0.075, 1.0),
    "stop": (0.07, 0.07, 0.07, 1.0),
    "parking": (0.09, 0.09, 0.1, 1.0),
    "median": (0.06, 0.13, 0.04, 1.0),
    "biking": (0.22, 0.05, 0.04, 1.0),
    "sidewalk": (0.3, 0.29, 0.27, 1.0),
    "walking": (0.3, 0.29, 0.27, 1.0),
    "curb": (0.35, 0.35, 0.34, 1.0),
    "rail": (0.12, 0.1, 0.09, 1.0),
    "tram": (0.2, 0.2, 0.2, 1.0),
    "none": (0.08, 0.12, 0.05, 1.0),
    "verge": (0.06, 0.12, 0.04, 1.0),
}
"""Linear RGB and opacity of lane types other than those that motor traffic uses."""

_PAINTS: dict[mesh.Paint, tuple[float, float, float]] = {
    mesh.Paint.WHITE: (0.8, 0.8, 0.8),
    mesh.Paint.YELLOW: (0.75, 0.47, 0.02),
    mesh.Paint.BLUE: (0.03, 0.12, 0.5),
    mesh.Paint.GREEN: (0.03, 0.3, 0.08),
    mesh.Paint.RED: (0.5, 0.03, 0.03),
    mesh.Paint.ORANGE: (0.75, 0.22, 0.02),
    mesh.Paint.VIOLET: (0.25, 0.04, 0.35),
    mesh.Paint.BLACK: (0.01, 0.01, 0.01),
}


@dataclass(frozen=True, eq=False)
class Group:
    """Triangles of one material.

    Attributes:
        name: Of the mesh and of the material.
        colour: Linear RGB and opacity.
        points: (N, 3) float32, glTF's axes, m from the mesh's origin.
        triangles: (M, 3) uint32 rows of `points`, counter-clockwise as seen from above.
    """

    name: str
    colour: Colour
    points: NDArray[np.float32]
    triangles: NDArray[np.uint32]


def export_mesh(network: Network, path: str | Path) -> list[Path]:
    """Write the mesh of a network in the format of the path's suffix; return the written files.

    Args:
        network: With the quality of its marks (`Network.with_mark_quality`).
        path: A file in an existing folder. The MTL file of an OBJ file is beside it, with the same name.

    Raises:
        ValueError: The suffix is not one of `FORMATS`.
        OSError: A file cannot be written.
    """
    target = Path(path)
    ending = target.suffix.lower()
    if ending not in FORMATS:
        raise ValueError(f"a mesh is written as {', '.join(FORMATS)}, not as '{target.suffix}'")
    groups = build_groups(network)
    if ending == ".obj":
        materials = target.with_suffix(".mtl")
        text = _obj(network.name, materials.name, groups, _world_to_gltf(mesh.mesh_origin(network)))
        write_whole(target, text)
        write_whole(materials, _mtl(groups))
        return [target, materials]
    document, data = _gltf(network, groups)
    write_whole(target, _glb(document, data) if ending == ".glb" else _text_gltf(document, data))
    return [target]


def build_groups(network: Network) -> list[Group]:
    """Return lane surfaces by type in the standard's order, the verge, and marks by colour and quality."""
    surface = mesh.road_surface(network)
    types = _lane_types(network, surface)
    drop = LAYER_STEP * (int(max(surface.layer, default=0)) - surface.layer.astype(np.float32))
    groups = []
    for code, name in enumerate((*LANE_TYPES, "verge")):
        chosen = types == code
        colour = _SURFACES.get(name, _ROAD)
        title = "verge" if name == "verge" else f"lane {name}"
        groups.append(_group(title, colour, surface.quads[chosen], -drop[chosen]))
    marks = mesh.road_marks(network)
    steps = np.rint(np.clip(marks.quality, 0.0, 1.0) * QUALITY_STEPS).astype(np.int64)
    for paint in mesh.Paint:
        for step in range(QUALITY_STEPS, 0, -1):
            quads = marks.quads[(marks.colour == paint) & (steps == step)]
            title = f"mark {paint.name.lower()} {100 * step // QUALITY_STEPS}"
            colour = (*_PAINTS[paint], step / QUALITY_STEPS)
            groups.append(_group(title, colour, quads, np.full(len(quads), MARK_LIFT, np.float32)))
    return [group for group in groups if len(group.triangles)]


def _lane_types(network: Network, surface: mesh.Surface) -> NDArray[np.int64]:
    """Return the code of each piece's lane type; the number of types stands for the verge."""
    n = network.tables
    middle = surface.s.mean(axis=1)
    found = [
        len(LANE_TYPES) if lane == 0 else lanes.lane_type(n, road, lane, s)
        for road, lane, s in zip(surface.road.tolist(), surface.lane.tolist(), middle.tolist(), strict=True)
    ]
    return np.array(found, np.int64)


def _group(name: str, colour: Colour, quads: NDArray[np.float32], lift: NDArray[np.float32]) -> Group:
    """Turn quads into triangles over shared points; triangles without area are left out."""
    corners = quads.astype(np.float64)
    corners[:, :, 2] += lift[:, None]
    flat = _world_to_gltf(corners.reshape(-1, 3)).astype(np.float32)
    points, index = np.unique(flat, axis=0, return_inverse=True)
    a, b, c, d = index.reshape(-1, 4).T
    triangles = np.concatenate([np.stack([a, d, c], axis=1), np.stack([a, c, b], axis=1)])
    full = (triangles != np.roll(triangles, 1, axis=1)).all(axis=1)
    return Group(name, colour, points, triangles[full].astype(np.uint32))


def _world_to_gltf(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return points (..., 3) of OpenDRIVE's axes (x, y, z) as (x, z, -y), without negative zeros."""
    turned: NDArray[np.float64] = points[..., (0, 2, 1)] * (1.0, 1.0, -1.0) + 0.0
    return turned


def _gltf(network: Network, groups: list[Group]) -> tuple[dict[str, object], bytes]:
    """Return the glTF document without its buffer's place, and the buffer."""
    chunks: list[bytes] = []
    views: list[dict[str, int]] = []
    accessors: list[dict[str, object]] = []

    def store(array: NDArray[np.float32] | NDArray[np.uint32], target: int) -> int:
        data = array.astype(array.dtype.newbyteorder("<")).tobytes()
        offset = sum(view["byteLength"] for view in views)
        views.append({"buffer": 0, "byteOffset": offset, "byteLength": len(data), "target": target})
        chunks.append(data)
        return len(views) - 1

    meshes = []
    for material, group in enumerate(groups):
        position: dict[str, object] = {
            "bufferView": store(group.points, ARRAY_BUFFER),
            "componentType": FLOAT,
            "count": len(group.points),
            "type": "VEC3",
            "min": [float(v) for v in group.points.min(axis=0)],
            "max": [float(v) for v in group.points.max(axis=0)],
        }
        index: dict[str, object] = {
            "bufferView": store(group.triangles, ELEMENT_ARRAY_BUFFER),
            "componentType": UNSIGNED_INT,
            "count": group.triangles.size,
            "type": "SCALAR",
        }
        accessors += [position, index]
        primitive = {"attributes": {"POSITION": 2 * material}, "indices": 2 * material + 1, "material": material}
        meshes.append({"name": group.name, "primitives": [primitive]})
    nodes: list[dict[str, object]] = [{"name": network.name}]
    origin = _world_to_gltf(mesh.mesh_origin(network)).tolist()
    if any(origin):
        nodes[0]["translation"] = origin
    if groups:
        nodes[0]["children"] = list(range(1, len(groups) + 1))
    nodes += [{"name": group.name, "mesh": k} for k, group in enumerate(groups)]
    document: dict[str, object] = {
        "asset": {"version": "2.0", "generator": "scenario-compiler", "extras": {"sha256": network.sha256}},
        "scene": 0,
        "scenes": [{"name": network.name, "nodes": [0]}],
        "nodes": nodes,
    }
    data = b"".join(chunks)
    if groups:
        document |= {
            "meshes": meshes,
            "materials": [_material(group) for group in groups],
            "accessors": accessors,
            "bufferViews": views,
            "buffers": [{"byteLength": len(data)}],
        }
    return document, data


ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER = 34962, 34963
UNSIGNED_INT, FLOAT = 5125, 5126


def _material(group: Group) -> dict[str, object]:
    surface = {"baseColorFactor": list(group.colour), "metallicFactor": 0.0, "roughnessFactor": 0.9}
    material: dict[str, object] = {"name": group.name, "pbrMetallicRoughness": surface}
    if group.colour[3] < 1.0:
        material["alphaMode"] = "BLEND"
    return material


def _text_gltf(document: dict[str, object], data: bytes) -> bytes:
    """Return the text form, the buffer inside as a data URI."""
    if data:
        uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode("ascii")
        document = document | {"buffers": [{"byteLength": len(data), "uri": uri}]}
    return (json.dumps(document, indent=1) + "\n").encode()


def _glb(document: dict[str, object], data: bytes) -> bytes:
    """Return the binary container: a header of 12 bytes, a chunk of JSON, a chunk of data (glTF 2.0, section 4.4)."""
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text
    if data:
        chunks += struct.pack("<I4s", len(data), b"BIN\0") + data
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def _obj(name: str, materials: str, groups: list[Group], origin: NDArray[np.float64]) -> str:
    lines = [f"# {name}: metres, y up, x east, z south", f"mtllib {materials}"]
    first = 1
    for group in groups:
        lines += [f"o {group.name.replace(' ', '_')}", f"usemtl {group.name.replace(' ', '_')}"]
        lines += [f"v {x:.4f} {y:.4f} {z:.4f}" for x, y, z in (group.points + origin).tolist()]
        lines += [f"f {a} {b} {c}" for a, b, c in (group.triangles.astype(np.int64) + first).tolist()]
        first += len(group.points)
    return "\n".join(lines) + "\n"


def _mtl(groups: list[Group]) -> str:
    lines = []
    for group in groups:
        red, green, blue, opacity = group.colour
        lines += [f"newmtl {group.name.replace(' ', '_')}", f"Kd {red:.4f} {green:.4f} {blue:.4f}", f"d {opacity:.2f}"]
    return "\n".join(lines) + "\n"
