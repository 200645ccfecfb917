"""Frozen dataclasses of arrays as one ``.npz`` file. The name of an array is the path to its field, with dots.

Members are not compressed, so that nothing grows when it is read. Known members alone are read, and only if they are no
larger than a problem of this many contact points can need. The checksum tells a damaged file from a whole one; the
dataclasses check what it contains.
"""

import hashlib
import io
from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass
from pathlib import Path
from types import NoneType
from typing import IO, Any, TypeVar, get_args, get_origin, get_type_hints
from zipfile import ZIP_STORED, BadZipFile, ZipFile

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from bemcontact.checks.arguments import shown
from bemcontact.errors import ProblemError
from bemcontact.files import output

Kind = TypeVar("Kind")
Arrays = dict[str, NDArray[Any]]

FILE_FORMAT = "bemcontact.condensed.5"
HEADERS = {(1, 0): npy.read_array_header_1_0, (2, 0): npy.read_array_header_2_0}
"""Versions of the form of an array in a file, and how their heads are read."""
PLAIN = "biufU"
"""Kinds of data of an array that can be read without running anything: truth values, numbers, texts."""
WORDS: Mapping[Any, str] = {str: "text", float: "number", tuple: "list", Mapping: "list of pairs"}
"""Types of fields in plain words."""
ROOM = 1 << 26
"""Bytes of a member, such as of names or notes, that need no matrix beside it."""
SQUARES = 4
"""Matrices as large as the compliance that a member may be: the motions of tools are three of them."""
AGAIN = "condense the problem again"


def write(path: Path, stored: Any) -> None:
    """Write a dataclass, whole or not at all; `OSError` if it cannot be written."""
    arrays = dict(_arrays(stored, ""))
    heads: dict[str, Any] = {"format": np.array(FILE_FORMAT), "checksum": np.array(_checksum(arrays))}
    with output.whole_file(path) as temporary, open(temporary, "xb") as stream:
        np.savez(stream, **{**heads, **arrays})


def read(path: Path, kind: type[Kind]) -> Kind:
    """Read a dataclass that `write` wrote; `ProblemError` if the file is something else, or is damaged."""
    try:
        if not path.is_file():
            raise ProblemError("there is no such file" if not path.exists() else "this is no regular file; name a file")
        with path.open("rb") as stream, _opened(stream) as package:
            arrays = _known_arrays(package, kind)
        return _made(kind, arrays, "")
    except OSError as error:
        raise ProblemError(f"{path}: cannot be read ({error.strerror or error})") from error
    except ProblemError as error:
        raise ProblemError(f"{path}: {error}") from error


def _opened(stream: io.BufferedReader) -> ZipFile:
    """The archive in a file."""
    try:
        return ZipFile(stream)
    except Exception as error:  # zipfile raises many kinds of errors for a file that is no archive
        raise ProblemError("not an .npz file; CondensedContact.save writes one") from error


def _known_arrays(package: ZipFile, kind: type[Any]) -> Arrays:
    """The members that a dataclass has, checked against the format and the checksum; others are not read."""
    stated = _member(package, "format") if "format.npy" in package.namelist() else None
    if stated is None or str(stated) != FILE_FORMAT:
        found = "" if stated is None else f", but of format {shown(str(stated))}"
        raise ProblemError(f"not a condensed contact problem of format {FILE_FORMAT}{found}; {AGAIN} with this version")
    present = {*package.namelist()}
    arrays = {name: _member(package, name) for name in _names(kind, "") if f"{name}.npy" in present}
    checksum = str(_member(package, "checksum")) if "checksum.npy" in present else "none"
    if checksum != _checksum(arrays):
        raise ProblemError(f"the file is damaged: its checksum does not fit its members; {AGAIN}")
    return arrays


def _member(package: ZipFile, name: str) -> NDArray[Any]:
    """Read one array of plain data, and no more bytes than the file has."""
    try:
        item = package.getinfo(f"{name}.npy")
        if item.compress_type != ZIP_STORED or item.file_size != item.compress_size:
            raise ProblemError("it is compressed, and CondensedContact.save does not compress")
        if item.file_size > (most := _most_bytes(package)):
            raise ProblemError(f"it has {item.file_size} bytes where compliance and weights leave room for {most}")
        with package.open(item) as stream:
            return _array(stream, item.file_size)
    except Exception as error:  # zipfile and NumPy raise many kinds of errors for damaged bytes
        reason = str(error) if isinstance(error, ProblemError) else "its bytes are no array"
        raise ProblemError(f"member '{name}' is damaged: {reason}; {AGAIN}") from error


