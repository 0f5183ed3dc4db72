"""What is imported from `scenario_compiler.roads`; each name is loaded from its home when it is first used."""

from scenario_compiler.roads.network import Network as Network
from scenario_compiler.roads.network import load_network as load_network
from scenario_compiler.roads.positions import LaneAt as LaneAt
from scenario_compiler.roads.positions import LanePosition as LanePosition
from scenario_compiler.roads.positions import Leg as Leg
from scenario_compiler.roads.positions import Located as Located
from scenario_compiler.roads.positions import Mark as Mark
from scenario_compiler.roads.positions import MarkStretch as MarkStretch
from scenario_compiler.roads.positions import Pose as Pose
from scenario_compiler.roads.positions import RoadDescription as RoadDescription
from scenario_compiler.roads.positions import Route as Route
from scenario_compiler.roads.positions import SecondaryLine as SecondaryLine
