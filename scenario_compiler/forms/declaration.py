"""The declaration of containers and their columns.

A container is a class with slots, which are columns: lists of float or of int.

    @container("st", 2, written=True)
    class State(Columns):
        speed: list[float] = column(ENTITY)
        "Speed of the entity, m/s."

From the line of a column follow its size in a state, its value at t = 0, its place in the compiled form, and the check
of what a program holds. Marked functions take the container as the argument `st`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, TypeVar

Container = TypeVar("Container")
"""A class, or an object, whose slots are columns: lists of float or of int, or arrays of them."""


@dataclass(frozen=True)
class ContainerDeclaration:
    """What marked functions take as an argument of one name.

    Attributes:
        columns: The class of the container.
        place: Where it stands among the arguments that are containers.
        written: Whether marked functions may write all its columns; else those alone that are declared as written.
    """

    columns: type[Any]
    place: int
    written: bool

    def may_write(self, column: str) -> bool:
        """Return whether marked functions may write a column."""
        return self.written or columns_of(self.columns)[column].written


CONTAINERS: dict[str, ContainerDeclaration] = {}
"""The containers that are declared in what has been imported, by the name of the argument that takes them."""

_COLUMNS: dict[type[Any], Mapping[str, ColumnDeclaration]] = {}
_TYPES: dict[type[Any], Mapping[str, bool]] = {}
"""What `column_types` has found: the interpreted form asks it for every column of every run."""

_OF_NO_SLOTS = ("__dict__", "__weakref__")
"""What a class has by itself where its instances have no slots."""


def container(argument: str, place: int, *, written: bool = False) -> Callable[[type[Container]], type[Container]]:
    """Declare a subclass of `Columns` as what marked functions take as `argument`; see `ContainerDeclaration`."""

    def declare(declared: type[Container]) -> type[Container]:
        names = tuple(declared.__annotations__)
        plain = {name: value for name, value in vars(declared).items() if name not in (*names, *_OF_NO_SLOTS)}
        columns: type[Container] = type(declared.__name__, declared.__bases__, {**plain, "__slots__": names})
        _COLUMNS[columns] = MappingProxyType({name: vars(declared)[name] for name in names})
        CONTAINERS[argument] = ContainerDeclaration(columns, place, written)
        return columns

    return declare


def containers_in_order() -> list[str]:
    """Return the arguments of the declared containers in the order in which functions take them."""
    return sorted(CONTAINERS, key=lambda argument: CONTAINERS[argument].place)


@dataclass(frozen=True)
class Of:
    """What a column has an element for.

    Attributes:
        name: Its name, in the singular.
        count: How many there are in a program.
        fixed: How many there are in every program; 0 where that depends on the program.
    """

    name: str
    count: Callable[[Any], int]
    fixed: int = 0


def fixed(name: str, count: int) -> Of:
    """Return what there is the same number of in every program."""
    return Of(name, lambda _: count, count)


@dataclass(frozen=True)
class Allowed:
    """What the whole numbers of a column may be.

    Attributes:
        of: What they count, from 0 on; None for numbers.
        least: The least of them.
        limit: What they stay below, where they count nothing.
    """

    of: Of | None = None
    least: int = 0
    limit: int = 1 << 62

    def limit_in(self, program: object) -> int:
        """Return what they stay below in a program."""
        return self.limit if self.of is None else self.of.count(program)


ANY = Allowed(least=-(1 << 62))
"""Whole numbers without limits."""

FLAG = Allowed(limit=2)
"""1 for yes, 0 for no."""


def codes(count: int, *, least: int = 0) -> Allowed:
    """Return the values of a column of codes, of which there are `count`."""
    return Allowed(least=least, limit=count)


def whole(least: int, limit: int = 1 << 30) -> Allowed:
    """Return the values of a column of whole numbers from `least` to below `limit`."""
    return Allowed(least=least, limit=limit)


def index(of: Of) -> Allowed:
    """Return the values of a column that refers to elements."""
    return Allowed(of)


def index_or_none(of: Of, *, least: int = -1) -> Allowed:
    """Return the values of a column that refers to elements, or to none, which is -1."""
    return Allowed(of, least)


@dataclass(frozen=True)
class ColumnDeclaration:
    """The declaration of a column.

    Attributes:
        of: What it has an element for.
        start: What each element is at t = 0, and in an empty program.
        values: What its whole numbers may be.
        starts: What it gives the row starts of: the members of k are from element k to below element k + 1.
        kept: Whether it keeps its values when a run begins: what is put in before.
        written: Whether marked functions may write it where they may not write the whole container.
    """

    of: Of
    start: float = 0
    values: Allowed = ANY
    starts: Of | None = None
    kept: bool = False
    written: bool = False

    def empty(self) -> list[float]:
        """Return the column as it is in a program that has nothing."""
        return [self.start] * (1 if self.starts is not None else self.of.fixed)


RUN = fixed("run", 1)
"""What columns of a single element are of."""


def column(of: Of, start: float = 0, values: Allowed = ANY, *, kept: bool = False, written: bool = False) -> Any:
    """Declare a column."""
    return ColumnDeclaration(of, start, values, kept=kept, written=written)


def row_starts(of: Of, members: Of, *, written: bool = False) -> Any:
    """Declare a column of row starts: one more element than there are owners."""
    return ColumnDeclaration(of, values=Allowed(least=0), starts=members, written=written)


class Columns:
    """What every container is: columns that are made from arguments of their names, or as they are declared.

    The methods of a dataclass with hundreds of fields would take longer to make than most programs run.
    """

    __slots__ = ()

    def __init__(self, **columns: Any) -> None:
        """Take the columns by name; one that is left out is as long as it is in every program, else empty."""
        for name, declared in columns_of(type(self)).items():
            setattr(self, name, columns.pop(name) if name in columns else declared.empty())
        if columns:
            raise TypeError(f"{type(self).__name__} has no column {', '.join(columns)}")


def columns_of(container: type[Any]) -> Mapping[str, ColumnDeclaration]:
    """Return the declarations of a container's columns by name, in order."""
    return _COLUMNS[container]


