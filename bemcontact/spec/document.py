"""Data of a spec, with the place in the text, or the override, of each value."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from bemcontact.errors import Issue, KeyPath
from bemcontact.frozen import frozen_value
from bemcontact.problems.key_path import with_entry
from bemcontact.problems.validation import KeyIssue

MOST_LINES = 100
"""Largest number of mistakes that are shown."""


@dataclass(frozen=True, order=True)
class Mark:
    """A place in a text, or an override; `text` is the start of the error message."""

    line: int
    column: int
    text: str


LocatedMessage = tuple[Mark, str]
"""An error message and its place."""


@frozen_value
class Place:
    """Places of a value and of its key; `scalar` tells that the value has no entries in the text."""

    value: Mark
    key: Mark
    scalar: bool


@frozen_value
class Document:
    """Data of a spec with the place of each value.

    Parameters
    ----------
    data : nested mappings and lists
    places : place of each value by its key path
    messages : errors found while reading
    unread : paths of values that could not be read, as a message says
    change : override that made this document from another one, if any
    folder : of the file, in which drawings are
    """

    data: Any
    places: Mapping[KeyPath, Place]
    messages: tuple[LocatedMessage, ...] = ()
    unread: tuple[KeyPath, ...] = ()
    change: Mark | None = None
    folder: Path = Path()

    def below(self, path: KeyPath) -> "Document":
        """Document of the value at a path."""
        data = self.data
        for key in path:
            data = data[key]
        places = {other[len(path) :]: place for other, place in self.places.items() if other[: len(path)] == path}
        return Document(data=data, places=places)

    def changed(self, path: KeyPath, entry: "Document", mark: Mark) -> "Document":
        """Copy with one value replaced or added; the place of the new value is the mark."""
        kept = {other: place for other, place in self.places.items() if other[: len(path)] != path}
        added = {
            (*path, *below): Place(value=mark, key=mark, scalar=place.scalar) for below, place in entry.places.items()
        }
        return Document(
            data=with_entry(self.data, path, entry.data),
            places={**kept, **added},
            messages=(*self.messages, *((mark, message) for _, message in entry.messages)),
            unread=(
                *(other for other in self.unread if other[: len(path)] != path),
                *((*path, *below) for below in entry.unread),
            ),
            change=mark,
            folder=self.folder,
        )

    def located(self, issue: Issue) -> LocatedMessage:
        """Place of an issue; if its path is not in the text, the place of the value that contains it."""
        path = issue.path
        while path not in self.places:
            path = path[:-1]
        place = self.places[path]
        if place.scalar:  # the text has no entries: a number is a field, a name is a list of one name
            issue = replace(issue, path=path)
        is_key = isinstance(issue, KeyIssue) and path == issue.path
        return (place.key if is_key else place.value), str(issue)


def error_text(messages: Iterable[LocatedMessage]) -> str:
    """One line for each message, in the order of the text; the last line counts those that are left out."""
    lines = [f"{mark.text}: {message}" for mark, message in sorted(messages)]
    if len(lines) > MOST_LINES:
        lines[MOST_LINES:] = [f"{len(lines) - MOST_LINES} more mistakes; correct those above first"]
    return "\n".join(lines)
