"""The engine's integer codes. Their names are unique in the package, because all meet in one compiled library."""

from __future__ import annotations

from scenario_compiler.roads.tables import LANE_LIMIT
from scenario_compiler.vocabulary import horizon

NONE = -1
"""Index that refers to nothing."""

FAR = 1.0e9
"""Distance or time that means "there is none": finite, so that it can be compared, subtracted and written."""

STANDING = 0.05
"""Speed below which an entity stands, m/s."""

TOLERANCE = horizon.TOLERANCE
"""Tolerance of every comparison of times and condition values."""

# Motion kinds.
MOTION_STATIC = 0
MOTION_SCRIPTED = 1
MOTION_BICYCLE = 2
MOTION_POSED = 3
MOTION_TRAFFIC = 4
MOTION_WALKER = 5

# Positions.
POSITION_LANE = 0
POSITION_RELATIVE = 1
POSITION_BESIDE = 2
POSITION_RANDOM = 3
POSITION_FREE = 4
POSITION_LANES_AWAY = 5
POSITION_RELATIVE_ROAD = 6
POSITION_RELATIVE_OBJECT = 7
POSITION_RELATIVE_WORLD = 8
POSITION_ON_TRAJECTORY = 9
POSITION_KINDS = 10
"""Number of kinds of positions."""

# Switches of positions, as bits.
POSITION_ABSOLUTE = 1
"""The heading is that in the world, not relative to that of the position."""
POSITION_ALONG_LANE = 2
"""Distances follow the lane's direction of travel, not the road's s."""
POSITION_WITH_HEIGHT = 4
"""z is given: of roads above each other, the one nearest in height is meant."""

# Observers of an entity, as bits.
SEEN_IN_PICTURES = 1
SEEN_BY_SENSORS = 2
SEEN_BY_TRAFFIC = 4
SEEN_BY_ALL = 7

# Storyboard elements and their states.
ELEMENT_STORY = 0
ELEMENT_ACT = 1
ELEMENT_GROUP = 2
ELEMENT_MANEUVER = 3
ELEMENT_EVENT = 4
ELEMENT_ACTION = 5

STANDBY = 0
RUNNING = 1
COMPLETE = 2

PRIORITY_PARALLEL = 0
PRIORITY_OVERRIDE = 1
PRIORITY_SKIP = 2

ALL_MARKS = LANE_LIMIT
"""Lane of a stretch of marks that means every mark of the road."""

# Conditions.
SIDE_BOTH = 0
SIDE_LEFT = 1
SIDE_RIGHT = 2
SIDE_EITHER = 3
"""The side of the lane to which a condition on the confidence refers."""

# How a condition measures: coordinate system, component, angle; and the transition that it waits for.
FRAME_ENTITY = 0
FRAME_LANE = 1
FRAME_ROAD = 2
FRAME_TRAJECTORY = 3
FRAME_WORLD = 4

MEASURE_STRAIGHT = 0
MEASURE_ALONG = 1
MEASURE_ACROSS = 2

PART_TOTAL = 0
PART_ALONG = 1
PART_ACROSS = 2
PART_UP = 3

ANGLE_HEADING = 0
ANGLE_PITCH = 1
ANGLE_ROLL = 2

TRANSITION_START = 0
TRANSITION_END = 1
TRANSITION_STOP = 2
TRANSITION_SKIP = 3

KIND_ANY = 0
KIND_VEHICLE = 1
KIND_PEDESTRIAN = 2
KIND_THING = 3

AT_REST = 1.0e-3
"""Speed below which an entity counts as standing for a condition, m/s (esmini 3.6)."""

RULE_LESS = 0
RULE_LESS_OR_EQUAL = 1
RULE_GREATER = 2
RULE_GREATER_OR_EQUAL = 3
RULE_EQUAL = 4
RULE_NOT_EQUAL = 5

EDGE_NONE = 0
EDGE_RISING = 1
EDGE_FALLING = 2
EDGE_BOTH = 3

DELAY_RECORDS = 256
"""Number of value changes that a delayed condition remembers."""

# Actions.
ACTION_ENDS = 1.0
"""Value of `State.action_b` of an action on traffic that was stopped and ends in its next step."""

# Switches of actions, as bits.
FLAG_CONTINUOUS = 1
"""The target is kept after it has been reached."""
FLAG_FREESPACE = 2
"""The distance is measured between the boxes."""
FLAG_TIME_GAP = 4
"""The distance is a time gap."""
FLAG_PRESENT = 8
"""The distance is that at the start of the action."""
FLAG_LIMITED = 16
"""The motion is limited; otherwise the entity is put there at once."""
FLAG_BEHIND = 32
"""Behind the other entity, or to its right."""
FLAG_AHEAD = 64
"""Ahead of the other entity, or to its left."""

