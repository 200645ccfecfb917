"""Plain data as it was written, and the place in the text, or the override, that each value comes from."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from bemcontact.errors import Issue, KeyPath
from bemcontact.problem.key_path import with_entry
from bemcontact.problem.validation import KeyIssue


@dataclass(frozen=True, order=True)
class Mark:
    """A place in a text, or an override; `text` begins the issue."""

    line: int
    column: int
    text: str


LocatedMessage = tuple[Mark, str]
"""What was found wrong, and where."""


@dataclass(frozen=True, kw_only=True)
class Place:
    """Where an issue about a value points to, and where one about its key does."""

    value: Mark
    key: Mark
    scalar: bool


@dataclass(frozen=True, kw_only=True)
class Document:
    """Plain data with the place of each value by its path.

    Parameters
    ----------
    data : nested mappings and lists
    places : place of each value
    messages : what was found wrong while reading
    change : the override that made it from another document, if one did
    """

    data: Any
    places: Mapping[KeyPath, Place]
    messages: tuple[LocatedMessage, ...] = ()
    change: Mark | None = None

    def below(self, path: KeyPath) -> "Document":
        """Take the value at a path as a document of its own."""
        data = self.data
        for key in path:
            data = data[key]
        places = {other[len(path) :]: place for other, place in self.places.items() if other[: len(path)] == path}
        return Document(data=data, places=places)

    def changed(self, path: KeyPath, entry: "Document", mark: Mark) -> "Document":
        """Replace or add one value, all of which comes from the place of the mark."""
        kept = {other: place for other, place in self.places.items() if other[: len(path)] != path}
        added = {
            (*path, *below): Place(value=mark, key=mark, scalar=place.scalar) for below, place in entry.places.items()
        }
        return Document(
            data=with_entry(self.data, path, entry.data),
            places={**kept, **added},
            messages=(*self.messages, *((mark, message) for _, message in entry.messages)),
            change=mark,
        )

    def located(self, issue: Issue) -> LocatedMessage:
        """Find the place of an issue, or of the nearest thing above that stands in the text."""
        path = issue.path
        while path not in self.places:
            path = path[:-1]
        place = self.places[path]
        if place.scalar:  # its entries exist in the model only: a number as a field, a name as a list of one
            issue = replace(issue, path=path)
        is_key = isinstance(issue, KeyIssue) and path == issue.path
        return (place.key if is_key else place.value), str(issue)


def error_text(messages: Iterable[LocatedMessage]) -> str:
    """Write messages in the order of the text, a line each."""
    return "\n".join(f"{mark.text}: {message}" for mark, message in sorted(messages))
