"""Decides whether code that a file names may be imported; every command asks before it imports such code.

A file can name code (a controller's class), but cannot make it run. Code runs only if the user has named it: on the
command line, in a program, or in the list of the user's configuration file. That file is in the user's configuration
folder (`resources.configuration_file`), never beside a scenario.
"""

from __future__ import annotations

import re
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

from scenario_compiler.files import is_file, read_file
from scenario_compiler.resources import configuration_file

MOST_CONFIGURATION_BYTES = 1024 * 1024
"""Largest configuration file that is read, bytes."""

_NAME = r"[A-Za-z_]\w*"
_MODULE = re.compile(rf"{_NAME}(?:\.{_NAME})*")
_CLASS = re.compile(_NAME)


class ConfigurationError(ValueError):
    """The user's configuration file cannot be read; the message has the file and the reason."""


class CodeName(NamedTuple):
    """The name of a class in a scenario or on the command line: `package.module:Class` or `file.py:Class`.

    Attributes:
        source: The module's dotted name, or the path of a Python file.
        attribute: Name of the class in it.
    """

    source: str
    attribute: str

    @property
    def is_file(self) -> bool:
        """Whether `source` is the path of a Python file."""
        return self.source.endswith(".py")


def code_name(text: str) -> CodeName | None:
    """Return the parts of a name; None if it has neither the form `package.module:Class` nor `file.py:Class`."""
    source, _, attribute = text.rpartition(":")
    if not _CLASS.fullmatch(attribute) or not (source.endswith(".py") or _MODULE.fullmatch(source)):
        return None
    return CodeName(source, attribute)


@dataclass(frozen=True)
class Trust:
    """The code that the user trusts, in addition to the list in the user's configuration file.

    Attributes:
        named: Names given on the command line or by a program. Each is a class (`package.module:Class`,
            `file.py:Class`), a module or package with everything in it (`package.module`), a Python file (`file.py`),
            or a scenario's file, which trusts all code that it names.
        beside: The scenario's folder. Code in `named` is looked for there too; code that only a file names is not.
    """

    named: tuple[str, ...] = ()
    beside: Path | None = None

    def __post_init__(self) -> None:
        if not isinstance(self.named, tuple):
            raise TypeError(f"named is a tuple of texts, such as ('our_lab',), not {self.named!r}")

    def allows(self, code: CodeName, named_in: str) -> bool:
        """Return whether code may be imported.

        Args:
            code: The name of the code in `named_in`.
            named_in: Path of the file that names the code; relative paths start from its folder.

        Raises:
            ConfigurationError: The user's configuration file cannot be read.
        """
        if self.names(code, named_in) or any(_is_same_file(name, named_in) for name in self.named):
            return True
        file = self.file_of(code, named_in)
        return any(_covers(name, code, file) for name in _configured() if _is_whole(name))

    def names(self, code: CodeName, named_in: str) -> bool:
        """Return whether the user has named this class, its module, a package that contains it, or its Python file."""
        file = self.file_of(code, named_in)
        return any(_covers(name, code, file) for name in self.named)

    def file_of(self, code: CodeName, named_in: str) -> Path | None:
        """Return the absolute path of the Python file in a name; None for the name of a module.

        A relative path from the user starts from the current folder, or from the scenario's folder if there is no such
        file; any other path starts from the folder of the file that contains it. A path that leads to no file there
        means the trusted file of the same name: a plan may lie in another folder than the scenario that it comes from.
        """
        if not code.is_file:
            return None
        folders = [Path(named_in).parent]
        if any(name in (code.source, f"{code.source}:{code.attribute}") for name in self.named):
            folders = [Path(), *([] if self.beside is None else [self.beside]), *folders]
        paths = [_absolute(folder / code.source) for folder in folders]
        namesakes = [path for path in self._files() if path.name == paths[0].name]
        return next((path for path in (*paths, *namesakes) if is_file(path)), paths[0])

    def _files(self) -> list[Path]:
        """Return the absolute paths of the Python files that the user has named, also for a class in one."""
        sources = [name if (code := code_name(name)) is None else code.source for name in self.named]
        return [_absolute(Path(source)) for source in sources if source.endswith(".py")]


def _covers(name: str, code: CodeName, file: Path | None) -> bool:
    """Return whether a trusted name covers code: the class itself, its module or a package around it, its file."""
    if file is None:
        return name == f"{code.source}:{code.attribute}" or f"{code.source}.".startswith(f"{name}.")
    trusted = code_name(name)
    if trusted is not None and trusted.attribute != code.attribute:
        return False
    path = name if trusted is None else trusted.source
    return path.endswith(".py") and (path == code.source or _absolute(Path(path)) == file)


def _absolute(path: Path) -> Path:
    """Return the path from the root, with its links followed."""
    return path.resolve()


def _is_same_file(name: str, other: str) -> bool:
    try:
        return not name.endswith(".py") and Path(name).samefile(other)
    except (OSError, ValueError):
        return False


def _is_whole(name: str) -> bool:
    """Return whether a name means the same in every folder: a module's, or the absolute path of a Python file."""
    return ".py" not in name or Path(name).is_absolute()


def _configured() -> tuple[str, ...]:
    """Return the list `trust` of the user's configuration file; empty if the file does not exist."""
    path = configuration_file()
    try:
        text = read_file(path, MOST_CONFIGURATION_BYTES).decode()
    except (FileNotFoundError, NotADirectoryError):
        return ()
    except OSError as fault:
        raise ConfigurationError(f"{path}: cannot be read: {fault.strerror}") from None
    except UnicodeDecodeError:
        raise ConfigurationError(f"{path}: cannot be read: it is not text in UTF-8") from None
    names = _parsed(text, path).get("trust", [])
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
        raise ConfigurationError(f"{path}: `trust` must be a list of names in quotation marks")
    return tuple(str(Path(name).expanduser()) for name in names)


def _parsed(text: str, path: Path) -> dict[str, Any]:
    if sys.version_info >= (3, 11):
        import tomllib
    else:
        import tomli as tomllib
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as fault:
        raise ConfigurationError(f"{path}: it is not TOML: {fault}") from None
