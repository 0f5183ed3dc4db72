"""Records: frozen values with declared fields, such as the words of the languages, plans, headers and outcomes.

A class costs little to create: its annotations are resolved when its fields are first used. Values that a program gives
to the constructor, or that a JSON file contains, are checked by pydantic. It is imported, and builds the validator of a
class, when the first value of the class is checked. Whoever has checked the values already, as the readers have, uses
`model_construct`; `vars` of a record are its JSON. Commands that read scenarios and run them therefore do without it.

The methods have the names that pydantic's models have.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from functools import cache
from inspect import get_annotations
from types import new_class
from typing import Any, ClassVar, get_origin

if sys.version_info >= (3, 11):
    from typing import Self, dataclass_transform
else:
    from typing_extensions import Self, dataclass_transform

REQUIRED: Any = ...
"""The default of a field without a default."""


class Field:
    """The declaration of a field of a record.

    Attributes:
        annotation: Its type; None until the fields of its class are first used.
        default: Its default value; `REQUIRED` if it has none, or a factory.
        default_factory: Makes a default value for each record; None if there is a default, or if it is required.
        description: What it means, with its unit.
        limits: Limits that pydantic checks, by pydantic's names: `ge`, `gt`, `le`.
        json_schema_extra: Additions to its JSON schema.
        metadata: What packages above declare about it, such as its spelling in XML.
    """

    __slots__ = ("annotation", "default", "default_factory", "description", "json_schema_extra", "limits", "metadata")

    def __init__(
        self,
        default: Any = REQUIRED,
        *,
        default_factory: Callable[[], Any] | None = None,
        description: str = "",
        limits: Mapping[str, float] | None = None,
        json_schema_extra: dict[str, Any] | None = None,
        metadata: tuple[object, ...] = (),
        annotation: Any = None,
    ) -> None:
        """Declare a field; the arguments are the attributes."""
        self.annotation = annotation
        self.default = default
        self.default_factory = default_factory
        self.description = description
        self.limits = limits or {}
        self.json_schema_extra = json_schema_extra
        self.metadata = metadata

    def is_required(self) -> bool:
        """Return whether a value must be given."""
        return self.default is REQUIRED and self.default_factory is None

    def get_default(self) -> Any:
        """Return the default value, which no other record shares if it can be changed."""
        if self.default_factory is not None:
            return self.default_factory()
        return dict(self.default) if isinstance(self.default, dict) else self.default

    @property
    def settings(self) -> dict[str, Any]:
        """The arguments with which pydantic declares such a field."""
        default = {"default": self.default, "default_factory": self.default_factory}
        del default["default" if self.default_factory else "default_factory"]
        extra = self.json_schema_extra
        return {**default, "description": self.description or None, "json_schema_extra": extra, **self.limits}

    def of_type(self, annotation: Any) -> Field:
        """Return the declaration with its type."""
        return Field(
            self.default,
            default_factory=self.default_factory,
            description=self.description,
            limits=self.limits,
            json_schema_extra=self.json_schema_extra,
            metadata=self.metadata,
            annotation=annotation,
        )


def field(
    *,
    default: Any = REQUIRED,
    default_factory: Callable[[], Any] | None = None,
    description: str = "",
    json_schema_extra: dict[str, Any] | None = None,
    **limits: float,
) -> Any:
    """Declare a field of a record; the limits are pydantic's `ge`, `gt` and `le`."""
    return Field(
        default,
        default_factory=default_factory,
        description=description,
        limits=limits,
        json_schema_extra=json_schema_extra,
    )


@dataclass_transform(kw_only_default=True, field_specifiers=(field,))
class RecordClass(type):
    """The class of the classes of records.

    A class has no attributes for its declared fields, so that a record without a value has none either, and Python
    finds the values of records at once.
    """

    _declared: dict[str, Field]
    """The fields that the class itself declares with `field` or the like, by name."""

    def __new__(cls, name: str, bases: tuple[type, ...], contents: dict[str, Any]) -> RecordClass:
        """Make a class from its name, its base classes and the contents of its body."""
        declared = {name: one for name, one in contents.items() if isinstance(one, Field)}
        made = super().__new__(cls, name, bases, {name: contents[name] for name in contents if name not in declared})
        made._declared = declared
        return made

    @property
    def model_fields(cls) -> Mapping[str, Field]:
        """The fields by name, those of base classes first."""
        return _fields_of(cls)


@cache
def _fields_of(owner: RecordClass) -> Mapping[str, Field]:
    found: dict[str, Field] = {}
    for base in reversed(owner.__bases__):
        if isinstance(base, RecordClass):
            found.update(_fields_of(base))
    for name, annotation in get_annotations(owner, eval_str=True).items():
        origin: Any = get_origin(annotation)
        if origin is not ClassVar:
            declared = owner._declared.get(name) or Field(vars(owner).get(name, REQUIRED))
            found[name] = declared.of_type(annotation)
    return found


