"""Imports and calls the user's controllers and lane detectors, and turns their exceptions into `ControllerError`.

Any exception of such code (also `SystemExit`, or one for a model's missing file) becomes a `ControllerError` with the
code's name and the file and line at which it was raised; the user never sees a traceback.
"""

from __future__ import annotations

import importlib
import importlib.util
import inspect
import linecache
import sys
import sysconfig
import traceback
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

from scenario_compiler.controllers.answers import BadAnswerError
from scenario_compiler.diagnostics import Code, FilePlace
from scenario_compiler.files import is_file
from scenario_compiler.trust import CodeName, Trust

UNKNOWN_CONTROLLER = Code(
    "SC503",
    "unknown-controller",
    "The scenario names a controller that is neither a built-in one nor a class derived from ControllerModel that can "
    "be found as `package.module:Class` or `file.py:Class`. Its class `Params` must derive from ControllerParams. "
    "A module must be importable where the command runs (set PYTHONPATH); a module named on the command line may also "
    "be in the scenario's folder. The path of a Python file starts from the current folder on the command line, and "
    "from the scenario's folder in a scenario.\n\n"
    '    <controller model="lane_detecton"/>     lane_detection, package.module:Class or file.py:Class',
)
CONTROLLER_FAILED = Code(
    "SC521",
    "controller-failed",
    "A controller or a lane detector of your own raised an exception, ended the program, or gave an answer that is "
    "not a `Control` or a `LaneResult` of finite numbers, or, from another method, of another type than the method's: "
    "when its module was imported, when it was created, or in a step of the run. The message names the line of its "
    "code. The run ends there, and the recording up to that step is kept.\n\n"
    "    controller 'steering:Mine', steering.py:31: FileNotFoundError: [Errno 2] No such file or directory: "
    "'model.onnx'\n\n"
    "Correct the code. A property that a controller's `Params` declare as a `pathlib.Path` starts from the scenario's "
    "folder.",
)

_PACKAGE = str(Path(__file__).resolve().parent.parent)
_Answer = TypeVar("_Answer")


class Kind(NamedTuple):
    """A kind of user code that a scenario can name.

    Attributes:
        name: Its name in messages.
        unknown: The diagnostic's code for a name that does not exist.
        fault: Returns why an object is not of this kind, as the end of a sentence; an empty text if it is.
    """

    name: str
    unknown: Code
    fault: Callable[[Any], str]


def _controller_fault(found: Any) -> str:
    from scenario_compiler.controllers.model import ControllerModel, ControllerParams  # needed for user code only

    if not (isinstance(found, type) and issubclass(found, ControllerModel)):
        return "does not derive from ControllerModel"
    params: Any = found.Params
    if not (isinstance(params, type) and issubclass(params, ControllerParams)):
        return "has a class Params that does not derive from ControllerParams"
    return ""


CONTROLLER = Kind("controller", UNKNOWN_CONTROLLER, _controller_fault)


class ControllerError(Exception):
    """A controller or detector of the user's cannot be found, imported or made, or it failed.

    Attributes:
        code: The diagnostic's code.
        place: Place in the user's code; line 0 if it is not known.
    """

    def __init__(self, message: str, code: Code = UNKNOWN_CONTROLLER, place: FilePlace | None = None) -> None:
        """Set the message, the code and the place."""
        super().__init__(message)
        self.code = code
        self.place = FilePlace("") if place is None else place

    @classmethod
    def of(cls, name: str, fault: BaseException, kind: Kind = CONTROLLER, code: object = None) -> ControllerError:
        """Return the error for an exception of user code, with the file and line that raised it.

        If no line of the user's raised it, as for a method with too few parameters, the place is the start of `code`,
        the class or the method that was called.
        """
        what = f"{type(fault).__name__}: {fault}" if str(fault) else type(fault).__name__
        place = _place_of(fault)
        return cls.at(name, place if place.file else _start_of(code), what, kind)

    @classmethod
    def at(cls, name: str, place: FilePlace, what: str, kind: Kind = CONTROLLER) -> ControllerError:
        """Return the error of a controller or detector at a place in its code."""
        where = f", {Path(place.file).name}:{place.line}" if place.file else ""
        return cls(f"{kind.name} '{name}'{where}: {what}", CONTROLLER_FAILED, place)


def load_class(name: str, code: CodeName, trust: Trust, named_in: str, kind: Kind = CONTROLLER) -> Any:
    """Import a class that the user trusts; the caller must have checked that.

    Args:
        name: The name as it was given, for messages.
        code: The code to import.
        trust: The code that the user named: such modules are also looked for in the current folder and beside the
            scenario.
        named_in: Path of the file that names it.
        kind: The kind of code that it must be.

    Raises:
        ControllerError: There is no such class, or importing it fails.
    """
    file = trust.file_of(code, named_in)
    with blamed(name, kind):
        if file is not None:
            module = _file_module(name, file, kind)
        else:
            named = trust.names(code, named_in)
            folders = [Path.cwd(), *([] if trust.beside is None else [trust.beside])] if named else []
            module = _module(name, code.source, folders, kind)
    found = getattr(module, code.attribute, None)
    if found is None:
        raise _not_there(name, f"{code.source} has no '{code.attribute}'", kind)
    fault = kind.fault(found)
    if fault:
        raise ControllerError(f"'{name}' {fault}", kind.unknown)
    return found


