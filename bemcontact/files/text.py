"""Reading of text files in the encodings of common editors."""

import codecs
import io
import os
import stat
from difflib import get_close_matches
from pathlib import Path

from bemcontact.errors import SpecError, escaped

MOST_BYTES = 20_000_000
"""Largest size of a file that is read."""
PROBLEM = "a YAML file"
"""What to name where a problem is read."""
SIMILAR = 0.75
"""Similarity of two names, between 0 and 1, from which one may be meant for the other."""

_CONTROL_BYTES = frozenset(range(32)) - frozenset(b"\t\n\f\r\x1b")
"""Bytes that occur in no text, except in UTF-16."""


def text_of(path: str | os.PathLike[str], wanted: str = PROBLEM) -> str:
    """Text of a file in UTF-8, or in UTF-16 with a byte order mark; `SpecError` if it cannot be read as text.

    `wanted` says in errors what kind of file to name.
    """
    path, name = Path(path), escaped(os.fspath(path))
    try:
        with open(path, "rb", opener=_opened) as file:
            return decoded(file.read(MOST_BYTES + 1), name, wanted)
    except IsADirectoryError:
        raise SpecError(f"{name}: this is a directory; name a file in it") from None
    except FileNotFoundError:
        raise SpecError(f"{name}: {_not_found(path)}") from None
    except io.UnsupportedOperation:
        from_stream = ", or write - to read a problem from standard input" if wanted == PROBLEM else ""
        raise SpecError(f"{name}: this is not a regular file; name {wanted}{from_stream}") from None
    except (OSError, ValueError) as error:
        raise SpecError(f"{name}: the file cannot be read ({getattr(error, 'strerror', None) or error})") from error


def _opened(path: str, flags: int) -> int:
    """Descriptor of a regular file; a pipe or a device could block, or never end."""
    descriptor = os.open(path, flags | getattr(os, "O_NONBLOCK", 0))
    mode = os.fstat(descriptor).st_mode
    if stat.S_ISREG(mode) or stat.S_ISDIR(mode):
        return descriptor
    os.close(descriptor)
    raise io.UnsupportedOperation


def place_after(text: str, name: str) -> str:
    """``name:line:column`` of the place after a text, counted from 1."""
    return f"{name}:{text.count(chr(10)) + 1}:{len(text) - text.rfind(chr(10))}"


def _not_found(path: Path) -> str:
    """Say that there is no file, and name one of a similar name or another ending, or the folder that was searched."""
    if path.is_symlink():
        return f"this is a link to {escaped(os.readlink(path))}, which does not exist; correct the link"
    try:
        beside = [entry for entry in path.parent.iterdir() if entry.is_file()]
    except OSError:
        return f"there is no such file; there is no directory {escaped(str(path.parent))}, or it cannot be read"
    alike = {entry.stem: entry.name for entry in beside if entry.suffix == path.suffix}
    alike.update({entry.stem: entry.name for entry in beside if entry.stem == path.stem})
    if similar := get_close_matches(path.stem, alike, n=1, cutoff=SIMILAR):
        return f"there is no such file; did you mean {escaped(str(path.with_name(alike[similar[0]])))}?"
    return f"there is no such file in {escaped(os.path.realpath(path.parent))}"


def decoded(content: bytes, name: str, wanted: str = PROBLEM) -> str:
    """Decoded text without its byte order mark; `SpecError` if it is no text, or too long."""
    if len(content) > MOST_BYTES:
        raise SpecError(f"{name}: the file has more than {MOST_BYTES // 10**6} million bytes; name a smaller one")
    with_mark = content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
    encoding, label = ("utf-16", "UTF-16") if with_mark else ("utf-8-sig", "UTF-8")
    try:
        return content.decode(encoding)
    except UnicodeDecodeError as error:
        if _CONTROL_BYTES.intersection(content):
            raise SpecError(f"{name}: this is not a text file; name {wanted}") from None
        place = place_after(content[: error.start].decode(encoding, errors="replace"), name)
        message = f"byte 0x{content[error.start]:02x} is not valid {label}; save the file as UTF-8"
        raise SpecError(f"{place}: {message}") from None
