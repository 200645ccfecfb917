"""Dataclasses that are frozen, take their fields by keyword, and cost little to define.

`dataclasses.dataclass` compiles up to seven methods for each class, which takes a tenth of a command. Here all classes
share theirs. In all else they are dataclasses: `fields`, `replace`, copies, pickles and checkers of types take them so.
"""

import dataclasses
import inspect
from collections.abc import Callable
from dataclasses import MISSING, Field, FrozenInstanceError
from typing import Any, NamedTuple, NoReturn, TypeVar, dataclass_transform

Kind = TypeVar("Kind", bound=type)


class _Fields(NamedTuple):
    """What the constructor of a class knows of its fields."""

    defaults: dict[str, Any]
    """Those of all fields in their order; MISSING where there is none."""
    factories: dict[str, Callable[[], Any]]
    required: frozenset[str]
    finished: bool
    """Whether ``__post_init__`` follows."""


@dataclass_transform(eq_default=False, kw_only_default=True, frozen_default=True, field_specifiers=(dataclasses.field,))
def frozen(kind: Kind) -> Kind:
    """Make a class a frozen dataclass, of which each object is equal to itself alone, as fits arrays."""
    return _made(kind, _METHODS)


@dataclass_transform(kw_only_default=True, frozen_default=True, field_specifiers=(dataclasses.field,))
def frozen_value(kind: Kind) -> Kind:
    """Make a class a frozen dataclass, of which objects with equal fields are equal and have the same hash."""
    return _made(kind, _METHODS | _COMPARISON)


def _made(kind: Any, methods: dict[str, Any]) -> Any:
    """Give a class its fields and the methods that it does not have itself."""
    own = {*vars(kind)}
    dataclasses.dataclass(init=False, repr=False, eq=False, kw_only=True)(kind)
    if kind.__repr__ is not object.__repr__:
        own.add("__repr__")  # of a base
    for name, method in methods.items():
        if name not in own:
            setattr(kind, name, method)
    items = dataclasses.fields(kind)
    factories = {item.name: item.default_factory for item in items if item.default_factory is not MISSING}
    defaults = {item.name: item.default for item in items}
    required = frozenset(name for name, value in defaults.items() if value is MISSING) - factories.keys()
    kind._fields_of_constructor = _Fields(defaults, factories, required, hasattr(kind, "__post_init__"))
    return kind


def _init(self: Any, /, **values: Any) -> None:
    """Set all fields in their order."""
    defaults, factories, required, finished = self._fields_of_constructor
    own = self.__dict__
    own.update(defaults)
    own.update(values)
    if len(own) != len(defaults) or not required <= values.keys():
        raise _wrong_fields(type(self), values)
    for name, factory in factories.items():
        if name not in values:
            own[name] = factory()
    if finished:
        self.__post_init__()


def _wrong_fields(kind: Any, values: dict[str, Any]) -> TypeError:
    """Name the fields that do not exist, else those that are missing."""
    defaults, _, required, _ = kind._fields_of_constructor
    unknown, missing = values.keys() - defaults, required - values.keys()
    what, names = ("an unexpected", unknown) if unknown else ("no", missing)
    shown = ", ".join(repr(name) for name in (*defaults, *values) if name in names)
    return TypeError(f"{kind.__qualname__}.__init__() got {what} keyword argument {shown}")


def _repr(self: Any) -> str:
    """Names and values of the fields."""
    shown = (f"{item.name}={getattr(self, item.name)!r}" for item in dataclasses.fields(self) if item.repr)
    return f"{type(self).__qualname__}({', '.join(shown)})"


def _refuse_change(self: object, name: str, *_: object) -> NoReturn:
    """Neither set nor delete an attribute."""
    raise FrozenInstanceError(f"{type(self).__qualname__} is frozen: '{name}' cannot change; see dataclasses.replace")


def _compared(self: Any) -> tuple[Any, ...]:
    """The values that equal objects have in common."""
    return tuple(getattr(self, item.name) for item in dataclasses.fields(self) if item.compare)


def _eq(self: Any, other: object) -> Any:
    """Whether all fields of two objects of one class are equal."""
    return _compared(self) == _compared(other) if type(self) is type(other) else NotImplemented


def _hash(self: Any) -> int:
    """The same for equal objects."""
    return hash(_compared(self))


class _SignatureOfFields:
    """The signature of the constructor of a class, made when somebody asks for it."""

    def __get__(self, instance: object, owner: Any) -> inspect.Signature:
        """Make it of the fields; `AttributeError` for an object, or where a class has another constructor."""
        if instance is not None or inspect.unwrap(owner.__init__) is not _init:
            raise AttributeError("__signature__")
        return inspect.Signature([*map(_parameter, dataclasses.fields(owner))], return_annotation=None)


def _parameter(item: "Field[Any]") -> inspect.Parameter:
    """A field as a parameter; a default that is made has no value to show."""
    default = inspect.Parameter.empty if item.default is MISSING else item.default
    if item.default_factory is not MISSING:
        default = ...
    return inspect.Parameter(item.name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=item.type)


_METHODS = {
    "__init__": _init,
    "__repr__": _repr,
    "__setattr__": _refuse_change,
    "__delattr__": _refuse_change,
    "__signature__": _SignatureOfFields(),
}
_COMPARISON = {"__eq__": _eq, "__hash__": _hash}
