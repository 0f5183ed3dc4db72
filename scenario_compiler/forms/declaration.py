"""The declaration of containers and their columns.

A container is a class with slots, which are columns: lists of float or of int.

    @container("st", 2, written=True)
    class State(Columns):
        speed: list[float] = column(ENTITY)
        "Speed of the entity, m/s."

A column's declaration gives its size in a state, its value at t = 0, its place in the compiled form, and the check of
its values in a program. Marked functions take this container as the argument `st`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, NamedTuple, TypeVar

Container = TypeVar("Container")
"""A class or an object whose slots are columns: lists of float or of int, or arrays of them."""


class ContainerDeclaration(NamedTuple):
    """The declaration of a container.

    Attributes:
        columns: The class of the container.
        place: Its position among a function's arguments that are containers.
        written: Whether marked functions may write all its columns; otherwise they may write those with their own flag.
    """

    columns: type[Any]
    place: int
    written: bool

    def may_write(self, column: str) -> bool:
        """Return whether marked functions may write a column."""
        return self.written or columns_of(self.columns)[column].written


CONTAINERS: dict[str, ContainerDeclaration] = {}
"""The containers declared in the modules imported so far, by argument name."""

_COLUMNS: dict[type[Any], Mapping[str, ColumnDeclaration]] = {}
_TYPES: dict[type[Any], Mapping[str, bool]] = {}
"""Cache of `column_types`, which the interpreted form calls for every column of every run."""

_OF_NO_SLOTS = ("__dict__", "__weakref__")
"""Attributes of every class whose instances have no slots."""


def container(argument: str, place: int, *, written: bool = False) -> Callable[[type[Container]], type[Container]]:
    """Declare a subclass of `Columns` as the container that marked functions take as `argument`.

    Args:
        argument: The argument's name.
        place: Its position among a function's arguments that are containers.
        written: Whether marked functions may write all its columns.
    """

    def declare(declared: type[Container]) -> type[Container]:
        names = tuple(declared.__annotations__)
        replaced = {*names, *_OF_NO_SLOTS}
        plain = {name: value for name, value in vars(declared).items() if name not in replaced}
        columns: type[Container] = type(declared.__name__, declared.__bases__, {**plain, "__slots__": names})
        _COLUMNS[columns] = MappingProxyType({name: vars(declared)[name] for name in names})
        CONTAINERS[argument] = ContainerDeclaration(columns, place, written)
        return columns

    return declare


def containers_in_order() -> list[str]:
    """Return the argument names of the declared containers in the order in which functions take them."""
    return sorted(CONTAINERS, key=lambda argument: CONTAINERS[argument].place)


@dataclass(frozen=True)
class Of:
    """The kind of thing for which a column has one element each.

    Attributes:
        name: Its name, singular.
        count: Returns how many of them a program has.
        fixed: How many of them every program has; 0 if the number depends on the program.
    """

    name: str
    count: Callable[[Any], int]
    fixed: int = 0


def fixed(name: str, count: int) -> Of:
    """Return a kind of thing of which every program has the same number."""
    return Of(name, lambda _: count, count)


class Allowed(NamedTuple):
    """The allowed values of a column of whole numbers.

    Attributes:
        of: The things to which the values are indices; None for other numbers.
        least: The least allowed value.
        limit: The value below which all values are; only used if `of` is None.
    """

    of: Of | None = None
    least: int = 0
    limit: int = 1 << 62

    def limit_in(self, program: object) -> int:
        """Return the value below which all values are in a program."""
        return self.limit if self.of is None else self.of.count(program)


ANY = Allowed(least=-(1 << 62))
"""All whole numbers."""

FLAG = Allowed(limit=2)
"""1 for yes, 0 for no."""


def codes(count: int, *, least: int = 0) -> Allowed:
    """Return the allowed values of a column of codes, of which there are `count` from 0 on."""
    return Allowed(least=least, limit=count)


def whole(least: int, limit: int = 1 << 30) -> Allowed:
    """Return the allowed values of a column of whole numbers from `least` to below `limit`."""
    return Allowed(least=least, limit=limit)


def index(of: Of) -> Allowed:
    """Return the allowed values of a column of indices."""
    return Allowed(of)


def index_or_none(of: Of) -> Allowed:
    """Return the allowed values of a column of indices in which -1 means none."""
    return Allowed(of, least=-1)


class ColumnDeclaration(NamedTuple):
    """The declaration of a column.

    Attributes:
        of: The things for which it has one element each.
        start: The value of each element at t = 0.
        values: The allowed values of a column of whole numbers.
        starts: For a column of row starts, the members: those of owner k are from element k to below element k + 1.
        kept: Whether its values stay when a run begins, because they are input.
        written: Whether marked functions may write it even if they may not write the whole container.
    """

    of: Of
    start: float = 0
    values: Allowed = ANY
    starts: Of | None = None
    kept: bool = False
    written: bool = False

    def empty(self) -> list[float]:
        """Return the column of an empty program."""
        return [self.start] * (1 if self.starts is not None else self.of.fixed)


RUN = fixed("run", 1)
"""The run itself, for columns with a single element."""


def column(of: Of, start: float = 0, values: Allowed = ANY, *, kept: bool = False, written: bool = False) -> Any:
    """Declare a column; see `ColumnDeclaration`."""
    return ColumnDeclaration(of, start, values, kept=kept, written=written)


def row_starts(of: Of, members: Of, *, written: bool = False) -> Any:
    """Declare a column of row starts, which has one element more than there are owners."""
    return ColumnDeclaration(of, values=Allowed(least=0), starts=members, written=written)


class Columns:
    """The base class of containers.

    The generated methods of a dataclass with hundreds of fields would take longer to create than most programs run.
    """

    __slots__ = ()

    def __init__(self, **columns: Any) -> None:
        """Set the columns by name; a column that is left out is as in an empty program."""
        for name, declared in columns_of(type(self)).items():
            setattr(self, name, columns.pop(name) if name in columns else declared.empty())
        if columns:
            raise TypeError(f"{type(self).__name__} has no column {', '.join(columns)}")


def columns_of(container: type[Any]) -> Mapping[str, ColumnDeclaration]:
    """Return the declarations of a container's columns by name, in order."""
    return _COLUMNS[container]


