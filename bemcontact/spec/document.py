"""Plain data as it was written, and the place in the text, or the override, that each value comes from."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from bemcontact.errors import Complaint, Path
from bemcontact.problem.key_path import with_entry
from bemcontact.problem.validation import KeyComplaint


@dataclass(frozen=True, order=True)
class Mark:
    """A place in a text, or an override; `text` begins the complaint."""

    line: int
    column: int
    text: str


Finding = tuple[Mark, str]
"""What was found wrong, and where."""


@dataclass(frozen=True, kw_only=True)
class Place:
    """Where a complaint about a value points to, and where one about its key does."""

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
    findings : what was found wrong while reading
    change : the override that made it from another document, if one did
    """

    data: Any
    places: Mapping[Path, Place]
    findings: tuple[Finding, ...] = ()
    change: Mark | None = None

    def below(self, path: Path) -> "Document":
        """Take the value at a path as a document of its own."""
        data = self.data
        for key in path:
            data = data[key]
        places = {other[len(path) :]: place for other, place in self.places.items() if other[: len(path)] == path}
        return Document(data=data, places=places)

    def changed(self, path: Path, entry: "Document", mark: Mark) -> "Document":
        """Replace or add one value, all of which comes from the place of the mark."""
        kept = {other: place for other, place in self.places.items() if other[: len(path)] != path}
        added = {
            (*path, *below): Place(value=mark, key=mark, scalar=place.scalar) for below, place in entry.places.items()
        }
        return Document(
            data=with_entry(self.data, path, entry.data),
            places={**kept, **added},
            findings=(*self.findings, *((mark, message) for _, message in entry.findings)),
            change=mark,
        )

    def located(self, complaint: Complaint) -> Finding:
        """Find the place of a complaint, or of the nearest thing above that stands in the text."""
        path = complaint.path
        while path not in self.places:
            path = path[:-1]
        place = self.places[path]
        if place.scalar:  # its entries exist in the model only: a number as a field, a name as a list of one
            complaint = replace(complaint, path=path)
        is_key = isinstance(complaint, KeyComplaint) and path == complaint.path
        return (place.key if is_key else place.value), str(complaint)


def one_line_each(findings: Iterable[Finding]) -> str:
    """Write findings in the order of the text, a line each."""
    return "\n".join(f"{mark.text}: {message}" for mark, message in sorted(findings))
