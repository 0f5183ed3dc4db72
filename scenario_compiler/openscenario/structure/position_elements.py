"""OpenSCENARIO: positions, routes and trajectories; the notation is in `structure.notation`."""

POSITION_ELEMENTS = """
Position
    = (WorldPosition | RelativeWorldPosition | RelativeObjectPosition | RoadPosition | RelativeRoadPosition |
      LanePosition | RelativeLanePosition | RoutePosition | GeoPosition@1.1- | TrajectoryPosition@1.1-)?-1.2
WorldPosition
    h?:Double p?:Double r?:Double x:Double y:Double z?:Double
RelativeWorldPosition
    entityRef dx:Double dy:Double dz?:Double
    = Orientation?
RelativeObjectPosition
    entityRef dx:Double dy:Double dz?:Double
    = Orientation?
RoadPosition
    roadId s:Double[0,inf) t:Double
    = Orientation?
RelativeRoadPosition
    entityRef ds:Double dt:Double
    = Orientation?
LanePosition
    laneId offset?:Double roadId s:Double[0,inf)
    = Orientation?
RelativeLanePosition
    entityRef dLane:Int ds?1.1-:Double offset?:Double dsLane?:Double@1.1-
    = Orientation?
RoutePosition
    = & RouteRef Orientation? InRoutePosition
GeoPosition
    latitude?1.2-:Double longitude?1.2-:Double height?:Double latitudeDeg?:Double@1.2- longitudeDeg?:Double@1.2-
    altitude?:Double@1.2- verticalRoadSelection?:Int@1.3-
    = Orientation?
TrajectoryPosition
    s:Double t?:Double
    = & Orientation? TrajectoryRef
Orientation
    h?:Double p?:Double r?:Double type?:ReferenceContext
"""

ROUTE_ELEMENTS = """
RouteRef
    = (Route | CatalogReference)?-1.2
Route
    closed:Boolean name
    = ParameterDeclarations? Waypoint{2,}
Waypoint
    routeStrategy:RouteStrategy
    = Position
InRoutePosition
    = (FromCurrentEntity=PositionOfCurrentEntity | FromRoadCoordinates=PositionInRoadCoordinates |
      FromLaneCoordinates=PositionInLaneCoordinates)?-1.2
PositionOfCurrentEntity
    entityRef
PositionInRoadCoordinates
    pathS:Double t:Double
PositionInLaneCoordinates
    laneId laneOffset?:Double pathS:Double[0,inf)
"""

TRAJECTORY_ELEMENTS = """
TrajectoryRef
    = Trajectory | CatalogReference
Trajectory
    closed:Boolean name
    = ParameterDeclarations? Shape
Shape
    = (Polyline | Clothoid | ClothoidSpline@1.3- | Nurbs)?-1.2
Polyline
    = Vertex{2,}
Vertex
    time?1.1-:Double
    = Position
Clothoid
    curvature:Double curvatureDot?1.1-:Double length:Double[0,inf) startTime?:Double[0,inf) stopTime?:Double(0,inf)
    curvaturePrime?:Double@1.1-
    = Position
ClothoidSpline
    timeEnd?:Double
    = ClothoidSplineSegment+
ClothoidSplineSegment
    curvatureStart:Double curvatureEnd:Double length:Double[0,inf) hOffset?:Double timeStart?:Double
    = PositionStart=Position?
Nurbs
    order:UnsignedInt
    = ControlPoint{2,} Knot{2,}
ControlPoint
    time?:Double[0,inf) weight?:Double(0,inf)
    = Position
Knot
    value:Double
"""