class Record(metaclass=RecordClass):
    """A frozen value with the fields that its class declares.

    A record has its values as `vars`, in the order of the fields.
    """

    __slots__ = ("__dict__", "__pydantic_extra__", "__pydantic_fields_set__", "__pydantic_private__")

    model_config: ClassVar[dict[str, Any]] = {
        "extra": "forbid",
        "allow_inf_nan": False,
        "arbitrary_types_allowed": True,
        "defer_build": True,
    }
    """Pydantic's settings: what else it refuses or allows, and that it builds a validator when it is first used."""

    __pydantic_root_model__: ClassVar[bool] = False
    """Pydantic asks for it when it makes a JSON schema."""

    def __init__(self, **values: Any) -> None:
        """Check the values; raise pydantic.ValidationError if one is missing or wrong."""
        _twin(type(self)).__pydantic_validator__.validate_python(values, self_instance=self)

    @classmethod
    def model_construct(cls, **values: Any) -> Self:
        """Return a record of values that are checked already; fields that are left out have their defaults."""
        content = {}
        for name, one in _fields_of(cls).items():
            if name in values:
                content[name] = values[name]
            elif not one.is_required():
                content[name] = one.get_default()
        return cls._made(content, set(values))

    @classmethod
    def _made(cls, content: dict[str, Any], given: set[str]) -> Self:
        made = cls.__new__(cls)
        object.__setattr__(made, "__dict__", content)
        object.__setattr__(made, "__pydantic_fields_set__", given)
        return made

    def model_copy(self, *, update: Mapping[str, Any] | None = None) -> Self:
        """Return a copy with other values of some fields, which are not checked; TypeError for another name."""
        changes = update or {}
        if not changes.keys() <= (known := _fields_of(type(self))).keys():
            unknown = next(name for name in changes if name not in known)
            raise TypeError(f"{type(self).__name__} has no field '{unknown}'")
        return self._made({**vars(self), **changes}, self.model_fields_set.union(changes))

    @property
    def model_fields_set(self) -> set[str]:
        """The fields whose values were given, even if they are the defaults."""
        given: set[str] = self.__pydantic_fields_set__  # type: ignore[attr-defined]  # a slot
        return given

    @classmethod
    def model_validate(cls, values: Any) -> Self:
        """Return the record of a mapping, or the record itself; raise pydantic.ValidationError for anything else."""
        made: Self = _twin(cls).__pydantic_validator__.validate_python(values)
        return made

    @classmethod
    def model_validate_json(cls, text: str | bytes) -> Self:
        """Return the record of a JSON text; raise pydantic.ValidationError if it is not one."""
        made: Self = _twin(cls).__pydantic_validator__.validate_json(text)
        return made

    def model_dump(self, **settings: Any) -> dict[str, Any]:
        """Return the values as a dict, also those of the records inside; the settings are pydantic's."""
        values: dict[str, Any] = _twin(type(self)).__pydantic_serializer__.to_python(self, **settings)
        return values

    def model_dump_json(self, **settings: Any) -> str:
        """Return the values as JSON; the settings are pydantic's."""
        text: bytes = _twin(type(self)).__pydantic_serializer__.to_json(self, **settings)
        return text.decode()

    @classmethod
    def model_json_schema(cls, **settings: Any) -> dict[str, Any]:
        """Return the JSON schema of the record; the settings are pydantic's."""
        schema: dict[str, Any] = _twin(cls).model_json_schema(**settings)
        return schema

    @classmethod
    def __get_pydantic_core_schema__(cls, source: object, handler: Any) -> Any:
        """Return pydantic's schema of the record, for models and records that contain it."""
        return handler.generate_schema(_twin(cls))

    def __eq__(self, other: object) -> bool:
        return type(self) is type(other) and vars(self) == vars(other)

    def __hash__(self) -> int:
        return hash(tuple(vars(self).values()))

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(f'{name}={value!r}' for name, value in vars(self).items())})"

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"{type(self).__name__} is frozen: make another one with model_copy")

    def __delattr__(self, name: str) -> None:
        raise AttributeError(f"{type(self).__name__} is frozen: make another one with model_copy")

    def __setstate__(self, state: tuple[dict[str, Any], dict[str, Any]]) -> None:
        """Take the values and the slots of a record that was copied or came from another process."""
        content, slots = state
        for name, value in {"__dict__": content, **slots}.items():
            object.__setattr__(self, name, value)


@cache
def _twin(record: type[Record]) -> Any:
    """Return a pydantic model with the fields of a record class, whose validator makes records of the class.

    The validator is built when it is first used.
    """
    from pydantic import BaseModel
    from pydantic import Field as PydanticField

    def of_records(_twin: type[BaseModel], source: Any, handler: Any) -> Any:
        schema = handler(source)
        handler.resolve_ref_schema(schema)["cls"] = record
        return schema

    fields = _fields_of(record)
    namespace = {
        "__module__": record.__module__,
        "__qualname__": record.__qualname__,
        "__doc__": record.__doc__,
        "__annotations__": {name: one.annotation for name, one in fields.items()},
        "__get_pydantic_core_schema__": classmethod(of_records),
        "model_config": record.model_config,
        **{name: PydanticField(**one.settings) for name, one in fields.items()},
    }
    return new_class(record.__name__, (BaseModel,), exec_body=lambda contents: contents.update(namespace))
