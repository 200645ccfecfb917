"""Frozen dataclasses of arrays as one ``.npz`` file. The name of an array is the path to its field, with dots."""

from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any, TypeVar, get_origin, get_type_hints
from zipfile import BadZipFile

import numpy as np

from bemcontact.errors import ProblemError
from bemcontact.files import output

Kind = TypeVar("Kind")

FILE_FORMAT = "bemcontact.condensed.3"


def write(path: Path, stored: Any) -> None:
    """Write a dataclass, whole or not at all; `OSError` if it cannot be written."""
    arrays: dict[str, Any] = {"format": np.array(FILE_FORMAT), **dict(_arrays(stored, ""))}
    with output.whole_file(path) as temporary, open(temporary, "xb") as stream:
        np.savez_compressed(stream, **arrays)


def read(path: Path, kind: type[Kind]) -> Kind:
    """Read a dataclass that `write` wrote; `ProblemError` if the file is something else."""
    try:
        with np.load(path, allow_pickle=False) as data:
            stored = {key: data[key] for key in data.files}
    except OSError as error:
        raise ProblemError(f"{path}: cannot be read ({error.strerror or 'not an .npz file'})") from error
    except (ValueError, EOFError, BadZipFile) as error:
        raise ProblemError(f"{path}: not an .npz file; CondensedContact.save writes one") from error
    if str(stored.pop("format", "")) != FILE_FORMAT:
        raise ProblemError(f"{path}: not a condensed contact problem of format {FILE_FORMAT}; write it again")
    return _made(kind, stored, "")


def _arrays(stored: Any, prefix: str) -> Iterator[tuple[str, Any]]:
    """Names and arrays of all fields of a dataclass."""
    for item in fields(stored):
        value = getattr(stored, item.name)
        if is_dataclass(value):
            yield from _arrays(value, f"{prefix}{item.name}.")
        elif value is not None:
            yield prefix + item.name, np.array(sorted(value.items()) if isinstance(value, Mapping) else value)


def _made(kind: type[Kind], arrays: Mapping[str, Any], prefix: str) -> Kind:
    """Make a dataclass from the arrays under a prefix; a missing array was None."""
    return kind(**{name: _field(hint, arrays, prefix + name) for name, hint in get_type_hints(kind).items()})


def _field(hint: Any, arrays: Mapping[str, Any], key: str) -> Any:
    """One field, converted to its type."""
    if is_dataclass(hint):
        return _made(hint, arrays, f"{key}.")  # pyright: ignore[reportArgumentType]
    array = arrays.get(key)
    if array is None:
        return None
    forms = {str: lambda: str(array), tuple: lambda: tuple(array.tolist()), Mapping: lambda: dict(array.tolist())}
    return forms.get(get_origin(hint) or hint, lambda: array)()
