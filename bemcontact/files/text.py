"""The text of a file that a person wrote, whatever the editor has put around it."""

import codecs
import os
from difflib import get_close_matches
from pathlib import Path

from bemcontact.errors import SpecError

_CONTROL_BYTES = frozenset(range(32)) - frozenset(b"\t\n\f\r\x1b")
"""Bytes that stand in no text, whatever its encoding, unless its characters have two bytes."""


def text_of(path: str | os.PathLike[str]) -> str:
    """Read a file as text.

    Parameters
    ----------
    path : a file in UTF-8, or in UTF-16 with a byte order mark

    Returns
    -------
    str

    Raises
    ------
    SpecError
        If there is no such file, it cannot be read, or it is no text.
    """
    path = Path(path)
    try:
        if path.is_dir():
            raise SpecError(f"{path}: is a directory; name a file in it")
        return _decoded(path.read_bytes(), str(path))
    except FileNotFoundError:
        raise SpecError(f"{path}: there is no such file{_similar_file(path)}") from None
    except (OSError, ValueError) as error:
        raise SpecError(f"{path}: cannot be read ({getattr(error, 'strerror', None) or error})") from error


def place_after(text: str, name: str) -> str:
    """Write ``name:line:column`` of the place that a text leads up to, both counted from 1."""
    return f"{name}:{text.count(chr(10)) + 1}:{len(text) - text.rfind(chr(10))}"


def _similar_file(path: Path) -> str:
    """Name a file of nearly this name, or say where it was looked for."""
    try:
        names = [entry.name for entry in path.parent.iterdir()]
    except OSError:
        return f"; there is no directory {path.parent} to be read either"
    matches = get_close_matches(path.name, names, n=1, cutoff=0.7)
    return f"; did you mean {path.with_name(matches[0])}?" if matches else f" in {path.parent.resolve()}"


def _decoded(content: bytes, name: str) -> str:
    """Decode the text, without the byte order mark that some editors put before it."""
    with_mark = content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
    encoding, label = ("utf-16", "UTF-16") if with_mark else ("utf-8-sig", "UTF-8")
    try:
        return content.decode(encoding)
    except UnicodeDecodeError as error:
        if _CONTROL_BYTES.intersection(content):
            raise SpecError(f"{name}: is not a text file; name one that an editor shows as text") from None
        place = place_after(content[: error.start].decode(encoding, errors="replace"), name)
        message = f"byte 0x{content[error.start]:02x} is no {label} text; save the file as UTF-8"
        raise SpecError(f"{place}: {message}") from None