def column_types(container: type[Any]) -> Mapping[str, bool]:
    """Return for each column by name, in the order of the slots, whether its values are floats."""
    if container not in _TYPES:
        _TYPES[container] = MappingProxyType(
            {name: "float" in str(container.__annotations__[name]) for name in columns_of(container)}
        )
    return _TYPES[container]


def start_of(container: type[Any], name: str) -> float | int:
    """Return the value of each element of a column at t = 0, as an int or a float as the column's."""
    start = columns_of(container)[name].start
    return float(start) if column_types(container)[name] else int(start)


def at_start(container: type[Container], program: object) -> Container:
    """Return a container with the sizes for a program and every column at its declared start."""
    sizes = {name: declared.of.count(program) for name, declared in columns_of(container).items()}
    return container(**{name: [start_of(container, name)] * size for name, size in sizes.items()})


def put_to_start(container: Any) -> None:
    """Set every column of a container to its declared start, except those with `kept`.

    Marked functions may call it with a container all of whose columns they may write.
    """
    for name, declared in columns_of(type(container)).items():
        if not declared.kept:
            values = getattr(container, name)
            values[:] = [start_of(type(container), name)] * len(values)


def write_first(container: Any, names: tuple[str, ...], out: list[float], base: int) -> None:
    """Write the first element of each named column of a container to `out`, from index `base` on.

    Marked functions may call it with names in a tuple of their module.
    """
    for place, name in enumerate(names):
        out[base + place] = float(getattr(container, name)[0])


def check_columns(program: Any) -> None:
    """Check every size, index, code and row start of a program against its declaration.

    Raises:
        ValueError: A column has another type or size, or a value that is not allowed; the code that filled it is wrong.
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
    """Check that the values, all or some of a column's, are allowed; ValueError if one is not."""
    least, limit = allowed.least, allowed.limit_in(program)
    for value in values:
        if not least <= value < limit:
            raise ValueError(f"column {name} holds {value}, outside {least} .. {limit - 1}")


def _check_starts(name: str, starts: list[int], total: int) -> None:
    if starts[0] != 0 or starts[-1] != total or sorted(starts) != starts:
        raise ValueError(f"row starts {name} do not divide {total} members")
