"""OpenSCENARIO: actions of entities; the notation is in `structure.notation`."""

PRIVATE_ACTION_ELEMENTS = """
PrivateAction
    = (LongitudinalAction | LateralAction | VisibilityAction | SynchronizeAction | ActivateControllerAction |
      ControllerAction | TeleportAction | RoutingAction | AppearanceAction@1.2- | TrailerAction@1.3-)?-1.2
TeleportAction
    = Position
VisibilityAction
    graphics:Boolean sensors:Boolean traffic:Boolean
    = SensorReferenceSet?@1.2-
SensorReferenceSet
    = SensorReference+
SensorReference
    name
"""

LONGITUDINAL_ACTION_ELEMENTS = """
LongitudinalAction
    = (SpeedAction | LongitudinalDistanceAction | SpeedProfileAction@1.2-)?-1.2
SpeedAction
    = & SpeedActionDynamics=TransitionDynamics SpeedActionTarget
TransitionDynamics
    dynamicsDimension:DynamicsDimension dynamicsShape:DynamicsShape value:Double[0,inf)
    followingMode?:FollowingMode@1.2-
SpeedActionTarget
    = (RelativeTargetSpeed | AbsoluteTargetSpeed)?-1.2
AbsoluteTargetSpeed
    value:Double
RelativeTargetSpeed
    entityRef continuous:Boolean speedTargetValueType:SpeedTargetValueType value:Double
LongitudinalDistanceAction
    entityRef continuous:Boolean distance?:Double[0,inf) freespace:Boolean timeGap?:Double[0,inf)
    displacement?:LongitudinalDisplacement@1.1- coordinateSystem?:CoordinateSystem@1.1-
    = DynamicConstraints?
DynamicConstraints
    maxAcceleration?:Double[0,inf) maxDeceleration?:Double[0,inf) maxSpeed?:Double[0,inf)
    maxAccelerationRate?:Double[0,inf)@1.2-
    maxDecelerationRate?:Double[0,inf)@1.2-
SpeedProfileAction
    entityRef? followingMode:FollowingMode
    = DynamicConstraints? SpeedProfileEntry+
SpeedProfileEntry
    speed:Double time?:Double[0,inf)
"""

LATERAL_ACTION_ELEMENTS = """
LateralAction
    = (LaneChangeAction | LaneOffsetAction | LateralDistanceAction)?-1.2
LaneChangeAction
    targetLaneOffset?:Double
    = & LaneChangeActionDynamics=TransitionDynamics LaneChangeTarget
LaneChangeTarget
    = (RelativeTargetLane | AbsoluteTargetLane)?-1.2
AbsoluteTargetLane
    value
RelativeTargetLane
    entityRef value:Int
LaneOffsetAction
    continuous:Boolean
    = & LaneOffsetActionDynamics LaneOffsetTarget
LaneOffsetActionDynamics
    dynamicsShape:DynamicsShape maxLateralAcc?:Double[0,inf)
LaneOffsetTarget
    = (RelativeTargetLaneOffset | AbsoluteTargetLaneOffset)?-1.2
AbsoluteTargetLaneOffset
    value:Double
RelativeTargetLaneOffset
    entityRef value:Double
LateralDistanceAction
    entityRef continuous:Boolean distance?:Double[0,inf) freespace:Boolean displacement?:LateralDisplacement@1.1-
    coordinateSystem?:CoordinateSystem@1.1-
    = DynamicConstraints?
"""

SYNCHRONIZE_ACTION_ELEMENTS = """
SynchronizeAction
    masterEntityRef targetToleranceMaster?:Double@1.1- targetTolerance?:Double@1.1-
    = & TargetPositionMaster=Position TargetPosition=Position FinalSpeed?
FinalSpeed
    = (AbsoluteSpeed | RelativeSpeedToMaster)?-1.2
AbsoluteSpeed
    value:Double[0,inf)
    = (TargetDistanceSteadyState | TargetTimeSteadyState)?@1.1-
RelativeSpeedToMaster
    speedTargetValueType:SpeedTargetValueType value:Double
    = (TargetDistanceSteadyState | TargetTimeSteadyState)?@1.1-
TargetDistanceSteadyState
    distance:Double[0,inf)
TargetTimeSteadyState
    time:Double[0,inf)
"""

