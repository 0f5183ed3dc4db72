"""OpenSCENARIO: global and user-defined actions; the notation is in `structure.notation`."""

GLOBAL_ACTION_ELEMENTS = """
GlobalAction
    = (EnvironmentAction | EntityAction | InfrastructureAction | SetMonitorAction@1.3- | ParameterAction |
      TrafficAction | VariableAction@1.2-)?-1.2
EntityAction
    entityRef
    = (AddEntityAction | DeleteEntityAction)?-1.2
AddEntityAction
    = Position
DeleteEntityAction
UserDefinedAction
    = CustomCommandAction
CustomCommandAction
    type
    = text
"""

VALUE_ACTION_ELEMENTS = """
ParameterAction
    parameterRef
    = (SetAction=ParameterSetAction | ModifyAction=ParameterModifyAction)?-1.2
ParameterSetAction
    value
ParameterModifyAction
    = Rule=ModifyRule
ModifyRule
    = (AddValue=ParameterAddValueRule | MultiplyByValue=ParameterMultiplyByValueRule)?-1.2
ParameterAddValueRule
    value:Double
ParameterMultiplyByValueRule
    value:Double
VariableAction
    variableRef
    = (SetAction=VariableSetAction | ModifyAction=VariableModifyAction)?-1.2
VariableSetAction
    value
VariableModifyAction
    = Rule=VariableModifyRule
VariableModifyRule
    = (AddValue=VariableAddValueRule | MultiplyByValue=VariableMultiplyByValueRule)?-1.2
VariableAddValueRule
    value:Double
VariableMultiplyByValueRule
    value:Double
SetMonitorAction
    monitorRef value:Boolean
"""

ENVIRONMENT_ELEMENTS = """
EnvironmentAction
    = (Environment | CatalogReference)?-1.2
Environment
    name
    = & ParameterDeclarations? TimeOfDay?1.1- Weather?1.1- RoadCondition?1.1-
TimeOfDay
    animation:Boolean dateTime:DateTime
Weather
    cloudState?1.1-:CloudState atmosphericPressure?:Double[80000,120000]@1.1- temperature?:Double[170,340]@1.1-
    fractionalCloudCover?:FractionalCloudCover@1.2-
    = & Sun?1.1- Fog?1.1- Precipitation?1.1- Wind?@1.1- DomeImage?@1.2-
Sun
    azimuth:Double[0,2pi] elevation:Double[-pi,pi] intensity?1.2-:Double[0,inf) illuminance?:Double[0,inf)@1.2-
Fog
    visualRange:Double[0,inf)
    = BoundingBox?
Precipitation
    intensity?1.1-:Double[0,1] precipitationType:PrecipitationType precipitationIntensity?:Double[0,inf)@1.1-
Wind
    direction:Double[0,2pi) speed:Double[0,inf)
DomeImage
    azimuthOffset?:Double[0,2pi]
    = DomeFile=File
RoadCondition
    frictionScaleFactor:Double[0,inf) wetness?:Wetness@1.2-
    = Properties?
"""

SIGNAL_ACTION_ELEMENTS = """
InfrastructureAction
    = TrafficSignalAction
TrafficSignalAction
    = (TrafficSignalControllerAction | TrafficSignalStateAction)?-1.2
TrafficSignalControllerAction
    trafficSignalControllerRef phase
TrafficSignalStateAction
    name state
"""

TRAFFIC_ACTION_ELEMENTS = """
TrafficAction
    trafficName?@1.1-
    = (TrafficSourceAction | TrafficSinkAction | TrafficSwarmAction | TrafficAreaAction@1.3- |
      TrafficStopAction@1.1-)?-1.2
TrafficSourceAction
    radius:Double[0,inf) rate:Double[0,inf) velocity?:Double[0,inf) speed?:Double@1.2-
    = & Position TrafficDefinition?1.3- TrafficDistribution?@1.3-
TrafficSinkAction
    radius:Double[0,inf) rate?:Double[0,inf)
    = & Position TrafficDefinition?
TrafficSwarmAction
    innerRadius:Double[0,inf) numberOfVehicles:UnsignedInt offset:Double semiMajorAxis:Double[0,inf)
    semiMinorAxis:Double[0,inf)
    velocity?:Double[0,inf)
    = & CentralObject=CentralSwarmObject TrafficDefinition?1.3- TrafficDistribution?@1.3-
      InitialSpeedRange=Range?@1.2- DirectionOfTravelDistribution?@1.2-
CentralSwarmObject
    entityRef
DirectionOfTravelDistribution
    same:Double[0,inf) opposite:Double[0,inf)
TrafficAreaAction
    numberOfEntities:UnsignedInt continuous:Boolean
    = & TrafficDistribution TrafficArea
TrafficArea
    = Polygon | RoadRange+
Polygon
    = Position{3,}
RoadRange
    length?:Double
    = RoadCursor{2,}
RoadCursor
    roadId s?:Double
    = Lane*
Lane
    id:Int
TrafficStopAction
TrafficDefinition
    name
    = & VehicleCategoryDistribution VehicleRoleDistribution?@1.2- ControllerDistribution
VehicleCategoryDistribution
    = VehicleCategoryDistributionEntry+
VehicleCategoryDistributionEntry
    category:VehicleCategory weight:Double[0,inf)
VehicleRoleDistribution
    = VehicleRoleDistributionEntry+
VehicleRoleDistributionEntry
    role:Role weight:Double[0,inf)
ControllerDistribution
    = ControllerDistributionEntry+
ControllerDistributionEntry
    weight:Double(0,inf)
    = (Controller | CatalogReference)?-1.2
TrafficDistribution
    = TrafficDistributionEntry+
TrafficDistributionEntry
    weight:Double
    = EntityDistribution Properties?
EntityDistribution
    = EntityDistributionEntry+
EntityDistributionEntry
    weight:Double
    = ScenarioObjectTemplate
ScenarioObjectTemplate
    = (CatalogReference | Vehicle | Pedestrian | MiscObject | ExternalObjectReference) ObjectController*
"""