def _most_bytes(package: ZipFile) -> int:
    """Largest size of a member, by the number of contact points that weights and compliance both have."""
    sizes = {item.filename: item.file_size for item in package.infolist()}
    return ROOM + SQUARES * min(sizes.get("compliance.npy", 0), sizes.get("weights.npy", 0) ** 2 // 8)


def _array(stream: IO[bytes], total: int) -> NDArray[Any]:
    """The array in a member of `total` bytes, which are read if the head fits them; nothing is unpickled."""
    shape, by_columns, dtype = HEADERS[npy.read_magic(stream)](stream)
    there = total - stream.tell()
    if dtype.kind not in PLAIN or dtype.shape:
        raise ProblemError(f"it has data of type {dtype}, which is not read")
    size = dtype.itemsize
    for length in shape:
        size *= length
    if size != there or min(shape, default=0) < 0:
        raise ProblemError(f"it has {there} bytes where its shape {shape} needs {size}")
    data = stream.read(there)
    if len(data) != there or stream.read(1):
        raise BadZipFile("its size is not the stated one")
    flat = np.frombuffer(data, dtype) if data else np.zeros(0, dtype)
    return flat.reshape(shape, order="F" if by_columns else "C")


def _checksum(arrays: Mapping[str, NDArray[Any]]) -> str:
    """The SHA-256 of names, types, shapes and entries of arrays."""
    digest = hashlib.sha256()
    for name, array in sorted(arrays.items()):
        digest.update(f"{name} {array.dtype.str} {array.shape}\n".encode())
        digest.update(array.tobytes())
    return digest.hexdigest()


def _arrays(stored: Any, prefix: str) -> Iterator[tuple[str, NDArray[Any]]]:
    """Names and arrays of all fields of a dataclass."""
    for item in fields(stored):
        value = getattr(stored, item.name)
        if is_dataclass(value):
            yield from _arrays(value, f"{prefix}{item.name}.")
        elif value is not None:
            yield prefix + item.name, np.array(sorted(value.items()) if isinstance(value, Mapping) else value)


def _hints(kind: type[Any]) -> dict[str, Any]:
    """Types of the fields of a dataclass."""
    hints = get_type_hints(kind)
    return {item.name: hints[item.name] for item in fields(kind)}


def _names(kind: type[Any], prefix: str) -> Iterator[str]:
    """Names of the arrays of all fields of a dataclass."""
    for name, hint in _hints(kind).items():
        if is_dataclass(hint):
            yield from _names(hint, f"{prefix}{name}.")  # pyright: ignore[reportArgumentType]
        else:
            yield prefix + name


def _made(kind: type[Kind], arrays: Arrays, prefix: str) -> Kind:
    """Make a dataclass from the arrays under a prefix."""
    return kind(**{name: _field(hint, arrays, prefix + name) for name, hint in _hints(kind).items()})


def _field(hint: Any, arrays: Arrays, key: str) -> Any:
    """One field, converted to its type; one that may be None may be missing."""
    if is_dataclass(hint):
        return _made(hint, arrays, f"{key}.")  # pyright: ignore[reportArgumentType]
    array = arrays.get(key)
    if array is None:
        if NoneType not in get_args(hint):
            raise ProblemError(f"member '{key}' is missing; {AGAIN}")
        return None
    try:
        return _converted(get_origin(hint) or hint, array)
    except (TypeError, ValueError):
        kind = WORDS.get(get_origin(hint) or hint, "array of this kind")
        raise ProblemError(f"member '{key}' is no {kind}: it has the shape {array.shape}; {AGAIN}") from None


def _converted(kind: Any, array: NDArray[Any]) -> Any:
    """An array as a text, a number, a tuple or a mapping, if it is one; else the array."""
    if kind is str or kind is float:
        return kind(array.item())
    if kind is tuple:
        return tuple(array.tolist())
    return dict(array.tolist()) if kind is Mapping else array
