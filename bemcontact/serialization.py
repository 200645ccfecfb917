"""JSON of results and its JSON Schema, both from the fields of the results and the docstrings below these; CSV.

In all of them [L] is the unit of length and [p] that of pressure, force over length squared, in the user's units; a
number without either has no unit.
"""

import csv
import io
import json
from abc import ABC, abstractmethod
from collections.abc import Iterable
from functools import cache
from typing import Annotated, Any, TypeVar

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, PlainSerializer, TypeAdapter

from bemcontact.checks.attributes import WithHints
from bemcontact.checks.described_schema import DescribedSchema, with_descriptions
from bemcontact.checks.docstrings import docstring
from bemcontact.errors import escaped_json

DIALECT = "https://json-schema.org/draft/2020-12/schema"
CONFIG = ConfigDict(
    extra="forbid",
    frozen=True,
    arbitrary_types_allowed=True,
    defer_build=True,
    json_schema_serialization_defaults_required=True,
    ser_json_inf_nan="constants",
)

Item = TypeVar("Item")
Internal = Annotated[Item, Field(exclude=True)]
"""Marks a field of a result that JSON leaves out."""
Pair = tuple[float, float]
"""A point or a vector (x, y), or two numbers from where to where."""


_ListOfTwo = Annotated[list[float], Field(min_length=2, max_length=2)]


def _listed(array: NDArray[Any]) -> list[Any]:
    return array.tolist()


def _with_gaps(array: NDArray[Any]) -> list[Any]:
    return [None if np.isnan(value) else value for value in array.tolist()]


Vector = Annotated[NDArray[np.float64], PlainSerializer(_listed, return_type=list[float])]
"""An array (n,) that is a list of numbers in JSON."""
Gappy = Annotated[NDArray[np.float64], PlainSerializer(_with_gaps, return_type=list[float | None])]
"""An array (n,) that is a list of numbers in JSON, null where it is not a number."""
Pairs = Annotated[NDArray[np.float64], PlainSerializer(_listed, return_type=list[_ListOfTwo])]
"""An array (n, 2) that is a list of pairs in JSON."""
Matrix = Annotated[NDArray[np.float64], PlainSerializer(_listed, return_type=list[list[float]])]
"""An array (m, n) that is a list of lists of numbers in JSON."""
PairTables = Annotated[NDArray[np.float64], PlainSerializer(_listed, return_type=list[list[_ListOfTwo]])]
"""An array (m, n, 2) that is a list of lists of pairs in JSON."""
Integers = Annotated[NDArray[np.int64], PlainSerializer(_listed, return_type=list[int])]
"""An array (n,) that is a list of whole numbers in JSON."""
Flags = Annotated[NDArray[np.bool_], PlainSerializer(_listed, return_type=list[bool])]
"""An array (n,) that is a list of true and false in JSON."""


class Leaf(WithHints):
    """Base of a dataclass that JSON has with the same fields; a docstring below each field says what it is."""

    __pydantic_config__ = CONFIG

    def to_dict(self) -> dict[str, Any]:
        """Return all fields as numbers, lists and texts, ready for JSON."""
        return _adapter(type(self)).dump_python(self, mode="json")

    def to_json(self, indent: int | None = 2) -> str:
        """Return `to_dict` as JSON; every number in it is finite."""
        return json_text(self.to_dict(), indent)


class Record(BaseModel):
    """Base of the JSON form of an object, where the two differ; all keys are always present."""

    model_config = CONFIG

    def __init_subclass__(cls, **options: Any) -> None:
        """Let the schema of a class have its docstring under ``python -OO`` too."""
        super().__init_subclass__(**options)
        cls.__doc__ = docstring(cls)

    def to_dict(self) -> dict[str, Any]:
        """Return all fields as numbers, lists and texts, ready for JSON."""
        return self.model_dump(mode="json")


class Recorded(WithHints, ABC):
    """Base of a result whose JSON is a `Record`."""

    @abstractmethod
    def record(self) -> Record:
        """Return the JSON form of the result."""

    def to_dict(self) -> dict[str, Any]:
        """Return the result as numbers, lists and texts, ready for JSON."""
        return self.record().to_dict()

    def to_json(self, indent: int | None = 2) -> str:
        """Return `to_dict` as JSON; every number in it is finite."""
        return json_text(self.to_dict(), indent)


def json_text(record: dict[str, Any], indent: int | None = 2) -> str:
    """Write numbers, lists and texts as JSON; hidden characters are escaped.

    `ValueError` for a number that is not finite.
    """
    return escaped_json(json.dumps(record, indent=indent, allow_nan=False, ensure_ascii=False))


def csv_text(header: Iterable[str], rows: Iterable[Iterable[Any]]) -> str:
    """Write a table as CSV; what is None is empty."""
    stream = io.StringIO()
    table = csv.writer(stream, lineterminator="\n")
    table.writerow(header)
    table.writerows(rows)
    return stream.getvalue()


class _Schema(DescribedSchema):
    """JSON Schema of written results, without defaults."""

    def default_schema(self, schema: Any) -> dict[str, Any]:
        """Describe a field without its default."""
        return self.generate_inner(schema["schema"])

    def dataclass_schema(self, schema: Any) -> dict[str, Any]:
        """Describe a dataclass by its docstring, as Pydantic does by itself from 2.13 on."""
        described = schema["cls"]
        stated = with_descriptions(super().dataclass_schema(schema), described)
        for name, part in stated["properties"].items():
            if "description" not in part:  # a property, of which Python has removed the docstring
                part["description"] = docstring(getattr(described, name))
        return {**stated, "description": docstring(described)}

    def enum_schema(self, schema: Any) -> dict[str, Any]:
        """Describe an enumeration by its docstring, as Pydantic does if Python has it."""
        return {**super().enum_schema(schema), "description": docstring(schema["cls"])}


def schema_of(result: type[Leaf] | type[Record]) -> dict[str, Any]:
    """Return the JSON Schema (draft 2020-12) of the JSON of a result."""
    stated = _adapter(result).json_schema(mode="serialization", schema_generator=_Schema)
    return {"$schema": DIALECT, **stated}


@cache
def _adapter(kind: type[Any]) -> TypeAdapter[Any]:
    """The adapter of a class, made once."""
    return TypeAdapter(kind)
