"""OpenDRIVE's elements of header, roads, profiles, lanes and marks; `structure.notation` explains the notation."""

ROAD_ELEMENTS = """
OpenDRIVE
    = header road+ controller* junction* junctionGroup*@1.4- station*@1.4- ...@1.5- vmsGroup*@1.8-
header
    revMajor:int revMinor:int name? version?:header_version date? north?:number south?:number east?:number
    west?:number vendor?@1.3-
    maxRoad?:count@1.1 maxJunc?:count@1.1 maxPrg?:count@1.1
    = geoReference?@1.4- offset?@1.5- license?@1.8- ... defaultRegulations?@1.8-
geoReference
    = text ...@1.5-1.7
offset
    x:number y:number z:number hdg:number
    = ...
license
    name? resource? spdxid? text?
    = ...
userData
    code:int@1.1 code@1.2- value@1.5 value?@-1.4 value?@1.6-
    = text@-1.4 anything
include
    file
dataQuality
    = error? rawData?
error
    xyAbsolute:number zAbsolute:number xyRelative:number zRelative:number
rawData
    date source:quality_source sourceComment? postProcessing:quality_processing postProcessingComment?
defaultRegulations
    = roadRegulations* signalRegulations* ...
roadRegulations
    type?:road_type
    = ... semantics?
signalRegulations
    type? subtype?
    = ... semantics?

road
    id:count@1.1 id@1.2- junction:int@1.1 junction@1.2- length:positive name? rule?:traffic_rule@1.5-
    = link=road_link? type=road_type* planView elevationProfile? lateralProfile? lanes objects? signals?
      surface?@1.2- railroad?@1.4- ...@1.3-
road_link
    = predecessor=road_neighbour? successor=road_neighbour? neighbor?@1.1 neighbor{0,2}@1.2-1.5 ...
road_neighbour
    elementId:count@1.1 elementId@1.2- elementType:link_kind@-1.5 elementType?@1.6 elementType?:link_kind@1.7-
    contactPoint?:contact_point@-1.5 contactPoint?@1.6 contactPoint?:contact_point@1.7-
    elementS?:not_negative@1.5- elementDir?:link_direction@1.5 elementDir?@1.6 elementDir?:link_direction@1.7-
    = ...@1.5 ...@1.8-
neighbor
    elementId:count@1.1 elementId@1.2- side:side@1.2- direction:same_or_opposite
    = ...@1.5
road_type
    s:not_negative type:road_type country?:country@1.5-
    = speed=road_speed?@1.4- ...
road_speed
    max:road_speed unit?:any_unit@1.4 unit?:speed_unit@1.5-
    = ...@1.5 ...@1.8-

planView
    = geometry+ ...@1.5-
geometry
    s:not_negative x:number y:number hdg:number length:positive
    = (line=plain | spiral | arc | poly3 | paramPoly3@1.4- | ...)
plain
    = ..
spiral
    curvStart:number curvEnd:number
    = ..
arc
    curvature:number
    = ..
poly3
    a:number b:number c:number d:number
    = ..
paramPoly3
    aU:number bU:number cU:number dU:number aV:number bV:number cV:number dV:number pRange:parameter_range
    = ..
elevationProfile
    = elevation=cubic*@-1.3 elevation=cubic+@1.4-1.5 elevation=cubic*@1.6- ...
lateralProfile
    = superelevation=cubic* crossfall*@-1.5 shape*@1.4- crossSectionSurface?@1.8- ...
cubic
    s:not_negative a:number b:number c:number d:number
    = ..
crossfall
    side:side_or_both s:not_negative a:number b:number c:number d:number
    = ...
shape
    s:not_negative t:number a:number b:number c:number d:number
    = ..
crossSectionSurface
    = tOffset=strip_course? surfaceStrips ...
surfaceStrips
    = strip{1,4} ...
strip
    id?:int mode?:strip_mode
    = width=strip_course? constant=strip_course? linear=linear_course? quadratic=strip_course? cubic=strip_course? ...
strip_course
    = coefficients+ ...
linear_course
    = ... coefficients+
coefficients
    s?:not_negative a?:number b?:number c?:number d?:number
    = ...

surface
    = CRG* ...
CRG
    file sStart:not_negative sEnd:not_negative orientation:same_or_opposite mode:crg_mode purpose?:crg_purpose@1.4-
    sOffset?:number tOffset?:number zOffset?:number zScale?:number hOffset?:number
    = ..
railroad
    = switch* ...
switch
    id name position:switch_position
    = mainTrack=track sideTrack=track partner? ...
track
    id s:not_negative dir:link_direction
    = ...@1.5-1.6 ...@1.8-
partner
    id name?
    = ...@1.5-1.6 ...@1.8-
station
    id name type?:station_type
    = platform+ ...
platform
    id name?
    = segment+ ...@1.5-
segment
    roadId sStart:not_negative sEnd:not_negative side:side
    = ..
"""

