"""The page on controllers (docs/controllers.md), with tables made from what controllers get and answer."""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterable
from dataclasses import MISSING, Field, fields
from typing import Any

from scenario_compiler.controllers import CONTROLLERS, controller_class
from scenario_compiler.controllers.model import CameraMounting, Control, ControllerModel, SensorData, VehicleState

_HEAD = '''# Controllers

A controller drives the automated vehicle from Python: at every control step it gets what the sensors deliver and
answers with throttle, steering and brake. `lane_detection` comes with the program; any class that derives from
`ControllerModel` is another.

The tables of this page are made from the code by `make generate`.

## One of your own

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

A scenario names it, as `file.py:Class` or as `package.module:Class`, and sets its parameters:

```xml
<controller model="straight.py:Straight"><property name="gain" value="0.8"/></controller>
```

The path of the file, and a property whose parameter is declared as a `pathlib.Path`, start from the scenario's folder.
Reading a scenario never runs code that it names; `run` and `sweep` import it where you say that you trust it:

    scenario-compiler run conflict.xml --trust straight.py:Straight
    scenario-compiler run conflict.xml --controller straight.py:Straight

The second drives with that controller, whatever the scenario names. A module or file that the command line names
may lie in the current folder or beside the scenario. The scenario's properties stay with the controller that it names.
[The page on commands](commands.md#code-that-files-name) says what may be trusted, and for how long.

## A lane detector of your own

`lane_detection` looks for the lane with a detector: [`classical`](perception.md), [`learned`](perception-learned.md),
or any class that is made with a camera and has a method `detect`. This one sees with both, and trusts the lane of the
classical one as far as the more doubtful of the two does:

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

A scenario names it in the controller, and it is trusted as a controller's code is:

```xml
<controller><detector model="cautious.py:Cautious"/></controller>
```

    scenario-compiler run conflict.xml --trust cautious.py:Cautious

`detect` gets the picture, what was remembered of the lane (the controller keeps it with `LaneState.after`), and a tilt
where one is known. A controller of your own that derives from `LaneDetectionController`, or that sets `uses_detector`,
makes the detector that the scenario names with `self.make_detector(camera)`.

## With a neural network

`examples/onnx_controller` steers by a network from an ONNX file, which OpenCV runs; nothing else is needed:

    scenario-compiler run examples/onnx_controller/keep_lane.xml --trust examples/onnx_controller/steering.py

`train.py` there draws the pictures, trains the network and writes the file; it alone needs `onnx`
(`pip install scenario-compiler[examples]`).

## When it fails

The following are the finding SC521, with the controller's or detector's name, the file and the line: an exception, a
missing model file, `sys.exit` at import, or an answer that is not a `Control` (for a detector, a `LaneResult`) or
contains a number that is not finite. The run ends there with the stop reason `controller_failed`, the recording up to
that step is kept, and the exit code is 1.

## What it gets

`control(sensor_data, speed, vehicle)` is called every `control_every` steps; `speed` is the vehicle's own in m/s.
With `--perception ideal` and `--perception surrogate` no picture is drawn and no controller is asked; [surrogate
perception](perception-surrogate.md) stands for `lane_detection` alone.
'''

_METHODS = """## What else it may do

A controller is one instance a run. These methods may be overridden:
"""

_OURS = """## The controllers that come with the program
"""


def controllers_page() -> str:
    """Return the page on controllers."""
    parts = [_HEAD]
    for shape in (SensorData, CameraMounting, VehicleState):
        parts += [f"### {shape.__name__}\n", _first_line(shape), _attributes(shape)]
    parts += ["## What it answers\n", "### Control\n", _first_line(Control), _attributes(Control), _METHODS]
    methods = [
        (f"`{name}({', '.join(list(inspect.signature(method).parameters)[1:])})`", _first_line(method).strip())
        for name, method in vars(ControllerModel).items()
        if inspect.isfunction(method) and not name.startswith("_") and name != "control"
    ]
    parts += [_table(("method", "does"), methods), _OURS]
    for name in CONTROLLERS:
        ours = controller_class(name)
        parts += [f"### `{name}`\n", _first_line(ours), _table(("property", "default", "means"), _parameters(ours))]
    return "\n".join(parts)


def _first_line(documented: Any) -> str:
    """Return the first paragraph of a docstring."""
    return re.sub(r"\s*\n\s*", " ", (inspect.getdoc(documented) or "").split("\n\n")[0]) + "\n"


def _attributes(shape: type[Any]) -> str:
    """Return the table of a dataclass's fields: name, type, default and what the docstring says of it."""
    texts = _texts(shape)
    rows = [(f"`{one.name}`", f"`{one.type}`", _default(one), texts[one.name]) for one in fields(shape)]
    return _table(("field", "type", "default", "holds"), rows)


def _default(one: Field[Any]) -> str:
    return "" if one.default is MISSING else f"`{one.default!r}`"


def _texts(shape: type[Any]) -> dict[str, str]:
    """Return what the `Attributes` of a docstring say of each field.

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
