"""Key paths into nested mappings and lists, and raw values of a problem together with their key paths."""

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple, Self, TypeVar

from pydantic import BaseModel, ValidationError

from bemcontact.checks.arguments import text_of_argument
from bemcontact.errors import Issue, KeyPath, ProblemError, dotted
from bemcontact.problems.validation import SpecModel, misspelled
from bemcontact.problems.wording import described, unknown_word

_STEP = re.compile(r"\.([^.\[\]=]+)|\[(\d+)\]")
Part = TypeVar("Part", bound=SpecModel)


def parsed_path(text: str) -> KeyPath:
    """Parse a path such as ``boundary.outer[2].elements``; `ProblemError` if it is none."""
    text_of_argument(text, "a key path")
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


NAMED: Mapping[str | int, str] = {
    "materials": "material",
    "bodies": "body",
    "contacts": "contact",
    "bonded": "bond",
    "contact_zones": "contact zone",
    "tools": "tool",
    "load_cases": "load case",
    "combinations": "combination",
    "reference": "reference",
    "variants": "variant",
}
"""Keys of a problem whose entries have names of the user's choice, and what an entry is called."""

OR_ITS_ENTRY = "force"
"""Key of a list that may be written as its only entry."""


def existing_path(data: Any, path: KeyPath) -> KeyPath:
    """Follow a path through the data of a problem, and replace names of list entries by their positions.

    A key of the only entry of a list leads to it, for a list of one may be written as its entry; then [0] leads to the
    entry. Keys that are not stated are kept, for they may have defaults. `ProblemError` if the path leads into a value
    without entries, or to an entry that a list or one of the `NAMED` mappings does not have.
    """
    whole: Any = data
    followed: KeyPath = ()
    for step in path:
        _ensure_named(data, step, followed)
        _ensure_own(data, step, followed, path)
        if followed[-1:] == (OR_ITS_ENTRY,):
            data = data or None
            if step == 0 and (data is None or isinstance(data, Mapping)):
                continue
        if isinstance(data, list | tuple):
            if len(data) == 1 and isinstance(data[0], Mapping) and step in data[0] and "name" not in data[0]:
                followed, data = (*followed, 0), data[0].get(step)
            else:
                step = _position(data, step, followed)
                data = data[step]
        elif isinstance(step, str) and (data is None or isinstance(data, Mapping)):
            data = (data or {}).get(step)
        else:
            message = _no_entry(whole, path, followed, data)
            raise ProblemError(Issue(path=followed, message=message))
        followed = (*followed, step)
    return followed


def _no_entry(whole: Any, path: KeyPath, followed: KeyPath, data: Any) -> str:
    """Say that a value has no entries; that of a material which a body names is among the materials."""
    if followed[:1] == ("bodies",) and followed[2:] == ("material",) and isinstance(data, str):
        shared = dotted(("materials", data, *path[3:]))
        others = [name for name, body in whole["bodies"].items() if name != followed[1] and body["material"] == data]
        too = f", which changes that of {', '.join(map(repr, others))} too" if others else ""
        return f"it is the name of a material; write {shared}{too}"
    step = path[len(followed)]
    return f"it has no entry {dotted((step,))}, because it is {described(data)}; give the path of a value"


def _ensure_named(data: Any, step: str | int, path: KeyPath) -> None:
    """Refuse a name that one of the `NAMED` mappings does not have: a misspelled name would add an entry."""
    if len(path) == 1 and path[0] in NAMED and (data is None or isinstance(data, Mapping)) and step not in (data or {}):
        what = NAMED[path[0]]
        message = f"a change adds no {what}: {unknown_word(what, str(step), data or {})}"
        raise ProblemError(Issue(path=path, message=message))


def _ensure_own(data: Any, step: str | int, followed: KeyPath, path: KeyPath) -> None:
    """Refuse what a copy has from its original."""
    copied = isinstance(data, Mapping) and step in ("material", "boundary") and data.get("copy_of")
    if copied and followed[:1] == ("bodies",) and len(followed) == 2:
        its = dotted(("bodies", copied, *path[2:]))
        message = f"'{followed[1]}' is a copy of '{copied}' and has its {step}; write {its}, which changes both"
        raise ProblemError(Issue(path=followed, message=message))


def _position(data: list[Any] | tuple[Any, ...], step: str | int, path: KeyPath) -> int:
    """Position in a list of the entry with a number or a name."""
    if isinstance(step, int):
        if step < len(data):
            return step
        message = f"there is no entry [{step}], the list has {len(data)}; count from 0"
        raise ProblemError(Issue(path=path, message=message))
    names = _entry_names(data)
    if step in names:
        return names.index(step)
    known = [name for name in names if isinstance(name, str)]
    position = f"[{step}]" if step.isdecimal() else f"[0].{step}"
    message = (
        unknown_word("entry", step, known)
        if known
        else f"a list has positions, not keys; write {position} instead of {step!r}"
    )
    raise ProblemError(Issue(path=path, message=message))


def _entry_names(data: Sequence[Any]) -> list[Any]:
    """Names of the entries of a list, None without one; a fillet without a name has that of the edge it becomes."""
    names = [entry.get("name") if isinstance(entry, Mapping) else None for entry in data]
    following = [*names[1:], *names[:1]]
    return [
        f"{names[i - 1]}-{following[i]}" if name is None and isinstance(entry, Mapping) and "fillet" in entry else name
        for i, (name, entry) in enumerate(zip(names, data, strict=True))
    ]


def with_entry(data: Any, path: KeyPath, value: Any) -> Any:
    """Copy nested data with one entry replaced or added; the path comes from `existing_path`."""
    if not path:
        return value
    step, rest = path[0], path[1:]
    if isinstance(data, list | tuple) and isinstance(step, int):
        return [*data[:step], with_entry(data[step], rest, value), *data[step + 1 :]]
    data = data or {}
    return {**data, step: with_entry(data.get(step), rest, value)}


class RawValue(NamedTuple):
    """A value of a problem before validation, with its key path as the user spelled it.

    One part can then be checked although another one is wrong.
    """

    path: KeyPath
    value: Any

    @property
    def name(self) -> str:
        """Last key of the path."""
        return str(self.path[-1])

    def below(self, model: type[SpecModel], key: str) -> Self:
        """Value under a key of the model, even if the key is misspelled; None if there is no value."""
        if isinstance(self.value, BaseModel):
            return self._replace(path=(*self.path, key), value=getattr(self.value, key, None))
        if not isinstance(self.value, Mapping):
            return self._replace(path=(*self.path, key), value=None)
        spelled = {meant: wrong for wrong, meant in misspelled(model, self.value).items()}.get(key, key)
        return self._replace(path=(*self.path, spelled), value=self.value.get(spelled))

    def each(self) -> Iterator[Self]:
        """Entries of a list or of a mapping; other values have none."""
        match self.value:
            case list() | tuple():
                entries = enumerate(self.value)
            case Mapping():
                entries = self.value.items()
            case _:
                return
        for key, value in entries:
            yield self._replace(path=(*self.path, key), value=value)

    def named(self) -> Iterator[Self]:
        """Entries of a mapping of names; other values have none."""
        return self.each() if isinstance(self.value, Mapping) else iter(())

    def read(self, model: type[Part]) -> Part | None:
        """Validate the value as a part of a problem; None if it is wrong."""
        if isinstance(self.value, model):
            return self.value
        try:
            return model.model_validate(self.value)
        except ValidationError:
            return None
