"""OpenDRIVE's elements of objects, signals, controllers and junctions; `structure.notation` explains the notation."""

OBJECT_ELEMENTS = """
objects
    = object* objectReference*@1.2- tunnel* bridge* ...
object
    id:count@1.1 id@1.2- name? type?:count@1.1 type?@1.2-1.4 type?:object_type@1.5- subtype?@1.5-
    s:not_negative t:number zOffset:number
    orientation:orientation@-1.5 orientation?:orientation@1.6- dynamic:yes_or_no@1.5 dynamic?:yes_or_no@1.6-
    validLength:not_negative@-1.5 validLength?:not_negative@1.6- hdg:number@-1.5 hdg?:number@1.6- pitch:number@-1.5
    pitch?:number@1.6- roll:number@-1.5 roll?:number@1.6- height:number@-1.5 height?:number@1.6
    height?:not_negative@1.7-
    length?:number@-1.6 length?:positive@1.7- width?:number radius?:number@-1.6 radius?:positive@1.7-
    perpToRoad?:boolean@1.7-
    = repeat?@1.2-1.3 repeat*@1.4 repeat?@1.5 repeat*@1.6- outline? outlines?@1.5- material=object_material?@1.3-1.4
      material=object_material*@1.5- laneValidity=validity*@1.1 validity*@1.2- parkingSpace?@1.4- markings?@1.5-
      borders?@1.5- ...
      surface=object_surface?@1.7- skeleton?@1.8-
repeat
    s:not_negative length:not_negative distance:not_negative tStart:number@1.4- tEnd:number@1.4-
    widthStart:not_negative@1.4-1.5 widthStart?:not_negative@1.6- widthEnd:not_negative@1.4-1.5
    widthEnd?:not_negative@1.6-
    heightStart:number@1.4-1.6 heightStart:not_negative@1.7- heightEnd:number@1.4-1.6 heightEnd:not_negative@1.7-
    zOffsetStart:number@1.4- zOffsetEnd:number@1.4- lengthStart?:not_negative@1.5- lengthEnd?:not_negative@1.5-
    radiusStart?:not_negative@1.5- radiusEnd?:not_negative@1.5- detachFromReferenceLine?:boolean@1.8-
    = ..
outlines
    = outline+ ...
outline
    id:count@1.5 id?:count@1.6- fillType:fill@1.5 fillType?:fill@1.6- outer:boolean@1.5 outer?:boolean@1.6-
    closed:boolean@1.5 closed?:boolean@1.6- laneType:lane_type@1.5 laneType?:lane_type@1.6-
    = cornerInertial*@-1.2 cornerRoad*@-1.3 cornerRelative*@-1.2 cornerLocal*@1.3 (cornerRoad* | cornerLocal* | ...)@1.4
      (cornerRoad* cornerLocal*)@1.5 (cornerRoad* | cornerLocal*)?@1.6-1.7 (cornerRoad{2,} | cornerLocal{2,})@1.8-
      ...@-1.3 ...@1.5-
cornerInertial
    x:number y:number z:number height:number
    = ...
cornerRelative
    u:number v:number z:number height:number
    = ...
cornerRoad
    id:count@1.5 id?:count@1.6- s:not_negative t:number dz:number height:number@-1.6 height:not_negative@1.7-
    = ..
cornerLocal
    id:count@1.5 id?:count@1.6- u:number v:number z:number height:number@-1.6 height:not_negative@1.7-
    = ..
object_material
    surface? friction?:not_negative roughness?:not_negative roadMarkColor?:mark_colour@1.8-
    = ..
validity
    fromLane:int toLane:int
    = ..
parkingSpace
    access:parking_access restrictions?
    = marking=parking_marking{0,4}@1.4 ..
parking_marking
    side?:parking_side type?:mark_type width?:number color?:mark_colour
markings
    = marking+ ...
marking
    color:mark_colour spaceLength:not_negative lineLength:positive startOffset:number stopOffset:number
    side:parking_side@1.5 side?:parking_side@1.6- weight:mark_weight@1.5 weight?:mark_weight@1.6- width?:positive
    zOffset?:not_negative
    = cornerReference{2,}@1.5 cornerReference*@1.6- ...
cornerReference
    id:count
    = ..
borders
    = border=object_border+ ...
object_border
    outlineId:count type:border_type width:not_negative useCompleteOutline?:boolean
    = cornerReference{2,}@1.5 cornerReference*@1.6- ...
object_surface
    = CRG=object_crg?@1.7 ... CRG=object_crg?@1.8-
object_crg
    file? hideRoadSurfaceCRG?:boolean zScale?:number
    = ...@1.8-
skeleton
    = polyline+ ...
polyline
    id?:positive_int
    = (vertexRoad{2,} | vertexLocal{2,}) ...
vertexRoad
    id?:positive_int s?:not_negative t?:number dz?:number radius?:number intersectionPoint?:boolean
    = ...
vertexLocal
    id?:positive_int u?:number v?:number z?:number radius?:number intersectionPoint?:boolean
    = ...
objectReference
    id s:not_negative t:number@1.3- zOffset:number@1.3-1.5 zOffset?:number@1.6- orientation:orientation
    validLength:not_negative@-1.5 validLength?:not_negative@1.6- length?:number@1.2
    = validity* ...
tunnel
    id:count@1.1 id@1.2- name? s:not_negative length:not_negative type:tunnel_type lighting?:fraction daylight?:fraction
    = laneValidity=validity*@1.1 validity*@1.2- ...
bridge
    id:count@1.1 id@1.2- name? s:not_negative length:not_negative type:bridge_type
    = laneValidity=validity*@1.1 validity*@1.2- ...
"""

