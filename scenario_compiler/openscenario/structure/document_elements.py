"""OpenSCENARIO: the document, parameters, catalogs and the road network; the notation is in `structure.notation`."""

DOCUMENT_ELEMENTS = """
OpenSCENARIO
    = FileHeader (ParameterDeclarations? VariableDeclarations?@1.2- MonitorDeclarations?@1.3- CatalogLocations
      RoadNetwork Entities Storyboard | Catalog | ParameterValueDistribution@1.1-)
FileHeader
    author date:DateTime description revMajor:UnsignedShort revMinor:UnsignedShort
    = License?@1.1- Properties?@1.2-
License
    name resource? spdxId?
    = text
File
    filepath
Properties
    = Property* File* CustomContent*@1.2-
Property
    name value
CustomContent
    = text
"""

PARAMETER_ELEMENTS = """
ParameterDeclarations
    = ParameterDeclaration*
ParameterDeclaration
    name parameterType:ParameterType value
    = ConstraintGroup=ValueConstraintGroup*@1.1-
ValueConstraintGroup
    = ValueConstraint+
ValueConstraint
    rule:Rule value
ParameterAssignments
    = ParameterAssignment*
ParameterAssignment
    parameterRef value
VariableDeclarations
    = VariableDeclaration*
VariableDeclaration
    name variableType:ParameterType value
MonitorDeclarations
    = MonitorDeclaration*
MonitorDeclaration
    name value:Boolean
"""

CATALOG_ELEMENTS = """
CatalogLocations
    = & VehicleCatalog=CatalogLocation? ControllerCatalog=CatalogLocation? PedestrianCatalog=CatalogLocation?
      MiscObjectCatalog=CatalogLocation? EnvironmentCatalog=CatalogLocation? ManeuverCatalog=CatalogLocation?
      TrajectoryCatalog=CatalogLocation? RouteCatalog=CatalogLocation?
CatalogLocation
    = Directory
Directory
    path
Catalog
    name?-1.2
    = Vehicle* Controller* Pedestrian* MiscObject* Environment* Maneuver* Trajectory* Route*
CatalogReference
    catalogName entryName
    = ParameterAssignments?
"""

ROAD_NETWORK_ELEMENTS = """
RoadNetwork
    = LogicFile=File? SceneGraphFile=File? TrafficSignals? UsedArea?@1.1-
UsedArea
    = Position{2,}
TrafficSignals
    = TrafficSignalController*
TrafficSignalController
    delay?:Double[0,inf) name reference?
    = Phase*
Phase
    duration:Double[0,inf) name
    = TrafficSignalState* TrafficeSignalGroupState=TrafficSignalGroupState?@1.2 TrafficSignalGroupState?@1.3-
TrafficSignalState
    state trafficSignalId
TrafficSignalGroupState
    state
"""
