"""Finds schemas, the library, templates and maps, in a checkout and in an installed wheel; no other module does."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cache
from pathlib import Path, PureWindowsPath
from typing import NamedTuple

from scenario_compiler.diagnostics import did_you_mean
from scenario_compiler.files import suffix_of

_PACKAGE = Path(__file__).parent
_CHECKOUT = _PACKAGE.parent


def _root() -> Path:
    """Return the folder that holds schemas, library and maps: the checkout, or the wheel's data folder."""
    installed = _PACKAGE / "_data"
    return installed if installed.is_dir() else _CHECKOUT


def schema_file(name: str) -> Path:
    """Return the path of a file in schemas/."""
    return _root() / "schemas" / name


NAME = re.compile("[A-Za-z_][A-Za-z0-9_]*")
"""A bare name of a conflict: it has no folder and no suffix."""


def library_folder() -> Path:
    """Return the folder with conflicts, templates and catalogs."""
    return _root() / "library"


@cache
def library_conflicts() -> dict[str, Path]:
    """Return the files of the library's conflicts, by name, without reading more of them than the names."""
    files = sorted((library_folder() / "conflicts").glob("*.xml"))
    return {name: file for file in files for name in re.findall(r'<scenario name="(\w+)"', file.read_text("utf-8"))}


class ConflictNotFoundError(FileNotFoundError):
    """There is neither a file nor a conflict of the library of this name; `hint` has a similar name, or is empty."""

    def __init__(self, name: str) -> None:
        """Keep the name."""
        super().__init__(f"there is no file and no conflict of the library called '{name}'")
        self.hint = did_you_mean(name, library_conflicts())


def library_target(target: str | Path) -> str | Path:
    """Return FILE#name for the bare name of a conflict of the library; any other target is returned unchanged.

    A file of that name in the current folder comes first.

    Raises:
        ConflictNotFoundError: The target is a bare name, but there is neither a file nor a conflict of this name.
    """
    name = str(target)
    if not NAME.fullmatch(name) or Path(name).is_file():
        return target
    file = library_conflicts().get(name)
    if file is None:
        raise ConflictNotFoundError(name)
    return f"{file}#{name}"


TEMPLATE_PACKAGES = "scenario_compiler_templates"
"""Group of entry points through which installed packages provide templates: each value is a folder, a.b for a/b."""

_TEMPLATES: ContextVar[tuple[Path, ...]] = ContextVar("templates", default=())


@contextmanager
def templates_from(folders: Sequence[Path]) -> Iterator[None]:
    """Look for templates in these folders first while the context is open, as with --templates."""
    token = _TEMPLATES.set(tuple(folders))
    try:
        yield
    finally:
        _TEMPLATES.reset(token)


def templates_given() -> tuple[Path, ...]:
    """Return the present folders of `templates_from`, so that another process can use the same ones."""
    return _TEMPLATES.get()


def template_folders() -> Iterator[Path]:
    """Yield the folders of templates, in the order in which a name is looked up.

    Those given by `templates_from`, those of $SCENARIO_COMPILER_TEMPLATES, the library's, then those of installed
    packages by name. Installing a package therefore does not change scenarios that could be read before.
    """
    yield from _TEMPLATES.get()
    yield from (Path(one) for one in os.environ.get("SCENARIO_COMPILER_TEMPLATES", "").split(os.pathsep) if one)
    yield library_folder() / "templates"
    yield from _package_folders()


@cache
def _package_folders() -> tuple[Path, ...]:
    """Return the folders of templates of installed packages, without importing any of them.

    A package that is not installed, or whose entry point is not a folder, is skipped: the user cannot correct that.
    """
    from importlib.metadata import entry_points
    from importlib.util import find_spec

    found = []
    for entry in sorted(entry_points(group=TEMPLATE_PACKAGES), key=lambda one: (one.name, one.value)):
        top, *inner = entry.value.split(".")
        try:
            spec = find_spec(top) if all(part.isidentifier() for part in (top, *inner)) else None
        except (ImportError, ValueError):
            spec = None
        places = [] if spec is None else list(spec.submodule_search_locations or ())
        found += [folder for folder in (Path(place, *inner) for place in places) if folder.is_dir()]
    return tuple(found)


def maps_folder() -> Path:
    """Return the folder with the packaged maps."""
    return _root() / "maps"


