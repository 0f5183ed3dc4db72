"""OpenSCENARIO: the storyboard, its triggers and conditions; the notation is in `structure.notation`."""

STORYBOARD_ELEMENTS = """
Storyboard
    = Init Story+@-1.1 Story*@1.2- StopTrigger=Trigger?1.3-
Init
    = Actions=InitActions
InitActions
    = GlobalAction* UserDefinedAction* Private*
Private
    entityRef
    = PrivateAction+
Story
    name
    = ParameterDeclarations? Act+
Act
    name
    = ManeuverGroup+ StartTrigger=Trigger?1.3- StopTrigger=Trigger?
ManeuverGroup
    maximumExecutionCount:UnsignedInt[1,inf) name
    = Actors CatalogReference* Maneuver*
Actors
    selectTriggeringEntities:Boolean
    = EntityRef*
Maneuver
    name
    = ParameterDeclarations? Event+
Event
    maximumExecutionCount?:UnsignedInt[1,inf) name priority:Priority
    = Action+ StartTrigger=Trigger?1.1-
Action
    name
    = (GlobalAction | UserDefinedAction | PrivateAction)?-1.2
"""

TRIGGER_ELEMENTS = """
Trigger
    = ConditionGroup*
ConditionGroup
    = Condition+
Condition
    conditionEdge:ConditionEdge delay:Double[0,inf) name
    = (ByEntityCondition | ByValueCondition)?-1.2
ByEntityCondition
    = & TriggeringEntities EntityCondition
TriggeringEntities
    triggeringEntitiesRule:TriggeringEntitiesRule
    = EntityRef+
"""

ENTITY_CONDITION_ELEMENTS = """
EntityCondition
    = (EndOfRoadCondition | CollisionCondition | OffroadCondition | TimeHeadwayCondition | TimeToCollisionCondition
      | AccelerationCondition | StandStillCondition | SpeedCondition | RelativeSpeedCondition |
      TraveledDistanceCondition | ReachPositionCondition | DistanceCondition | RelativeDistanceCondition |
      RelativeClearanceCondition@1.2- | AngleCondition@1.3- | RelativeAngleCondition@1.3-)?-1.2
EndOfRoadCondition
    duration:Double[0,inf)
CollisionCondition
    = (EntityRef | ByType=ByObjectType)?-1.2
ByObjectType
    type:ObjectType
OffroadCondition
    duration:Double[0,inf)
TimeHeadwayCondition
    entityRef alongRoute?1.1-:Boolean freespace:Boolean rule:Rule value:Double[0,inf)
    coordinateSystem?:CoordinateSystem@1.1- relativeDistanceType?:RelativeDistanceType@1.1-
    routingAlgorithm?:RoutingAlgorithm@1.2-
TimeToCollisionCondition
    alongRoute?1.1-:Boolean freespace:Boolean rule:Rule value:Double[0,inf)
    relativeDistanceType?:RelativeDistanceType@1.1-
    coordinateSystem?:CoordinateSystem@1.1- routingAlgorithm?:RoutingAlgorithm@1.2-
    = TimeToCollisionConditionTarget
TimeToCollisionConditionTarget
    = (Position | EntityRef)?-1.2
AccelerationCondition
    rule:Rule value:Double direction?:DirectionalDimension@1.2-
StandStillCondition
    duration:Double[0,inf)
SpeedCondition
    rule:Rule value:Double direction?:DirectionalDimension@1.2-
RelativeSpeedCondition
    entityRef rule:Rule value:Double direction?:DirectionalDimension@1.2-
TraveledDistanceCondition
    value:Double[0,inf)
ReachPositionCondition
    tolerance:Double[0,inf)
    = Position
DistanceCondition
    alongRoute?1.1-:Boolean freespace:Boolean rule:Rule value:Double[0,inf) coordinateSystem?:CoordinateSystem@1.1-
    relativeDistanceType?:RelativeDistanceType@1.1- routingAlgorithm?:RoutingAlgorithm@1.2-
    = Position
RelativeDistanceCondition
    entityRef freespace:Boolean relativeDistanceType:RelativeDistanceType rule:Rule value:Double[0,inf)
    coordinateSystem?:CoordinateSystem@1.1- routingAlgorithm?:RoutingAlgorithm@1.2-
RelativeClearanceCondition
    oppositeLanes:Boolean distanceForward?:Double[0,inf) distanceBackward?:Double[0,inf) freeSpace:Boolean
    = RelativeLaneRange* EntityRef*
RelativeLaneRange
    from?:Int to?:Int
AngleCondition
    angleType:AngleType angle:Double angleTolerance:Double[0,inf) coordinateSystem?:CoordinateSystem
RelativeAngleCondition
    entityRef angleType:AngleType angle:Double angleTolerance:Double[0,inf) coordinateSystem?:CoordinateSystem
"""

VALUE_CONDITION_ELEMENTS = """
ByValueCondition
    = (ParameterCondition | TimeOfDayCondition | SimulationTimeCondition | StoryboardElementStateCondition |
      UserDefinedValueCondition | TrafficSignalCondition | TrafficSignalControllerCondition |
      VariableCondition@1.2-)?-1.2
ParameterCondition
    parameterRef rule:Rule value
VariableCondition
    variableRef rule:Rule value
TimeOfDayCondition
    dateTime:DateTime rule:Rule
SimulationTimeCondition
    rule:Rule value:Double
StoryboardElementStateCondition
    storyboardElementRef state:StoryboardElementState storyboardElementType:StoryboardElementType
UserDefinedValueCondition
    name rule:Rule value
TrafficSignalCondition
    name state
TrafficSignalControllerCondition
    trafficSignalControllerRef phase
"""