def _not_there(name: str, why: str, kind: Kind) -> ControllerError:
    return ControllerError(f"cannot import the {kind.name} '{name}': {why}", kind.unknown)


def _module(name: str, source: str, folders: Sequence[Path], kind: Kind) -> Any:
    try:
        with _looked_for_in(folders):
            return importlib.import_module(source)
    except ModuleNotFoundError as missing:
        if missing.name is not None and f"{source}.".startswith(f"{missing.name}."):
            raise _not_there(name, str(missing), kind) from None
        raise


def _file_module(name: str, file: Path, kind: Kind) -> Any:
    """Return the module of a Python file; the file is executed once."""
    known = sys.modules.get(str(file))
    if known is not None:
        return known
    if not is_file(file):
        raise _not_there(name, f"there is no file {file}", kind)
    spec = importlib.util.spec_from_file_location(str(file), file)
    if spec is None or spec.loader is None:
        raise _not_there(name, f"{file} is not a Python file", kind)
    module = importlib.util.module_from_spec(spec)
    sys.modules[str(file)] = module
    try:
        with _looked_for_in([file.parent]):
            spec.loader.exec_module(module)
    except BaseException:
        del sys.modules[str(file)]
        raise
    return module


@contextmanager
def _looked_for_in(folders: Sequence[Path]) -> Iterator[None]:
    """Add folders to the end of the search path for modules, within the context."""
    before = list(sys.path)
    importlib.invalidate_caches()
    sys.path.extend(str(folder.resolve()) for folder in folders)
    try:
        yield
    finally:
        sys.path[:] = before


@contextmanager
def blamed(
    name: str, kind: Kind = CONTROLLER, let_pass: tuple[type[BaseException], ...] = (), code: object = None
) -> Iterator[None]:
    """Turn exceptions of user code into a ControllerError; KeyboardInterrupt and those of `let_pass` pass.

    `code` is the class or the method that is called, if it is known.
    """
    try:
        yield
    except (ControllerError, KeyboardInterrupt):
        raise
    except BaseException as fault:
        if isinstance(fault, let_pass):
            raise
        raise ControllerError.of(name, fault, kind, code) from None


def _place_of(fault: BaseException) -> FilePlace:
    """Return the innermost line of user code, which is neither this package's, Python's nor an installed package's."""
    if isinstance(fault, SyntaxError) and fault.filename:
        return FilePlace(fault.filename, fault.lineno or 0, fault.offset or 0, 1, (fault.text or "").rstrip("\n"))
    frames = [one for one in traceback.extract_tb(fault.__traceback__) if not one.filename.startswith(("<", _PACKAGE))]
    installed = tuple(sysconfig.get_paths().values())
    if not frames:
        return FilePlace("")
    last = next((one for one in reversed(frames) if not one.filename.startswith(installed)), frames[-1])
    line = last.lineno or 0
    text = linecache.getline(last.filename, line).rstrip("\n")
    return FilePlace(last.filename, line, len(text) - len(text.lstrip()) + 1, len(text.strip()), text)


def _start_of(code: object) -> FilePlace:
    """Return the first line of a class or a function; no place if it is not Python code of the user's."""
    found: Any = inspect.unwrap(code) if callable(code) else None
    try:
        file, line = inspect.getsourcefile(found), inspect.findsource(found)[1] + 1
    except (OSError, TypeError):
        return FilePlace("")
    if file is None or file.startswith((_PACKAGE, *sysconfig.get_paths().values())):
        return FilePlace("")
    return FilePlace(file, line)


class ForeignCode:
    """An object of the user's; its exceptions and answers of a wrong type become a ControllerError.

    Attributes:
        name: Its name, for messages.
    """

    def __init__(self, name: str, kind: Kind, found: Callable[..., Any], make: Callable[[], Any]) -> None:
        """Make the object, of the class `found`.

        Raises:
            ControllerError: It cannot be made.
        """
        self.name = name
        self._kind = kind
        with blamed(name, kind, code=found):
            self.inner = make()

    def ask(self, method: str, check: Callable[..., _Answer], *arguments: Any) -> _Answer:
        """Call a method and return its answer as `check` accepts it.

        Raises:
            ControllerError: The method failed, or its answer has a wrong type.
        """
        function = getattr(type(self.inner), method, None)
        with blamed(self.name, self._kind, code=function):
            answer = getattr(self.inner, method)(*arguments)
            try:
                return check(answer)
            except BadAnswerError as bad:
                what = str(bad)
        raise ControllerError.at(self.name, _start_of(function), f"{method}: {what}", self._kind)
