"""The page on controllers (docs/controllers.md), with tables made from the classes of their inputs and outputs."""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterable
from dataclasses import MISSING, Field, fields
from typing import Any

from scenario_compiler.controllers.data import CameraMounting, Control, SensorData, VehicleState
from scenario_compiler.controllers.model import ControllerModel
from scenario_compiler.controllers.named import CONTROLLERS, controller_class

_HEAD = '''# Controllers

A controller drives the automated vehicle from Python: at every control step it receives the data of the sensors and
returns throttle, steering and brake. `lane_detection` is the packaged controller; any class that derives from
`ControllerModel` can take its place.

The tables of this page are made from the code by `make generate`.

## A controller of your own

```python
from scenario_compiler import Control, ControllerModel, ControllerParams, SensorData, VehicleState


class Straight(ControllerModel):
    """Holds the speed and the steering wheel."""

    class Params(ControllerParams):
        """Parameters, which <property> elements set."""

        gain: float = 0.5

    def control(self, sensor_data: SensorData, speed: float, vehicle: VehicleState) -> Control:
        """Accelerate to the desired speed."""
        wanted = self.params.gain * (vehicle.desired_speed - speed)
        return Control(throttle=min(max(wanted, 0.0), 1.0), steer=0.0, brake=min(max(-wanted, 0.0), 1.0))
```

A scenario names the controller as `file.py:Class` or as `package.module:Class`, and sets its parameters:

```xml
<controller model="straight.py:Straight"><property name="gain" value="0.8"/></controller>
```

A relative path of the file starts from the scenario's folder; so does a property whose parameter is declared as a
`pathlib.Path`. Reading a scenario never runs code that it names. `run` and `sweep` import the code if you trust it:

    scenario-compiler run conflict.xml --trust straight.py:Straight
    scenario-compiler run conflict.xml --controller straight.py:Straight

The second command uses this controller in place of the one that the scenario names; the properties in the scenario are
then not used. A module or file that the command line names may lie in the current folder or in the scenario's folder.
[The page on commands](commands.md#code-that-files-name) describes what can be trusted, and for how long.

## A lane detector of your own

`lane_detection` finds the lane with a detector: [`classical`](perception.md), [`learned`](perception-learned.md), or
any class whose constructor takes a camera and that has a method `detect`. The following detector uses both. It returns
the lane of the classical one, with the smaller of the two confidences:

```python
from dataclasses import replace

from scenario_compiler.perception import Camera, Image, LaneResult, LaneState, create_detector


class Cautious:
    """The classical detector's lane with the smaller confidence of the two detectors."""

    def __init__(self, camera: Camera) -> None:
        """Prepare for one camera."""
        self.detectors = create_detector("classical", camera), create_detector("learned", camera)

    def detect(self, image: Image, prior: LaneState | None = None, pitch: float | None = None) -> LaneResult:
        """Return the lane that the camera is in."""
        first, second = (one.detect(image, prior, pitch) for one in self.detectors)
        left = replace(first.left, p=min(first.left.p, second.left.p))
        right = replace(first.right, p=min(first.right.p, second.right.p))
        health = first.sensor_health
        return replace(first, left=left, right=right, p_left=left.p * health, p_right=right.p * health)
```

A scenario names the detector in the controller. Its code must be trusted like a controller's:

```xml
<controller><detector model="cautious.py:Cautious"/></controller>
```

    scenario-compiler run conflict.xml --trust cautious.py:Cautious

`detect` receives the image, the remembered state of the lane (the controller updates it with `LaneState.after`), and
the camera's tilt if it is known. A controller of your own can also use the detector that the scenario names: derive it
from `LaneDetectionController`, or set `uses_detector`, and create the detector with `self.make_detector(camera)`.

## With a neural network

`examples/onnx_controller` steers with a neural network from an ONNX file. OpenCV runs the network, so no other package
is needed:

    scenario-compiler run examples/onnx_controller/keep_lane.xml --trust examples/onnx_controller/steering.py

`train.py` in that folder draws the pictures, trains the network and writes the file. Only training needs `onnx`
(`pip install 'scenario-compiler[examples]'`).

## When it fails

A controller or a detector fails if it raises an exception, if a model file is missing, if it calls `sys.exit`, or if
it does not return a `Control` (a detector: a `LaneResult`) with finite numbers. So does a controller if one of its
[other methods](#other-methods) returns something of another type. This is reported as SC521 with the name of the
controller or detector, the file and the line. The run ends with the stop reason `controller_failed`, the recording up
to that step is kept, and the exit code is 1.

## Inputs

`control(sensor_data, speed, vehicle)` is called every `control_every` steps; `speed` is the speed of the ego in m/s.
With `--perception ideal` and `--perception surrogate`, no image is drawn and the controller is not called;
[surrogate perception](perception-surrogate.md) replaces `lane_detection` only.
'''

_METHODS = """## Other methods

Every run creates one instance of the controller. These methods can be overridden:
"""

_OURS = """## Packaged controllers
"""


def controllers_page() -> str:
    """Return the page on controllers."""
    parts = [_HEAD]
    for shape in (SensorData, CameraMounting, VehicleState):
        parts += [f"### {shape.__name__}\n", _first_line(shape), _attributes(shape)]
    parts += ["## Output\n", "### Control\n", _first_line(Control), _attributes(Control), _METHODS]
    methods = [
        (f"`{name}({', '.join(list(inspect.signature(method).parameters)[1:])})`", _first_line(method).strip())
        for name, method in vars(ControllerModel).items()
        if inspect.isfunction(method) and not name.startswith("_") and name != "control"
    ]
    parts += [_table(("method", "purpose"), methods), _OURS]
    for name in CONTROLLERS:
        ours = controller_class(name)
        parts += [f"### `{name}`\n", _first_line(ours), _table(("property", "default", "meaning"), _parameters(ours))]
    return "\n".join(parts)


def _first_line(documented: Any) -> str:
    """Return the first paragraph of a docstring."""
    return re.sub(r"\s*\n\s*", " ", (inspect.getdoc(documented) or "").split("\n\n")[0]) + "\n"


def _attributes(shape: type[Any]) -> str:
    """Return the table of a dataclass's fields: name, type, default, and the description in the docstring."""
    texts = _texts(shape)
    rows = [(f"`{one.name}`", f"`{one.type}`", _default(one), texts[one.name]) for one in fields(shape)]
    return _table(("field", "type", "default", "meaning"), rows)


def _default(one: Field[Any]) -> str:
    return "" if one.default is MISSING else f"`{one.default!r}`"


def _texts(shape: type[Any]) -> dict[str, str]:
    """Return the description of each field in the `Attributes` section of the docstring.

    Raises:
        KeyError: A field has no line there.
    """
    listed = (inspect.getdoc(shape) or "").partition("Attributes:\n")[2]
    found = re.findall(r"^    (\w+): (.+(?:\n {8}.+)*)", listed, re.MULTILINE)
    texts = {name: re.sub(r"\s*\n\s*", " ", text) for name, text in found}
    return {one.name: texts[one.name] for one in fields(shape)}


def _parameters(controller: type[ControllerModel]) -> Iterable[tuple[str, str, str]]:
    """Yield name, default and description of the parameters of a controller."""
    for name, one in controller.Params.model_fields.items():
        yield f"`{name}`", f"`{one.default}`", one.description or ""


def _table(heads: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> str:
    """Return a table in Markdown."""
    lines = [heads, tuple("---" for _ in heads), *rows]
    return "".join("| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |\n" for line in lines)
