"""Axes of a study: keys of a problem, and the values that they take."""

import json
import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any, cast

import numpy as np

from bemcontact.cached import cached_property
from bemcontact.checks.arguments import instance_of, shown, text_of_argument
from bemcontact.errors import Issue, KeyPath, OptionError, ProblemError, SpecError, dotted
from bemcontact.frozen import frozen_value
from bemcontact.problems.key_path import parsed_path
from bemcontact.problems.quantities import in_units
from bemcontact.problems.units import Units
from bemcontact.spec import written_value
from bemcontact.studies.outputs import DIMENSIONS

VARIANT, CASE = "variant", "case"
"""Keys of an axis whose values are names of variants, and of load cases or combinations."""
MOST_MEMBERS = 1_000_000
"""Largest number of members of a study."""
COLUMNS = ("member", VARIANT, CASE, "status", "equations", "mesh", "message")
"""Columns of the table that have their names, beside the outputs."""
_NAMED = re.compile(r"\s*([^.,:=\[\]]*[^.,:=\[\]\s])\s*:(.*)", re.DOTALL)  # a key with a colon has a point before it
_RANGE = re.compile(r"\s*([^:\s{}]+)\s*:\s*([^:\s{}]+)\s*:\s*([^:\s{}]+)\s*")
_IN_UNITS = r"\s*([-+.\deE]+)\s*([^-+.\d:\s][^:]*?)\s*:"
_RANGE_IN_UNITS = re.compile(2 * _IN_UNITS + r"\s*(\d+)\s*")
_PART_OF_RANGE = re.compile(r"\s*[-+.\d][-+.\deE]*(\s*:\s*[-+.\deE]*)+")
_OTHER_LIST = re.compile(r"\s*(\{[^:]*\}|[-+\d][-+.\deE]*\.\.[-+.\deE]+)\s*")
_OPENING, _CLOSING, _QUOTES = "[{(", "]})", "\"'"


@frozen_value
class Axis:
    """Keys that take the same value, and the values one after the other.

    Parameters
    ----------
    keys : as written
    values : one or more
    title : name that the user gave it, if any
    """

    keys: tuple[str, ...]
    values: tuple[Any, ...]
    title: str = ""

    @cached_property
    def name(self) -> str:
        """Title; without one the key, of several keys what is particular in the first and how many more there are."""
        if self.title or len(self.keys) == 1:
            return self.title or self.keys[0]
        first, alike = self.paths[0], 0
        for number, steps in enumerate(zip(*self.paths, strict=False)):
            if isinstance(first[number], str):
                alike = number
            if len({*steps}) > 1:
                break
        return f"{dotted(first[alike:])} + {len(self.keys) - 1} more"

    @property
    def written(self) -> str:
        """Keys with commas between them."""
        return ",".join(self.keys)

    @cached_property
    def paths(self) -> tuple[KeyPath, ...]:
        """The keys as paths."""
        return tuple(map(parsed_path, self.keys))

    @property
    def of_variants(self) -> bool:
        """Whether the values are names of variants."""
        return self.keys == (VARIANT,)


def axes_of(vary: Mapping[Any, Any], units: Units) -> tuple[Axis, ...]:
    """Read axes from values by key, values with units as numbers in those of the problem.

    `ProblemError` if a key occurs twice, or an axis has no values or equal ones.
    """
    instance_of(vary, Mapping, "vary", 'give values by key, such as {"conditions.top.pressure": [10, 20]}')
    axes = tuple(_axis(keys, values, units) for keys, values in vary.items())
    if not axes:
        raise OptionError("there is nothing to vary; give values by key")
    names = Counter(axis.name for axis in axes)
    if twice := [axis.title for axis in axes if axis.title and names[axis.title] > 1]:
        raise OptionError(f"two axes have the name '{twice[0]}'; give each its own")
    axes = tuple(replace(axis, title=axis.written) if names[axis.name] > 1 else axis for axis in axes)
    stated = [path for axis in axes for path in axis.paths]
    for number, path in enumerate(stated):
        if path in stated[:number]:
            raise OptionError(Issue(path=path, message="the key is varied twice; give all its values at once"))
    count = int(np.prod([len(axis.values) for axis in axes], dtype=float))
    if count > MOST_MEMBERS:
        raise OptionError(f"the study has {count} members, and at most {MOST_MEMBERS} are possible; take fewer values")
    return axes


def _axis(keys: object, values: object, units: Units) -> Axis:
    """One axis from a key, several keys with commas between them or in a tuple, and values.

    A name may stand before the keys, and a colon between.
    """
    title = ""
    if not isinstance(keys, tuple):
        title, keys = _title_and_keys(text_of_argument(keys, "a key of vary"))
        keys = tuple(keys.split(","))
    if not keys:
        raise OptionError("a tuple of vary has no key; write one such as conditions.top.pressure")
    axis = Axis(keys=tuple(text_of_argument(key, "a key of vary").strip() for key in keys), values=(), title=title)
    if title.removesuffix("_error") in (*COLUMNS, *DIMENSIONS):
        raise OptionError(f"'{title}' is another column of the table; give the axis another name")
    if (paths := axis.paths) and len(paths) > 1 and {(VARIANT,), (CASE,)} & {*paths}:
        raise OptionError(f"{axis.written}: variants and load cases are varied alone, without other keys")
    if isinstance(values, str | bytes | Mapping) or not hasattr(values, "__iter__"):
        raise OptionError(f"{axis.written}: a list of values is needed; found {shown(values)}")
    plain = map(_plain, cast(Sequence[object], values))
    listed = tuple(in_units(value, axis.paths[0], units.length, units.force) for value in plain)
    if not listed:
        raise OptionError(f"{axis.written}: there are no values")
    seen = set[str]()
    for value in listed:
        if (text := _text(axis.written, value)) in seen:
            raise OptionError(f"{axis.written}: the value {shown(value)} occurs twice; remove one")
        seen.add(text)
        if axis.keys[0] in (VARIANT, CASE) and not isinstance(value, str):
            raise OptionError(f"{axis.written}: a name is needed; found {shown(value)}")
    return replace(axis, values=listed)


