"""Positions of entities and conditions, as the author writes them and as the plan binds them.

Lowering binds positions in the world and spawn points to a road, a lane, s and an offset (`BoundPosition`). Positions
relative to an entity and random positions stay open: the engine resolves them when a run is reset or when they are
needed, so that a sweep can vary them.
"""

from scenario_compiler.vocabulary.positions.basic import (
    AnyOfPosition,
    BesidePosition,
    LanePositionWord,
    NumberedSpawnPoint,
    RandomPosition,
    RandomSpawnPoint,
    RelativeLanePosition,
    RoadPosition,
    SpawnPoint,
    Surface,
    WorldPosition,
)
from scenario_compiler.vocabulary.positions.relative import (
    FreePosition,
    GeoPosition,
    LanesAwayPosition,
    RelativeObjectPosition,
    RelativeRoadPosition,
    RelativeWorldPosition,
)
from scenario_compiler.vocabulary.positions.routes import (
    Clothoid,
    ClothoidSegment,
    ClothoidSpline,
    ControlPoint,
    InRouteEntity,
    InRouteLane,
    InRouteRoad,
    Nurbs,
    Point,
    Polyline,
    RoutePosition,
    RouteWord,
    Trajectory,
    TrajectoryPosition,
    Vertex,
    Waypoint,
)
from scenario_compiler.vocabulary.positions.spawn_points import (
    NamedPosition,
    SpawnPoints,
)

Position = Point | RoutePosition | TrajectoryPosition
BoundPosition = (
    LanePositionWord
    | RelativeLanePosition
    | BesidePosition
    | RandomPosition
    | AnyOfPosition
    | FreePosition
    | LanesAwayPosition
    | RelativeRoadPosition
    | RelativeObjectPosition
    | RelativeWorldPosition
    | RoutePosition
    | TrajectoryPosition
)

__all__ = [
    "AnyOfPosition",
    "BesidePosition",
    "BoundPosition",
    "Clothoid",
    "ClothoidSegment",
    "ClothoidSpline",
    "ControlPoint",
    "FreePosition",
    "GeoPosition",
    "InRouteEntity",
    "InRouteLane",
    "InRouteRoad",
    "LanePositionWord",
    "LanesAwayPosition",
    "NamedPosition",
    "NumberedSpawnPoint",
    "Nurbs",
    "Point",
    "Polyline",
    "Position",
    "RandomPosition",
    "RandomSpawnPoint",
    "RelativeLanePosition",
    "RelativeObjectPosition",
    "RelativeRoadPosition",
    "RelativeWorldPosition",
    "RoadPosition",
    "RoutePosition",
    "RouteWord",
    "SpawnPoint",
    "SpawnPoints",
    "Surface",
    "Trajectory",
    "TrajectoryPosition",
    "Vertex",
    "Waypoint",
    "WorldPosition",
]