SIGNAL_ELEMENTS = """
signals
    = signal* signalReference* ...
signal
    id:count@1.1 id@1.2- name? s:not_negative@-1.7 s?:not_negative@1.8- t:number@-1.7 t?:number@1.8- zOffset:number@-1.7
    zOffset?:number@1.8-
    dynamic:yes_or_no orientation:orientation type:int@-1.3 type@1.4- subtype:int@-1.3 subtype@1.4- country?@-1.4
    country?:country@1.5- countryRevision?@1.5- value?:number unit?:any_unit@1.4- text?@1.4- hOffset?:number@1.4-
    pitch?:number@1.4- roll?:number@1.4- height:not_negative@1.4-1.5 height?:not_negative@1.6-
    width:not_negative@1.4-1.5
    width?:not_negative@1.6- length?:not_negative@1.8-
    = laneValidity=validity*@1.1 Validity=validity*@1.2 validity*@1.3- dependency* reference*@1.5-
      (positionRoad | positionInertial)?@1.5- ... staticBoard*@1.8- vmsBoard*@1.8- semantics?@1.8-
signalReference
    id:count@1.1 id@1.2- s:not_negative t:number orientation:orientation@1.3-
    = laneValidity=validity*@1.1 Validity=validity*@1.2 validity*@1.3- ...
dependency
    id:count@1.1 id@1.2- type?:count@1.1 type?@1.2-
    = ..
reference
    elementId elementType:reference_kind type?
    = ..
positionRoad
    roadId s:not_negative t:number zOffset:number hOffset:number pitch?:number roll?:number
    = ..
positionInertial
    x:number y:number z:number hdg:number pitch?:number roll?:number
    = ..
staticBoard
    = validity* dependency* reference* ... sign*
sign
    id name? dynamic:yes_or_no orientation:orientation type subtype country?:country countryRevision? value?:number
    unit?:any_unit text? hOffset?:number pitch?:number roll?:number height?:not_negative width?:not_negative
    length?:not_negative
    v?:number z?:number
    = validity* dependency* reference* (positionInertial | positionRoad)? ... staticBoard* vmsBoard* semantics?
vmsBoard
    displayType?:display_type displayHeight?:number displayWidth?:number v?:number z?:number
    = validity* dependency* reference* ... displayArea*
displayArea
    index?:int height? width? v?:number z?:number
    = ...
vmsGroup
    id?
    = vmsBoardReference+ ...
vmsBoardReference
    groupIndex?:int signalId? vmsIndex?:int
    = ...
semantics
    = speed=speed_semantics* lane=lane_semantics* priority=priority_semantics* prohibited=semantic* warning=semantic*
      routing=semantic* streetname=semantic* parking=semantic* tourist=semantic* supplementaryTime*
      supplementaryAllows=semantic* supplementaryProhibits=semantic* supplementaryDistance* supplementaryEnvironment*
      supplementaryExplanatory=semantic* ...
semantic
    = ...
speed_semantics
    = type=speed_semantics_type unit=speed_semantics_unit value=speed_semantics_value ...
speed_semantics_type
    = text:speed_semantics
speed_semantics_unit
    = text:speed_unit
speed_semantics_value
    = text:number
lane_semantics
    type?:lane_semantics
    = ...
priority_semantics
    type?:priority_semantics
    = ...
supplementaryTime
    type?:time_semantics value?:number
    = ...
supplementaryDistance
    type?:distance_semantics value?:number unit?:distance_unit
    = ...
supplementaryEnvironment
    type?:environment_semantics
    = ...
controller
    ID?:count@1.1 ID?@1.2 id@1.3- name? sequence?:count@1.3-
    = control+ ...
control
    signalID?:count@1.1 signalID?@1.2 signalId@1.3- type?:count@1.1 type?@1.2-
    = userData?@-1.2 ...@1.3-1.5 ...@1.8-
"""

