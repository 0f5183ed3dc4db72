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
    cloudState?1.1-:CloudState atmosphericPressure?:Double@1.1- temperature?:Double@1.1-
    fractionalCloudCover?:FractionalCloudCover@1.2-
    = & Sun?1.1- Fog?1.1- Precipitation?1.1- Wind?@1.1- DomeImage?@1.2-
Sun
    azimuth:Double elevation:Double intensity?1.2-:Double illuminance?:Double@1.2-
Fog
    visualRange:Double
    = BoundingBox?
Precipitation
    intensity?1.1-:Double precipitationType:PrecipitationType precipitationIntensity?:Double@1.1-
Wind
    direction:Double speed:Double
DomeImage
    azimuthOffset?:Double
    = DomeFile=File
RoadCondition
    frictionScaleFactor:Double wetness?:Wetness@1.2-
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
    radius:Double rate:Double velocity?:Double speed?:Double@1.2-
    = & Position TrafficDefinition?1.3- TrafficDistribution?@1.3-
TrafficSinkAction
    radius:Double rate?:Double
    = & Position TrafficDefinition?
TrafficSwarmAction
    innerRadius:Double numberOfVehicles:UnsignedInt offset:Double semiMajorAxis:Double semiMinorAxis:Double
    velocity?:Double
    = & CentralObject=CentralSwarmObject TrafficDefinition?1.3- TrafficDistribution?@1.3-
      InitialSpeedRange=Range?@1.2- DirectionOfTravelDistribution?@1.2-
CentralSwarmObject
    entityRef
DirectionOfTravelDistribution
    same:Double opposite:Double
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
    category:VehicleCategory weight:Double
VehicleRoleDistribution
    = VehicleRoleDistributionEntry+
VehicleRoleDistributionEntry
    role:Role weight:Double
ControllerDistribution
    = ControllerDistributionEntry+
ControllerDistributionEntry
    weight:Double
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