def cache_folder() -> Path:
    """Return the folder for caches: $SCENARIO_COMPILER_CACHE, or the user's cache folder."""
    named = os.environ.get("SCENARIO_COMPILER_CACHE")
    if named:
        return Path(named)
    base = os.environ.get("XDG_CACHE_HOME")
    return (Path(base) if base else Path.home() / ".cache") / "scenario-compiler"


def configuration_file() -> Path:
    """Return the path of the user's configuration file, which need not exist.

    It is `scenario-compiler/config.toml` in $XDG_CONFIG_HOME, on Windows in %APPDATA%, else in `~/.config`. A relative
    folder in a variable is ignored, as the XDG Base Directory Specification requires, because it would depend on the
    current folder.
    """
    named = Path(os.environ.get("XDG_CONFIG_HOME") or os.environ.get("APPDATA") or "")
    folder = named if named.is_absolute() else Path("~/.config").expanduser()
    return folder / "scenario-compiler" / "config.toml"


class MapSearch(NamedTuple):
    """The search path for maps.

    Attributes:
        beside: Folder of the file that names the map; None for a map named by a program.
        folders: Folders given on the command line, in order.
    """

    beside: Path | None = None
    folders: tuple[Path, ...] = ()

    def places(self) -> list[Path]:
        """Return the folders of the search path, in order."""
        found = list(self.folders)
        found.extend(Path(p) for p in os.environ.get("SCENARIO_COMPILER_MAPS", "").split(os.pathsep) if p)
        carla = os.environ.get("CARLA_ROOT")
        if carla:
            found.append(Path(carla) / "CarlaUE4" / "Content" / "Carla" / "Maps" / "OpenDrive")
        found.append(maps_folder())
        return found


PUBLISHED_AS = {"conflictmap": "HRI_custommap"}
"""Names of maps in scenario files with the names of the published files: the AISA toolkit's own map."""


def portable(path: str) -> str:
    """Return a path that every system accepts: the backslashes of Windows become slashes."""
    return PureWindowsPath(path).as_posix() if "\\" in path else path


class MapNotFoundError(FileNotFoundError):
    """There is no map of this name on the search path; `looked` lists the files that were tried."""

    def __init__(self, name: str, looked: Sequence[Path]) -> None:
        """Keep the name and the files that were tried."""
        super().__init__(f"there is no map '{name}'")
        self.name = name
        self.looked = tuple(looked)


def find_map(name: str, *, beside: Path | None = None, folders: Sequence[Path] = ()) -> Path:
    """Return the OpenDRIVE file of a map, given its path or its name.

    A relative path is tried in the folder of the file that names it, first whole and then as its bare name; then on the
    search path: `folders`, $SCENARIO_COMPILER_MAPS, $CARLA_ROOT/CarlaUE4/Content/Carla/Maps/OpenDrive, the packaged
    maps; then the same with the name of the published file. Names are case-sensitive on every system and ".xodr" may be
    left out.

    Raises:
        MapNotFoundError: There is no such file; the error lists the places.
    """
    search = MapSearch(beside, tuple(folders))
    looked: list[Path] = []
    published = PUBLISHED_AS.get(name)
    for candidate in [*_candidates(name, search), *([] if published is None else _candidates(published, search))]:
        looked.append(candidate)
        if _is_exact_file(candidate):
            return candidate
    raise MapNotFoundError(name, looked)


def known_maps(folders: Sequence[Path] = ()) -> list[str]:
    """Return the names of all maps on the search path, sorted, for hints."""
    names: set[str] = set()
    for folder in MapSearch(None, tuple(folders)).places():
        if folder.is_dir():
            files = [*folder.glob("*"), *folder.glob("*/*")]
            names.update(path.stem for path in files if suffix_of(path) == ".xodr")
    return sorted(names)


def _candidates(name: str, search: MapSearch) -> list[Path]:
    file = Path(name if suffix_of(name) == ".xodr" else f"{name}.xodr")
    if file.is_absolute():
        return [file]
    found: list[Path] = []
    for folder in [search.beside or Path(), *search.places()]:
        found += [folder / file, folder / file.name, folder / file.stem / file.name]
    return list(dict.fromkeys(found))


def _is_exact_file(path: Path) -> bool:
    """Return whether the file exists with exactly this name, on case-insensitive systems too."""
    try:
        return path.is_file() and any(path.name == one.name for one in path.parent.iterdir())
    except (OSError, ValueError):
        return False
