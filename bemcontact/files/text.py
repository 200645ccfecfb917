"""Reading of text files in the encodings of common editors."""

import codecs
import os
from difflib import get_close_matches
from pathlib import Path

from bemcontact.errors import SpecError

_CONTROL_BYTES = frozenset(range(32)) - frozenset(b"\t\n\f\r\x1b")
"""Bytes that occur in no text, except in UTF-16."""


def text_of(path: str | os.PathLike[str]) -> str:
    """Text of a file in UTF-8, or in UTF-16 with a byte order mark; `SpecError` if it cannot be read as text."""
    path = Path(path)
    try:
        if path.is_dir():
            raise SpecError(f"{path}: this is a directory; name a file in it")
        return _decoded(path.read_bytes(), str(path))
    except FileNotFoundError:
        raise SpecError(f"{path}: there is no such file{_similar_file(path)}") from None
    except (OSError, ValueError) as error:
        raise SpecError(f"{path}: the file cannot be read ({getattr(error, 'strerror', None) or error})") from error


def place_after(text: str, name: str) -> str:
    """``name:line:column`` of the place after a text, counted from 1."""
    return f"{name}:{text.count(chr(10)) + 1}:{len(text) - text.rfind(chr(10))}"


def _similar_file(path: Path) -> str:
    """Hint with a file of a similar name, or with the folder that was searched."""
    try:
        names = [entry.name for entry in path.parent.iterdir()]
    except OSError:
        return f"; there is no directory {path.parent}, or it cannot be read"
    matches = get_close_matches(path.name, names, n=1, cutoff=0.7)
    return f"; did you mean {path.with_name(matches[0])}?" if matches else f" in {path.parent.resolve()}"


def _decoded(content: bytes, name: str) -> str:
    """Decoded text without its byte order mark."""
    with_mark = content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
    encoding, label = ("utf-16", "UTF-16") if with_mark else ("utf-8-sig", "UTF-8")
    try:
        return content.decode(encoding)
    except UnicodeDecodeError as error:
        if _CONTROL_BYTES.intersection(content):
            raise SpecError(f"{name}: this is not a text file; name a YAML file") from None
        place = place_after(content[: error.start].decode(encoding, errors="replace"), name)
        message = f"byte 0x{content[error.start]:02x} is not valid {label}; save the file as UTF-8"
        raise SpecError(f"{place}: {message}") from None