JUNCTION_ELEMENTS = """
junction
    by type@1.8-: virtual=virtual_junction direct=direct_junction crossing=crossing_junction
    id:count@1.1 id@1.2- name? type?:junction_type@1.5- mainRoad?@1.7 orientation?:orientation@1.7
    sStart?:not_negative@1.7 sEnd?:not_negative@1.7
    = connection+@-1.7 connection*@1.8- crossPath*@1.8- priority* controller=junction_controller*
      surface=junction_surface?@1.5-
      planView?@1.8- objects?@1.8- boundary?@1.8- elevationGrid?@1.8- ...
virtual_junction
    id name? type?:junction_type mainRoad? orientation?:orientation sStart?:not_negative sEnd?:not_negative
    = connection=virtual_connection* crossPath* priority* controller=junction_controller* surface? planView? objects?
      ...
direct_junction
    id name? type?:junction_type
    = connection=direct_connection+ priority* controller=junction_controller* surface? planView? objects? ...
crossing_junction
    id name? type?:junction_type
    = roadSection+ priority* controller=junction_controller* surface? planView? objects? ...
connection
    id:count@1.1 id@1.2- incomingRoad:count@1.1 incomingRoad@1.2-1.5 incomingRoad?@1.6-
    connectingRoad:count@1.1 connectingRoad@1.2-1.5 connectingRoad?@1.6- contactPoint:contact_point@-1.5
    contactPoint?@1.6 contactPoint?:contact_point@1.7- type?:connection_type@1.5-1.7 connectionMaster?@1.5
    linkedRoad?@1.7
    = predecessor=connection_end?@1.5-1.7 successor=connection_end?@1.5-1.7 laneLink* ..
direct_connection
    id incomingRoad? linkedRoad? contactPoint?:contact_point
    = laneLink* ...
virtual_connection
    by type@1.8-: virtual=bypassing_connection
    id incomingRoad? connectingRoad? contactPoint?:contact_point type?:connection_type
    = laneLink* ...
bypassing_connection
    id incomingRoad? connectingRoad? contactPoint?:contact_point type?:connection_type
    = laneLink* ... predecessor=connection_end successor=connection_end
connection_end
    elementId elementType:road_only elementS:above_zero@1.5-1.6 elementS:not_negative@1.7-
    elementDir:link_direction@1.5-1.7
    elementDir?:link_direction@1.8-
    = ..
laneLink
    from:int to:int overlapZone?:above_zero@1.8-
    = userData?@-1.2 ...@1.3-1.5 ...@1.8-
priority
    high?:count@1.1 high?@1.2-1.7 high@1.8- low?:count@1.1 low?@1.2-1.7 low@1.8-
    = ..
junction_controller
    id:count@1.1 id@1.2- type?:count@1.1 type?@1.2- sequence?:count@1.3-
    = ..
junction_surface
    = CRG=junction_crg*@-1.7 CRG*@1.8- ...
junction_crg
    file mode:global_only purpose?:crg_purpose zOffset?:number zScale?:number
    = ..
crossPath
    id? crossingRoad? roadAtStart? roadAtEnd?
    = startLaneLink=crossing_lane endLaneLink=crossing_lane ...
crossing_lane
    s?:not_negative from?:int to?:int
    = ...
roadSection
    id? roadId? sStart?:not_negative sEnd?:not_negative
    = ...
boundary
    = segment=boundary_segment+ ...
boundary_segment
    by type@1.8-: lane=lane_segment joint=joint_segment
    roadId?
    = ...
lane_segment
    type?:segment_type roadId? boundaryLane?:int sStart?:boundary_station sEnd?:boundary_station
    = ...
joint_segment
    type?:segment_type roadId? contactPoint?:boundary_station jointLaneStart?:int jointLaneEnd?:int
    transitionLength?:not_negative
    = ...
elevationGrid
    gridSpacing? sStart?
    = elevation=grid_elevation* ...
grid_elevation
    center? left? right?
    = ...
junctionGroup
    id name? type:junction_group_type
    = junctionReference+ ...
junctionReference
    junction
    = ...@1.5 ...@1.8-
"""
