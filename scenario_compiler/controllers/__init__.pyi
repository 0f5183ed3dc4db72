"""What is imported from `scenario_compiler.controllers`; each name is loaded from its home when it is first used."""

from scenario_compiler.controllers.data import CameraMounting as CameraMounting
from scenario_compiler.controllers.data import Control as Control
from scenario_compiler.controllers.data import SensorData as SensorData
from scenario_compiler.controllers.data import VehicleState as VehicleState
from scenario_compiler.controllers.foreign import CONTROLLER_FAILED as CONTROLLER_FAILED
from scenario_compiler.controllers.foreign import ControllerError as ControllerError
from scenario_compiler.controllers.model import ControllerModel as ControllerModel
from scenario_compiler.controllers.model import ControllerParams as ControllerParams
from scenario_compiler.controllers.named import CONTROLLERS as CONTROLLERS
from scenario_compiler.controllers.named import check_controller as check_controller
from scenario_compiler.controllers.named import controller_class as controller_class
from scenario_compiler.controllers.named import create_controller as create_controller
from scenario_compiler.controllers.named import refuse_untrusted as refuse_untrusted
from scenario_compiler.controllers.named import report_controller as report_controller