ROUTING_ACTION_ELEMENTS = """
RoutingAction
    = (AssignRouteAction | FollowTrajectoryAction | AcquirePositionAction | RandomRouteAction@1.3-)?-1.2
AssignRouteAction
    = (Route | CatalogReference)?-1.2
FollowTrajectoryAction
    initialDistanceOffset?:Double[0,inf)@1.1-
    = & Trajectory? CatalogReference? TimeReference TrajectoryFollowingMode TrajectoryRef?@1.1-
TimeReference
    = (None | Timing)?-1.2
None
Timing
    domainAbsoluteRelative:ReferenceContext offset:Double scale:Double(0,inf)
TrajectoryFollowingMode
    followingMode:FollowingMode
AcquirePositionAction
    = Position
RandomRouteAction
"""

CONTROLLER_ACTION_ELEMENTS = """
ControllerAction
    =@1.0 & AssignControllerAction OverrideControllerValueAction
    =@1.1-1.2 & AssignControllerAction? OverrideControllerValueAction? ActivateControllerAction?
    =@1.3- AssignControllerAction | OverrideControllerValueAction | ActivateControllerAction
AssignControllerAction
    activateLateral?:Boolean@1.1- activateLongitudinal?:Boolean@1.1- activateAnimation?:Boolean@1.2-
    activateLighting?:Boolean@1.2-
    = (Controller | CatalogReference | ObjectController@1.3-)?
ActivateControllerAction
    lateral?:Boolean longitudinal?:Boolean controllerRef?@1.2- animation?:Boolean@1.2- lighting?:Boolean@1.2-
    objectControllerRef?@1.3-
OverrideControllerValueAction
    = & Throttle=OverrideThrottleAction?1.1- Brake=OverrideBrakeAction?1.1- Clutch=OverrideClutchAction?1.1-
      ParkingBrake=OverrideParkingBrakeAction?1.1- SteeringWheel=OverrideSteeringWheelAction?1.1-
      Gear=OverrideGearAction?1.1-
OverrideThrottleAction
    active:Boolean value:Double[0,1] maxRate?:Double@1.2-
OverrideBrakeAction
    active:Boolean value?1.2-:Double[0,1]
    = (BrakePercent=Brake | BrakeForce=Brake)?@1.2-
Brake
    value:Double maxRate?:Double
OverrideClutchAction
    active:Boolean value:Double[0,1] maxRate?:Double(0,inf)@1.2-
OverrideParkingBrakeAction
    active:Boolean value?1.2-:Double[0,1]
    = (BrakePercent=Brake | BrakeForce=Brake)?@1.2-
OverrideSteeringWheelAction
    active:Boolean value:Double maxRate?:Double(0,inf)@1.2- maxTorque?:Double(0,inf)@1.2-
OverrideGearAction
    active:Boolean number?1.2-:Double
    = (ManualGear | AutomaticGear)?@1.2-
ManualGear
    number:Int
AutomaticGear
    gear:AutomaticGearType
"""

APPEARANCE_ACTION_ELEMENTS = """
AppearanceAction
    =@1.2 LightStateAction AnimationAction
    =@1.3- LightStateAction | AnimationAction
LightStateAction
    transitionTime?:Double[0,inf)
    = LightType LightState
LightType
    =@1.2 VehicleLight UserDefinedLight
    =@1.3- VehicleLight | UserDefinedLight
VehicleLight
    vehicleLightType:VehicleLightType
UserDefinedLight
    userDefinedLightType
LightState
    mode:LightMode luminousIntensity?:Double[0,inf) flashingOnDuration?:Double[0,inf) flashingOffDuration?:Double[0,inf)
    = Color?
Color
    colorType:ColorType
    = ColorRgb | ColorCmyk
ColorRgb
    red:Double[0,1] green:Double[0,1] blue:Double[0,1]
ColorCmyk
    cyan:Double[0,1] magenta:Double[0,1] yellow:Double[0,1] key:Double[0,1]
AnimationAction
    loop?:Boolean animationDuration?:Double[0,inf)
    = AnimationType AnimationState?
AnimationType
    = ComponentAnimation | PedestrianAnimation | AnimationFile | UserDefinedAnimation
AnimationState
    state:Double[0,1]
ComponentAnimation
    =@1.2 VehicleComponent UserDefinedComponent
    =@1.3- VehicleComponent | UserDefinedComponent
VehicleComponent
    vehicleComponentType:VehicleComponentType
UserDefinedComponent
    userDefinedComponentType
PedestrianAnimation
    motion?:PedestrianMotionType userDefinedPedestrianAnimation?
    = PedestrianGesture*
PedestrianGesture
    gesture:PedestrianGestureType
AnimationFile
    timeOffset?:Double[0,inf)
    = File
UserDefinedAnimation
    userDefinedAnimationType
"""

TRAILER_ACTION_ELEMENTS = """
TrailerAction
    = ConnectTrailerAction | DisconnectTrailerAction
ConnectTrailerAction
    trailerRef
DisconnectTrailerAction
"""