FLAG_SMOOTH = 128
"""Speeds are reached smoothly."""
FLAG_OWN_PATH = 256
"""The entity moves along points of its own, not along the road."""
FLAG_ON_TRACK = 1024
"""These points are those of a trajectory."""
FLAG_TIMED = 2048
"""The times of these points determine the entity's speed."""

# Whether a value is added to that of another entity or multiplied by it.
MODE_DELTA = 0
MODE_FACTOR = 1

# The final speed: not given, absolute, a difference to another entity's speed, or a factor of it.
FINAL_NONE = 0
FINAL_ABSOLUTE = 1
FINAL_DELTA = 2
FINAL_FACTOR = 3

MODIFY_ADD = 0
MODIFY_MULTIPLY = 1

# The kinds of controllers, and in an action the one that the entity has.
CONTROLLER_DEFAULT = 0
CONTROLLER_FOLLOW = 1
CONTROLLER_PRESENT = 2

HELD_THROTTLE = 0
HELD_BRAKE = 1
HELD_CLUTCH = 2
HELD_PARKING_BRAKE = 3
HELD_WHEEL = 4
HELD_GEAR = 5
HELD_INPUTS = 6

# Failures of the camera.
FAILURE_NOISE = 0
FAILURE_DROPOUT = 1
FAILURE_FREEZE = 2
FAILURE_BLACKOUT = 3
FAILURE_BLUR = 4
FAILURE_DIRT = 5
FAILURE_IMPULSE_NOISE = 6
FAILURE_OVEREXPOSURE = 7
FAILURE_DEAD_ROWS = 8
FAILURE_QUANTISATION = 9
FAILURE_LATENCY = 10
FAILURE_MOTION_BLUR = 11
FAILURE_MISALIGNMENT = 12
FAILURES = 13

WEATHER_SIZE = 14
"""Number of values of a weather."""

SHAPE_LINEAR = 0
SHAPE_SINUSOIDAL = 1
SHAPE_CUBIC = 2
SHAPE_STEP = 3

DIMENSION_TIME = 0
DIMENSION_RATE = 1
DIMENSION_DISTANCE = 2

# Perception: the source of the lane confidence, which also determines what drives in the automated state.
PERCEPTION_IDEAL = 0
PERCEPTION_CAMERA = 1
PERCEPTION_SURROGATE = 2

SPREAD_OF_WINDOW = 2
"""Index of the spread of the lateral position in the window that may be stable; 0 and 1 are those of the windows after
the response.
"""

SENSOR_CAMERA = 0
SENSOR_RADAR = 1
SENSOR_LIDAR = 2

# Takeover.
TAKEOVER_AUTOMATED = 0
TAKEOVER_WARNING = 1
TAKEOVER_REQUEST = 2
TAKEOVER_ESCALATION = 3
TAKEOVER_MANUAL = 4
TAKEOVER_HAND_BACK = 5
TAKEOVER_MINIMUM_RISK = 6
TAKEOVER_STANDSTILL = 7

CAUSE_NONE = 0
CAUSE_CONTROLLER = 1
CAUSE_SENSOR_HEALTH = 2
CAUSE_LANE_CONFIDENCE = 3
CAUSE_PATH_BLOCKED = 4
CAUSE_LANE_ENDS = 5
CAUSE_NO_PROGRESS = 6
CAUSE_SCHEDULED = 7
"""An action of the scenario requests."""
CAUSES = 8

# Meanings of the state of a traffic signal.
ASPECT_NONE = 0
"""No restriction: green, dark or unknown."""
ASPECT_CAUTION = 1
ASPECT_STOP = 2

# Classes of objects ahead.
AHEAD_NOTHING = 0
AHEAD_FOLLOWED = 1
AHEAD_BLOCKING = 2

DRIVER_LOGNORMAL = 0
DRIVER_FIXED = 1
DRIVER_NORMAL = 2
DRIVER_SUMO = 3

# Behaviour of the automation before and after a request.
BEHAVIOUR_FOLLOW = 0
BEHAVIOUR_HOLD_SPEED = 1
BEHAVIOUR_SLOW_DOWN = 2
BEHAVIOUR_LET_GO = 3

# Where a vehicle stands.
STANDS_NOWHERE = 0
STANDS_IN_OWN_LANE = 1
STANDS_IN_OTHER_LANE = 2
STANDS_ON_SHOULDER = 3
STANDS_OFF_ROAD = 4
STANDS_ACROSS_EDGE = 5

# What a driver does about an obstacle.
STYLE_BRAKES = 0
STYLE_STEERS = 1
STYLE_BOTH = 2

# Reference drivers; the careful and competent one in three readings of a cut-in: by time, by distance, by overlap.
REFERENCE_NONE = 0
REFERENCE_CAREFUL = 1
REFERENCE_CAREFUL_WAY = 2
REFERENCE_CAREFUL_OVERLAP = 3
REFERENCE_RSS = 4
REFERENCE_FUZZY = 5
REFERENCES = 6

