"""Paths of keys into nested mappings and lists: read from text, followed, and used to replace one entry."""

import re
from collections.abc import Mapping
from typing import Any

from bemcontact.errors import Complaint, Path, ProblemError, dotted
from bemcontact.problem.validation import described, unknown_word

_STEP = re.compile(r"\.([^.\[\]=]+)|\[(\d+)\]")


def parsed_path(text: str) -> Path:
    """Read a path such as ``boundary.outer[2].elements``; `ProblemError` if it is none."""
    path: list[str | int] = []
    position = 0
    rest = f".{text}"
    while step := _STEP.match(rest, position):
        path.append(int(step[2]) if step[2] else step[1].strip())
        position = step.end()
    if position < len(rest) or not path or "" in path:
        examples = "material.young_modulus or boundary.outer[0].elements"
        raise ProblemError(f"{text!r} is not a key path; write one such as {examples}")
    return tuple(path)


def existing_path(data: Any, path: Path) -> Path:
    """Follow a path as far as there is something, with names of list entries replaced by their places.

    Parameters
    ----------
    data : nested mappings and lists
    path : keys and places; in a list of mappings, an entry may be meant by its `name`

    Returns
    -------
    tuple of str and int
        Keys of mappings that do not exist yet are kept as they are.

    Raises
    ------
    ProblemError
        If the path leads into something that has no entries, or to a place that a list does not have.
    """
    found: Path = ()
    for step in path:
        if isinstance(data, list | tuple):
            step = _place(data, step, found)
            data = data[step]
        elif isinstance(step, str) and (data is None or isinstance(data, Mapping)):
            data = (data or {}).get(step)
        else:
            message = f"has no entry {dotted((step,))}, it is {described(data)}; give a path to a value"
            raise ProblemError(Complaint(path=found, message=message))
        found = (*found, step)
    return found


def _place(data: list[Any] | tuple[Any, ...], step: str | int, found: Path) -> int:
    """Find the place in a list that a number or a name means."""
    if isinstance(step, int):
        if step < len(data):
            return step
        message = f"there is no entry [{step}], the list has {len(data)}; count from 0"
        raise ProblemError(Complaint(path=found, message=message))
    names = [entry.get("name") if isinstance(entry, Mapping) else None for entry in data]
    if step in names:
        return names.index(step)
    known = [name for name in names if isinstance(name, str)]
    place = step if step.isdecimal() else "0"
    message = (
        unknown_word("entry", step, known) if known else f"a list has places, not keys: write [{place}] for {step!r}"
    )
    raise ProblemError(Complaint(path=found, message=message))


def with_entry(data: Any, path: Path, value: Any) -> Any:
    """Copy nested data with one entry replaced or added; the path is one that `existing_path` returned."""
    if not path:
        return value
    step, rest = path[0], path[1:]
    if isinstance(data, list | tuple) and isinstance(step, int):
        return [*data[:step], with_entry(data[step], rest, value), *data[step + 1 :]]
    data = data or {}
    return {**data, step: with_entry(data.get(step), rest, value)}