LANE_ELEMENTS = """
lanes
    = laneOffset=cubic*@1.3- laneSection+ ...@1.5-
laneSection
    s:not_negative singleSide?:boolean@1.4-
    = left? center?@-1.3 center@1.4 center?@1.5 center@1.6- right? ...
left
    = lane=left_lane+ ...
right
    = lane=right_lane+ ...
center
    = lane=centre_lane?@-1.4 lane=centre_lane+@1.5-1.7 lane=centre_lane@1.8- ...
left_lane
    id:positive_int type:count@1.1 type:lane_type@1.2- level?:count@1.1 level?:boolean@1.2-
    direction?:lane_direction@1.8- advisory?:lane_advisory@1.8-
    dynamicLaneDirection?:boolean@1.8- dynamicLaneType?:boolean@1.8- roadWorks?:boolean@1.8-
    = link=lane_link? width+@-1.3 (width+ | border+)@1.4 (width+ | border+)+@1.5 (border* | width*)+@1.6-1.7 (border+
      | width+)?@1.8-
      roadMark* material* visibility*@-1.5 speed* access* height*@1.2- rule*@1.4- ...
right_lane
    id:negative_int type:count@1.1 type:lane_type@1.2- level?:count@1.1 level?:boolean@1.2-
    direction?:lane_direction@1.8- advisory?:lane_advisory@1.8-
    dynamicLaneDirection?:boolean@1.8- dynamicLaneType?:boolean@1.8- roadWorks?:boolean@1.8-
    = link=lane_link? width+@-1.3 (width+ | border+)@1.4 (width+ | border+)+@1.5 (border* | width*)+@1.6-1.7 (border+
      | width+)?@1.8-
      roadMark* material* visibility*@-1.5 speed* access* height*@1.2- rule*@1.4- ...
centre_lane
    id:zero_int type:count@1.1 type:lane_type@1.2-1.7 type?:lane_type@1.8- level?:boolean@1.2-
    = link=lane_link? (border* | width*)+@1.6-1.7 roadMark* material*@1.6-1.7 speed*@1.6-1.7 access*@1.6-1.7
      height*@1.6-1.7
      rule*@1.6-1.7 ...@-1.7
lane_link
    = predecessor=lane_neighbour?@-1.4 predecessor=lane_neighbour*@1.5- successor=lane_neighbour?@-1.4
      successor=lane_neighbour*@1.5- ...
lane_neighbour
    id:int
    = ...@1.5 ...@1.8-
width
    sOffset:not_negative a:number b:number c:number d:number
    = ..
border
    sOffset:not_negative a:number b:number c:number d:number
    = ..
material
    sOffset:not_negative friction:not_negative surface?@1.2- roughness?:not_negative materialCode?:count@1.1
    = ..
visibility
    sOffset:not_negative forward:not_negative back:not_negative left:not_negative right:not_negative
    = ...
speed
    sOffset:not_negative max:not_negative unit?:any_unit@1.4 unit?:speed_unit@1.5-
    = ..
access
    sOffset:not_negative restriction:access@-1.7 restriction?:access@1.8- rule:access_rule@1.5 rule?:access_rule@1.6-
    = restriction*@1.8- ..
restriction
    type?:access
    = ...
height
    sOffset:not_negative inner:number outer:number
    = ..
rule
    sOffset:not_negative value
    = ..
roadMark
    sOffset:not_negative type:mark_type color:mark_colour weight?:mark_weight width?:not_negative
    laneChange?:lane_change@1.2-
    material?@1.4- height?:number@1.4-1.6 height?:positive@1.7-
    = sway*@1.5- type=mark_type?@1.3- explicit?@1.5- ...
sway
    ds:not_negative a:number b:number c:number d:number
    = ..
mark_type
    name width:not_negative@-1.6 width:positive@1.7-
    = line=mark_line+ ...@1.5-
mark_line
    length:not_negative@-1.5 length@1.6 length:not_negative@1.7- space:not_negative tOffset:number sOffset:not_negative
    rule?:mark_rule width?:not_negative@1.4 width:not_negative@1.5 width?:positive@1.6- color?:mark_colour@1.5-
    = ...@1.5 ...@1.8-
explicit
    = line=explicit_line+ ...
explicit_line
    length:positive tOffset:number sOffset:not_negative rule?:mark_rule width:not_negative@1.5 width?:positive@1.6-
    = ..
"""
