"""What programs import from `scenario_compiler.perception`; see `scenario_compiler.public`."""

from scenario_compiler.perception.camera import Camera as Camera
from scenario_compiler.perception.detectors import create_detector as create_detector
from scenario_compiler.perception.labels import FARTHEST_DEPTH as FARTHEST_DEPTH
from scenario_compiler.perception.labels import Tag as Tag
from scenario_compiler.perception.lane_detector import Image as Image
from scenario_compiler.perception.lane_detector import LaneResult as LaneResult
from scenario_compiler.perception.lane_detector import LaneState as LaneState
from scenario_compiler.perception.models import Kind as Kind
from scenario_compiler.perception.models import Lamp as Lamp
from scenario_compiler.perception.render import Drawing as Drawing
from scenario_compiler.perception.road_camera import RoadCamera as RoadCamera
from scenario_compiler.perception.road_camera import scene_of as scene_of
from scenario_compiler.perception.solids import Box as Box
