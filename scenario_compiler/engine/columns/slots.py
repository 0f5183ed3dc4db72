"""The slots of numbers in `Program.const`: fixed ones of the run, and offsets into the blocks of other things.

Every number of a plan goes through this one column, so that a variant of a plan is one row.
"""

from __future__ import annotations

K_STEP = 0
K_DURATION = 1
K_NOISE = 2
K_DESTINATION_S = 3
K_DESTINATION_OFFSET = 4
K_BUDGET = 5
K_ESCALATE_AFTER = 6
K_DISTANCE_ERROR = 7
K_MINIMUM_RISK_DECELERATION = 8
K_HAND_BACK_AFTER = 9
K_CONFIDENCE_WARNING = 10
K_CONFIDENCE_REQUEST = 11
K_CONFIDENCE_COUNT = 12
K_CONFIDENCE_OF = 13
K_HEALTH_WARNING = 14
K_HEALTH_REQUEST = 15
K_HEALTH_COUNT = 16
K_HEALTH_OF = 17
K_BLOCKED_MARGIN = 18
K_BLOCKED_COUNT = 19
K_BLOCKED_OF = 20
K_SENSOR_RANGE = 21
K_FIELD_OF_VIEW = 22
K_LANE_END_COUNT = 23
K_LANE_END_OF = 24
K_GAP_FRONT = 25
K_GAP_REAR = 26
K_DRIVER_TIME = 27
K_DRIVER_MU = 28
K_DRIVER_SIGMA = 29
K_DRIVER_LAPSE = 30
K_NO_PROGRESS_AFTER = 31
K_DRIVER_PERSON = 32
K_DRIVER_LATE = 33
K_DRIVER_LATEST = 34
K_EYES_ON = 35
K_HANDS_ON = 36
K_STAGE_SPREAD = 37
K_EFFECT_TASK = 38
K_EFFECT_MEASURED_TASK = 39
K_EFFECT_EYES_CLOSED = 40
K_EFFECT_REQUEST = 41
K_EFFECT_REPETITION = 42
K_EFFECT_BUDGET = 43
K_REFERENCE_BUDGET = 44
K_EFFECT_DENSITY = 45
K_DENSITY = 46
K_INPUT_STEERING = 47
K_INPUT_BRAKE = 48
K_STEERING_RATIO = 49
K_PLACE_ERROR = 50
K_HEADING_ERROR = 51
K_GYRO_BIAS = 52
K_GYRO_NOISE = 53
K_BRAKES = 54
K_STEERS = 55
K_DRIVER_DECELERATION = 56
K_DRIVER_LATERAL = 57
K_PERCEPTION_TIME = 58
K_REACTION_TIME = 59
K_SDLP = 60
K_SDLP_AT_FIRST = 61
K_SETTLED_AFTER = 62
K_RISK_AFTER = 63
"""First of the times to the minimum-risk manoeuvre, one for each cause in the order of the codes."""
K_WARNING_LEAD = 71
K_WARNING_AFTER = 72
K_WARNING_LEAST = 73
K_WARNING_CLEAR = 74
K_CONFIDENCE_OVER = 75
K_HEALTH_OVER = 76
K_BLOCKED_BUDGET = 77
K_BLOCKED_WARNING = 78
K_LANE_END_BUDGET = 79
K_LANE_END_WARNING = 80
"""Time budgets of requests and warnings, s; negative if the policy's value applies."""
K_SLOW_DOWN = 81
K_HEADLIGHTS = 82
K_SENSOR_NOISE = 83
K_SIGHT = 84
K_LOOK_BESIDE = 85
K_LOOK_AHEAD_TIME = 86
K_LOOK_AHEAD_LEAST = 87
K_LOOK_AHEAD_MOST = 88
K_SPEED_GAIN = 89
K_TIME_GAP = 90
K_MINIMUM_GAP = 91
K_LATERAL = 92
K_ACCELERATION = 93
K_DECELERATION = 94
"""Parameters of `lane_detection`, in the order of `LANE_KEEPING`."""
K_ENTITIES = 95
"""First slot after those of the run."""

