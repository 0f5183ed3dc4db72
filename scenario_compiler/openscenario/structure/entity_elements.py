"""OpenSCENARIO: entities, vehicles, controllers and traffic; the notation is in `structure.notation`."""

ENTITY_ELEMENTS = """
Entities
    = ScenarioObject* EntitySelection*
ScenarioObject
    name
    = (CatalogReference | Vehicle | Pedestrian | MiscObject | ExternalObjectReference@1.1-)?-1.2
      ObjectController?@-1.1 ObjectController*@1.2-
ExternalObjectReference
    name
EntitySelection
    name
    = Members=SelectedEntities
SelectedEntities
    = (EntityRef* | ByType*)@-1.2 (EntityRef+ | ByType+)@1.3-
EntityRef
    entityRef
ByType
    objectType:ObjectType
ObjectController
    name?@1.3-
    = (CatalogReference | Controller)?-1.2
Controller
    name controllerType?:ControllerType@1.2-
    = & ParameterDeclarations? Properties?1.3-
"""

OBJECT_ELEMENTS = """
Vehicle
    name vehicleCategory:VehicleCategory mass?:Double@1.1- model3d?@1.1- role?:Role@1.2-
    = & ParameterDeclarations? BoundingBox Performance Axles Properties?1.3- TrailerHitch?@1.3- TrailerCoupler?@1.3-
      Trailer?@1.3-
Pedestrian
    mass:Double model?1.1- name pedestrianCategory:PedestrianCategory model3d?@1.1- role?:Role@1.2-
    = & ParameterDeclarations? BoundingBox Properties?1.3-
MiscObject
    mass:Double[0,inf) miscObjectCategory:MiscObjectCategory name model3d?@1.1-
    = & ParameterDeclarations? BoundingBox Properties?1.3-
BoundingBox
    = & Center Dimensions
Center
    x:Double y:Double z:Double
Dimensions
    height:Double[0,inf) length:Double[0,inf) width:Double[0,inf)
Performance
    maxAcceleration:Double[0,inf) maxDeceleration:Double[0,inf) maxSpeed:Double[0,inf)
    maxAccelerationRate?:Double[0,inf)@1.2-
    maxDecelerationRate?:Double[0,inf)@1.2-
Axles
    = FrontAxle=Axle?1.3- RearAxle=Axle AdditionalAxle=Axle*
Axle
    maxSteering:Double[0,pi] positionX:Double positionZ:Double[0,inf) trackWidth:Double[0,inf)
    wheelDiameter:Double(0,inf)
TrailerHitch
    dx:Double dz?:Double
TrailerCoupler
    dx:Double dz?:Double
Trailer
    = Trailer=ScenarioObject | TrailerRef=EntityRef
"""