def column_types(container: type[Any]) -> Mapping[str, bool]:
    """Return for each column, in the order of the slots, whether it holds floats."""
    if container not in _TYPES:
        _TYPES[container] = MappingProxyType(
            {name: "float" in str(container.__annotations__[name]) for name in columns_of(container)}
        )
    return _TYPES[container]


def start_of(container: type[Any], name: str) -> float | int:
    """Return what each element of a column is at t = 0, of the column's type."""
    start = columns_of(container)[name].start
    return float(start) if column_types(container)[name] else int(start)


def at_start(container: type[Container], program: object) -> Container:
    """Return a container of the right sizes for a program, every column at its declared start."""
    sizes = {name: declared.of.count(program) for name, declared in columns_of(container).items()}
    return container(**{name: [start_of(container, name)] * size for name, size in sizes.items()})


def put_to_start(container: Any) -> None:
    """Put every column of a container to its declared start, but those that are kept.

    Marked functions may call it with a container of which they may write all columns.
    """
    for name, declared in columns_of(type(container)).items():
        if not declared.kept:
            values = getattr(container, name)
            values[:] = [start_of(type(container), name)] * len(values)


def write_first(container: Any, names: tuple[str, ...], out: list[float], base: int) -> None:
    """Write the first elements of some columns of a container into `out`, from `base` on.

    Marked functions may call it with names that stand in a tuple of their module.
    """
    for place, name in enumerate(names):
        out[base + place] = float(getattr(container, name)[0])


def check_columns(program: Any) -> None:
    """Check every size, index, code and row start of a program against its declaration.

    Raises:
        ValueError: A column refers outside another one; a fault of the code that filled it.
    """
    types = column_types(type(program))
    for name, declared in columns_of(type(program)).items():
        values = getattr(program, name)
        kind = float if types[name] else int
        if any(type(value) is not kind for value in values):
            raise ValueError(f"column {name} holds something else than {kind.__name__}")
        count = declared.of.count(program) + (1 if declared.starts is not None else 0)
        if len(values) != count:
            raise ValueError(f"column {name} has {len(values)} values, not {count}")
        if declared.starts is not None:
            _check_starts(name, values, declared.starts.count(program))
        elif kind is int:
            check_values(name, values, declared.values, program)


def check_values(name: str, values: list[int], allowed: Allowed, program: object) -> None:
    """Check the values of a column, or some of them; ValueError where one is not allowed."""
    least, limit = allowed.least, allowed.limit_in(program)
    for value in values:
        if not least <= value < limit:
            raise ValueError(f"column {name} holds {value}, outside {least} .. {limit - 1}")


def _check_starts(name: str, starts: list[int], total: int) -> None:
    if starts[0] != 0 or starts[-1] != total or sorted(starts) != starts:
        raise ValueError(f"row starts {name} do not divide {total} members")