# An entity's block.
E_LENGTH = 0
E_WIDTH = 1
E_HEIGHT = 2
E_WHEELBASE = 3
E_CENTER = 4
E_MAX_STEER = 5
E_MAX_ACCELERATION = 6
E_MAX_DECELERATION = 7
E_MAX_SPEED = 8
E_SPEED = 9
E_DESIRED_SPEED = 10
E_TIME_GAP = 11
E_MINIMUM_GAP = 12
E_ACCELERATION = 13
E_DECELERATION = 14
E_SHARE = 15
"""Share of the speed limit that a driver of background traffic aims for."""
E_HITCH = 16
"""x of the hitch, relative to the reference point, and of the trailer's coupler, m."""
"""x of the hitch ahead of the reference point, and of the trailer's coupler."""
E_COUPLER = 17
E_PITCH_GRADIENT = 18
"""Pitch of the body per deceleration, rad per m/s2."""

# A position: s, or the distance ahead, or the least distance to others; the lateral offset; and the heading, in the
# world or relative to that of the position. For a point of the world these are x, y, the heading and z.
P_S = 0
P_OFFSET = 1
P_TURN = 2
P_Z = 3

# A stretch of marks.
M_FROM = 0
M_TO = 1
M_QUALITY = 2
M_QUALITY_TO = 3
M_COVERAGE = 4

# A condition: the value compared with, the delay, and the radius of a position.
C_VALUE = 0
C_DELAY = 1
C_TOLERANCE = 2
"""Tolerance of an angle, rad."""
C_FORWARD = 2
C_BACKWARD = 3
"""Ranges of a clearance, m."""

# An action: the target and the value of its dynamics.
A_TARGET = 0
A_DYNAMICS = 1

# Limits of a motion, negative if absent; then the entries of a speed profile: a speed and a time (negative if absent).
A_ACCELERATION = 2
A_ACCELERATION_RATE = 3
A_DECELERATION = 4
A_DECELERATION_RATE = 5
A_MOST_SPEED = 6
A_ENTRIES = 7

# A synchronized arrival: the tolerances for being there, and the final stretch at constant speed.
A_TOLERANCE = 2
A_MASTER_TOLERANCE = 3
A_STEADY_TIME = 4
A_STEADY_DISTANCE = 5

# A failure of the camera: its onset after the start or its action, its duration (negative: until the end), the
# duration of its ramps, its severity, and the angles of a misaligned camera.
F_ONSET = 0
F_DURATION = 1
F_RAMP = 2
F_AMOUNT = 3
F_YAW = 4
F_PITCH = 5
F_ROLL = 6

# A swarm of traffic: inner radius, half extents along and across the entity, distance of its centre ahead of it,
# and weights of vehicles in the entity's direction and in the opposite one.
W_INNER = 0
W_MAJOR = 1
W_MINOR = 2
W_OFFSET = 3
W_SAME = 4
W_OPPOSITE = 5

# A source or sink of traffic: its radius, and the vehicles per second (not positive: no limit).
U_RADIUS = 0
U_RATE = 1

# A stretch from which random positions are drawn.
L_FROM = 0
L_TO = 1

# A point of a path: the time since the path began, negative if absent.
G_TIME = 0

# A corner of a trajectory: its time (negative if absent); for a clothoid also the curvatures at its beginning and end,
# its length, and its heading relative to the end of the previous piece.
T_TIME = 0
T_CURVATURE = 1
T_CURVATURE_END = 2
T_LENGTH = 3
T_TURN = 4

# An action that follows a trajectory: the start distance, and the offset and scale of its times.
J_BEGIN = 0
J_OFFSET = 1
J_SCALE = 2