WISH_NONE = 0
WISH_TAKE_OVER = 1
WISH_HAND_BACK = 2
WISH_LEAVE = 3
WISH_REQUEST = 4
"""What the person at the wheel wants from the automation; the last one is an experimenter's wish."""

MANOEUVRE_KEEP = 0
MANOEUVRE_BRAKE = 1
MANOEUVRE_EVADE = 2
MANOEUVRE_MERGE = 3

# The event log's vocabulary (after the data storage of UN R157 8.2.1, and the storyboard).
EVENT_ACTIVATION = 0
EVENT_WARNING = 1
EVENT_REQUEST = 2
EVENT_ESCALATION = 3
EVENT_RESPONSE = 4
EVENT_HAND_BACK = 5
EVENT_MINIMUM_RISK = 6
EVENT_STANDSTILL = 7
EVENT_COLLISION = 8
EVENT_MERGE = 9
EVENT_MERGE_ABORTED = 10
EVENT_BRAKE = 11
EVENT_EVADE = 12
EVENT_ACTION = 13
"""An action with an event in the log has started; the value is its row."""
EVENT_STORYBOARD_START = 14
EVENT_STORYBOARD_END = 15
EVENT_WARNING_OVER = 16
EVENT_FAILURE = 17
EVENT_FAILURE_END = 18
EVENT_HAZARD_LIGHTS = 19
EVENT_CONTACT = 20
EVENT_NO_PROGRESS = 21
EVENT_EYES_ON = 22
EVENT_HANDS_ON = 23
EVENT_OVERRIDE = 24
EVENT_OBSTRUCTION = 25
EVENT_OUTSIDE_DOMAIN = 26
EVENT_SHORT_START = 27
EVENT_NO_LANE = 28
LOG_SIZE = 128
"""Number of events of the ego and of the run that have room in the log; a step has far fewer."""

# Why a run stopped.
STOP_NONE = 0
STOP_DURATION = 1
STOP_TRIGGER = 2
STOP_DESTINATION = 3
STOP_STANDSTILL = 4
STOP_COLLISION = 5
STOP_ERROR = 6

# Faults that a run reports in `State.flag`.
FAULT_NONE = 0
FAULT_NOT_FINITE = 1
FAULT_OFF_ROAD_START = 2
FAULT_UNKNOWN_CONDITION = 3
FAULT_UNKNOWN_ACTION = 4
FAULT_UNKNOWN_SHAPE = 5
FAULT_UNKNOWN_MOTION = 6
FAULT_DELAY_OVERFLOW = 7
FAULT_UNKNOWN_RULE = 8
FAULT_UNKNOWN_EDGE = 9
FAULT_NO_ROOM = 10

# Trajectories.
TRACK_POLYLINE = 0
TRACK_CLOTHOIDS = 1
TRACK_NURBS = 2

TIMING_NONE = 0
TIMING_RELATIVE = 1
TIMING_ABSOLUTE = 2

FOLLOW_SMOOTHLY = 1
"""Flag of an action that follows a trajectory: its heading changes linearly, not only near the corners."""

RANDOM_GUIDE = -2
"""Stands in place of a guide for random turns."""

# Streams of the counter hash inside a run.
STREAM_PLACE = 2
STREAM_TURN = 3
STREAM_FAILURE = 4
STREAM_TRAFFIC = 5
STREAM_DRIVER = 6
STREAM_ODOMETRY = 7
STREAM_WANDER = 8
STREAM_SURROGATE = 9

# Sizes of scratch columns.
BUCKETS = 128
"""Number of chains of the list of entities by road."""

DRIVES_BY_RULES = 1 << 30
"""Stands in place of an action in `State.lateral`: a vehicle of background traffic changes its lane by itself."""

PLACE_ATTEMPTS = 200
"""Number of places that are drawn for an entity before it is reported that there is no room."""

WAY_SIZE = 16
"""Greatest number of roads of a way."""

ROUTE_REACH = 40
"""Distance for which the ego's controller knows the route ahead, m: what a camera sees of the ground, and some more."""

OUTLOOK_HEAD = 4
"""Number of values of an outlook before its points: gap to the leader, its speed, distance to the next junction, and
speed for the bends ahead."""

OUTLOOK_POINT = 5
"""Number of values of each point: x, y, width, height and rise to the left."""

OUTLOOK_SIZE = OUTLOOK_HEAD + OUTLOOK_POINT * (ROUTE_REACH + 1)

DRAW_PERSON = 0
DRAW_SEED = 1
DRAWS_PER_RUN = 2
"""Number of draws: the standard normal number of the driver as a person, and the seed of the counter hash."""
