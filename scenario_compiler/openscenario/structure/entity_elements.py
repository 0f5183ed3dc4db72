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
    mass:Double miscObjectCategory:MiscObjectCategory name model3d?@1.1-
    = & ParameterDeclarations? BoundingBox Properties?1.3-
BoundingBox
    = & Center Dimensions
Center
    x:Double y:Double z:Double
Dimensions
    height:Double length:Double width:Double
Performance
    maxAcceleration:Double maxDeceleration:Double maxSpeed:Double maxAccelerationRate?:Double@1.2-
    maxDecelerationRate?:Double@1.2-
Axles
    = FrontAxle=Axle?1.3- RearAxle=Axle AdditionalAxle=Axle*
Axle
    maxSteering:Double positionX:Double positionZ:Double trackWidth:Double wheelDiameter:Double
TrailerHitch
    dx:Double dz?:Double
TrailerCoupler
    dx:Double dz?:Double
Trailer
    = Trailer=ScenarioObject | TrailerRef=EntityRef
"""