def _title_and_keys(text: str) -> tuple[str, str]:
    """Name of an axis, empty without one, and its keys."""
    named = _NAMED.fullmatch(text)
    return (named[1], named[2].strip()) if named else ("", text.strip())


def _text(name: str, value: object) -> str:
    """Write a value as JSON, whole numbers as other numbers; `OptionError` if it is none that JSON has."""
    try:
        return json.dumps(as_floats(value), sort_keys=True, allow_nan=False)
    except (TypeError, ValueError, OverflowError):
        raise OptionError(f"{name}: numbers, texts and lists can be varied; found {shown(value)}") from None


def as_floats(value: object) -> object:
    """A value with whole numbers as other numbers: 20 and 20.0 are the same, and so are 0.0 and -0.0."""
    match value:
        case int() | float() if not isinstance(value, bool):
            return float(value) + 0.0
        case list():
            return [*map(as_floats, value)]
        case dict():
            return {key: as_floats(item) for key, item in value.items()}
    return value


def _plain(value: object) -> Any:
    """A number or an array of NumPy as Python's own, a tuple as a list; other values as they are."""
    if isinstance(value, np.generic | np.ndarray):
        return value.tolist()
    return [*map(_plain, value)] if isinstance(value, tuple | list) else value


def written_axes(texts: Sequence[str]) -> dict[str, list[Any]]:
    """Read axes as `written_axis` does; `OptionError` for keys that are given twice."""
    axes = dict[str, list[Any]]()
    for keys, values in map(written_axis, texts):
        if keys in axes:
            raise OptionError(f"{keys} is given twice; give all its values at once")
        axes[keys] = values
    return axes


def written_axis(text: str) -> tuple[str, list[Any]]:
    """Read an axis such as ``conditions.top.pressure=10:50:5`` or ``variant=fine,coarse``: keys and values.

    `OptionError` says what is wrong.
    """
    keys, equals, written = text.partition("=")
    keys = keys.strip()
    if not equals:
        raise OptionError(f"{text}: there is no '='; write {text}=a:b:n for n values from a to b, or {text}=v1,v2")
    items = [item.strip() for item in _items(written)]
    if "" in items:
        raise OptionError(f"{text}: a value is missing behind '=' or at a comma; write null for none")
    if _title_and_keys(keys)[1] in (VARIANT, CASE):
        return keys, [item.strip(_QUOTES) for item in items]
    if parts := _RANGE.fullmatch(written):
        return keys, _range(keys, *parts.groups())
    if parts := _RANGE_IN_UNITS.fullmatch(written):
        first, unit, last, other, count = parts.groups()
        if unit != other:
            raise OptionError(f"{keys}: both ends of a range need one unit; found {unit} and {other}")
        return keys, [f"{value!r} {unit}" for value in _range(keys, first, last, count)]
    if _PART_OF_RANGE.fullmatch(written) or _OTHER_LIST.fullmatch(written):
        raise OptionError(f"{keys}: expected a:b:n for n values from a to b, or v1,v2,v3; found {written.strip()}")
    try:
        return keys, [written_value(item, keys) for item in items]
    except SpecError as error:
        raise OptionError(str(error).partition("\n")[0]) from None


def _range(keys: str, first: str, last: str, count: str) -> list[float]:
    """Values in equal steps from first to last."""
    try:
        start, end, number = float(first), float(last), int(count)
    except ValueError:
        raise OptionError(
            f"{keys}: expected a:b:n, two numbers and how many values; found {first}:{last}:{count}"
        ) from None
    if not np.isfinite([start, end]).all() or number < 2 or start == end:
        reason = "a range a:b:n has two different finite ends and at least 2 values"
        raise OptionError(f"{keys}: {reason}; found {first}:{last}:{count}; write one value by itself")
    if number > MOST_MEMBERS:
        raise OptionError(f"{keys}: at most {MOST_MEMBERS} values are possible; found {count}")
    return [float(f"{value:.15g}") for value in np.linspace(start, end, number)]


def _items(text: str) -> Iterator[str]:
    """Parts of a text between commas that stand in no bracket and no quotes."""
    depth, quote, item = 0, "", ""
    for letter in text:
        if quote:
            quote = "" if letter == quote else quote
        elif letter in _QUOTES:
            quote = letter
        depth += (letter in _OPENING) - (letter in _CLOSING) if not quote else 0
        if letter == "," and not depth and not quote:
            yield item
            item = ""
        else:
            item += letter
    yield item


def located_in(axis: Axis, value: object, error: ProblemError) -> ProblemError:
    """The error of a value of an axis, with the key where it has no place, and the value where it has another."""
    if not any(issue.path for issue in error.issues):
        return ProblemError(f"{axis.written}: {error}")
    own, at = {path[-1] for path in axis.paths}, f" (with {axis.name} = {value})"
    elsewhere = (bool({*issue.path[-1:]} - own) for issue in error.issues)
    issues = zip(error.issues, elsewhere, strict=True)
    return ProblemError([replace(issue, message=issue.message + at) if there else issue for issue, there in issues])
