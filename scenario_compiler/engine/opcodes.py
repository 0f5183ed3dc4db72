"""The engine's integer codes. A code's name is unique in the package: all of them meet in one compiled module."""

from __future__ import annotations

NONE = -1
"""Index that refers to nothing."""

FAR = 1.0e9
"""Distance or time that stands for "none there": finite, so that it can be compared, subtracted and written."""

STANDING = 0.05
"""Speed under which an entity stands, m/s."""

TOLERANCE = 1.0e-6
"""Slack of every comparison of times and condition values (esmini 3.6)."""

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

ALL_MARKS = 1 << 20
"""Lane of a stretch of marks that means every mark of the road."""

# Conditions.
CONDITION_TIME = 0
CONDITION_TIME_HEADWAY = 1
CONDITION_DISTANCE = 2
CONDITION_TIME_TO_COLLISION = 3
CONDITION_SPEED = 4
CONDITION_REACH_POSITION = 5
CONDITION_TRAVELED_DISTANCE = 6
CONDITION_LANE_CONFIDENCE = 7
CONDITION_TAKEOVER_STATE = 8
CONDITION_LONGITUDINAL_DISTANCE = 9
CONDITION_ELEMENT_STATE = 10
CONDITION_STANDSTILL = 11
CONDITION_SENSOR_HEALTH = 12

SIDE_BOTH = 0
SIDE_LEFT = 1
SIDE_RIGHT = 2
SIDE_EITHER = 3
"""Of which side of the lane a condition on the confidence speaks."""

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
"""Changes of value that a delayed condition remembers."""

# Actions.
ACTION_SPEED = 0
ACTION_LANE_CHANGE = 1
ACTION_SENSOR_NOISE = 2
ACTION_LANE_OFFSET = 3
ACTION_FOLLOW_PATH = 4
ACTION_FAILURE = 5
ACTION_END_FAILURE = 6
ACTION_WEATHER = 7
ACTION_MESSAGE = 8
ACTION_STOP = 9

# Failures of the camera.
FAILURE_NOISE = 0
FAILURE_DROPOUT = 1
FAILURE_FREEZE = 2
FAILURE_BLACKOUT = 3
FAILURE_BLUR = 4
FAILURE_DIRT = 5
FAILURES = 6

WEATHER_SIZE = 14
"""Numbers of a weather."""

SHAPE_LINEAR = 0
SHAPE_SINUSOIDAL = 1
SHAPE_CUBIC = 2
SHAPE_STEP = 3

DIMENSION_TIME = 0
DIMENSION_RATE = 1
DIMENSION_DISTANCE = 2

# Perception: where the lane confidence comes from, and with it who drives while automated.
PERCEPTION_IDEAL = 0
PERCEPTION_CAMERA = 1

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
CAUSES = 6

DRIVER_LOGNORMAL = 0
DRIVER_FIXED = 1

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
EVENT_SENSOR_NOISE = 13
EVENT_STORYBOARD_START = 14
EVENT_STORYBOARD_END = 15
EVENT_WARNING_OVER = 16
EVENT_FAILURE = 17
EVENT_FAILURE_END = 18
EVENT_WEATHER = 19
EVENT_MESSAGE = 20
LOG_SIZE = 128
"""Events that a run remembers; later ones are counted but not kept."""

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

# Streams of the counter hash inside a run.
STREAM_STEERING = 1
STREAM_PLACE = 2
STREAM_TURN = 3
STREAM_FAILURE = 4

# Sizes of scratch columns.
BUCKETS = 128
"""Chains of the list of entities by road."""

DRIVES_BY_RULES = 1 << 30
"""In place of an action in `State.lateral`: a vehicle of traffic changes its lane by itself."""

PLACE_ATTEMPTS = 200
"""Places that are drawn for an entity before there is no room for it."""

WAY_SIZE = 16
"""Roads that a look ahead crosses at most."""

DRAWS_PER_RUN = 9
"""Takeover time and lapse of up to four requests, and the seed of the counter hash."""
