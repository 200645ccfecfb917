"""Checks of what users give to functions: numbers, texts, paths of files, objects. Arrays are in `arrays`.

Each raises a `ProblemError` that says what was needed, what was found, and what to do. There is no NumPy here, so that
``bemcontact --help`` answers at once.
"""

import os
from collections.abc import Iterable, Mapping
from decimal import Decimal
from math import isfinite
from numbers import Integral, Real
from pathlib import Path
from reprlib import Repr
from typing import Any, TypeVar, cast

from bemcontact.errors import LINE_BREAKS, ProblemError, hidden_character

Kind = TypeVar("Kind")

LARGEST_NUMBER = 1e100
"""Largest number in arrays and arguments. Its square is still finite, so that products can be computed. Numbers that a
problem states have a lower limit, for those in arrays are products of them."""

LONGEST_NAME = 1000
"""Largest number of characters in a name."""
LARGEST_COUNT = 2**63 - 1
"""Largest whole number, which fits into all places that count."""

_short = Repr()
_short.maxother, _short.maxstring, _short.maxlevel = 60, 60, 3


def shown(value: object) -> str:
    """Write a value in an error, shortened; one that has no short text by its kind."""
    shape = getattr(value, "shape", None)
    if isinstance(shape, tuple) and shape:
        return f"{type(value).__name__} of shape {shape}"
    try:
        return " ".join(_short.repr(value).split())
    except Exception:  # an object of the user may refuse to be written, and so does an integer of 5000 digits
        return f"an object of type {type(value).__name__}"


def real_number(value: object, what: str) -> float:
    """Read one finite number of any real kind, a 0-d array included; errors call it `what`."""
    if type(value) is float and isfinite(value):
        return value
    single = _single(value)
    try:
        number = float(cast(Any, single)) if is_real(single) else None
    except (OverflowError, ValueError):
        number = None
    if number is None or not isfinite(number):
        raise ProblemError(f"{what} must be a finite number; found {shown(value)}")
    return number


def whole_number(value: object, what: str, least: int, most: int = LARGEST_COUNT) -> int:
    """Read a whole number of at least `least`, and of at most `most`; errors call it `what`."""
    single = _single(value)
    count = int(single) if isinstance(single, Integral) and not isinstance(single, bool) else None
    if count is None or count < least:
        raise ProblemError(f"the {what} must be a whole number of at least {least}; found {shown(value)}")
    if count > most:
        raise ProblemError(f"the {what} must be a whole number of at most {most}; found {shown(value)}")
    return count


def instance_of(value: object, kind: type[Kind], what: str, hint: str) -> Kind:
    """Refuse an object of another kind; the hint says where the right one comes from."""
    if not isinstance(value, kind):
        raise ProblemError(f"{what} must be a {kind.__name__}; found {shown(value)}; {hint}")
    return value


def text_of_argument(value: object, what: str) -> str:
    """Refuse all but a text."""
    if not isinstance(value, str):
        raise ProblemError(f"{what} must be a text; found {shown(value)}")
    return value


def label_fault(text: str) -> str | None:
    """Say what is wrong with a name or label; None if it is one line of visible text."""
    if hidden := hidden_character(text):
        return f"a name or label is one line of text, but contains the character {hidden}; remove it"
    if len(text) > LONGEST_NAME:
        return f"a name or label has at most {LONGEST_NAME} characters, found {len(text)}"
    return None


def label(value: object, what: str) -> str:
    """Refuse all but a name or label, as specs do."""
    text = text_of_argument(value, what)
    if fault := label_fault(text):
        raise ProblemError(f"{what}: {fault}")
    return text


def labels(value: object, what: str) -> tuple[str, ...]:
    """Read a sequence of names or labels."""
    return tuple(label(item, what) for item in texts(value, what))


def visible_texts(value: object, what: str) -> tuple[str, ...]:
    """Read a sequence of texts, of several lines or not, without other hidden characters."""
    for text in (read := texts(value, what)):
        if hidden := hidden_character(text, LINE_BREAKS):
            raise ProblemError(f"{what}: a text must not contain the hidden character {hidden}; remove it")
    return read


def texts(value: object, what: str) -> tuple[str, ...]:
    """Read a sequence of texts; a single text is refused, because its letters would be taken one by one."""
    try:
        items = None if isinstance(value, str | bytes | Mapping) else tuple(cast(Iterable[object], value))
    except Exception:  # it cannot be iterated over, whatever it is
        items = None
    if items is None or not all(isinstance(item, str) for item in items):
        raise ProblemError(f"{what} must be a list of texts; found {shown(value)}; put a single text into brackets")
    return cast(tuple[str, ...], items)


def load_factors(value: object) -> dict[str, float]:
    """Read the factors of load cases; refuse all but a mapping of their names to numbers."""
    if not isinstance(value, Mapping):
        raise ProblemError(f"factors by load case are needed, such as {{'wind': 1.5}}; found {shown(value)}")
    return {
        text_of_argument(case, "the name of a load case"): real_number(factor, f"the factor of '{case}'")
        for case, factor in value.items()
    }


def file_path(value: object, what: str) -> Path:
    """Read the path of a file: a text or a path object."""
    if not isinstance(value, str | os.PathLike) or not isinstance(os.fspath(value), str) or "\0" in os.fspath(value):
        raise ProblemError(f"{what} must be the path of a file, such as 'block.yaml'; found {shown(value)}")
    return Path(value)


def ensure_callable(value: object, what: str) -> None:
    """Refuse what is given, is not None, and cannot be called."""
    if value is not None and not callable(value):
        raise ProblemError(f"{what} must be a function, or None; found {shown(value)}")


def is_real(value: object) -> bool:
    """Whether this is a real number and no truth value."""
    return isinstance(value, Real | Decimal) and not isinstance(value, bool)


def _single(value: Any) -> object:
    """The number in a scalar or a 0-d array of NumPy; other values as they are, a masked one as None."""
    if getattr(value, "shape", None) != () or not hasattr(value, "item"):
        return value
    return None if getattr(value, "mask", False) else value.item()
