"""The breakpoints of a path in words, for the terminal and for pages."""

from typing import NamedTuple

from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.parametric.parameter_path import ParameterPath, PathState
from bemcontact.report.bars import with_bar
from bemcontact.report.formatting import number, vector

MANY = 4
"""Number of points up to which those that enter or leave together are named."""


class BreakpointWords(NamedTuple):
    """A breakpoint: value, what enters, what leaves, how many points touch, the peak and its place."""

    value: str
    enter: str
    leave: str
    touching: str
    peak: str
    place: str


def breakpoint_words(path: ParameterPath, state: PathState) -> BreakpointWords:
    """Write a breakpoint of a path; a peak whose error is not known has a question mark."""
    contact = path.contact
    unknown = " ± ?" * bool(state.peak and state.bars and state.peak_bar is None)
    return BreakpointWords(
        value=number(state.value),
        enter=_named(contact, state.entered),
        leave=_named(contact, state.left),
        touching=f"{len(state.touching)}",
        peak="infinite" if state.peak is None else with_bar(state.peak, state.peak_bar) + unknown,
        place="" if state.at is None else place_of_point(contact, state.at),
    )


def _named(contact: CondensedContact, points: tuple[int, ...]) -> str:
    """Name points by their number and place."""
    if len(points) > MANY:
        return f"{len(points)} points"
    return ", ".join(f"{i} at {place_of_point(contact, i)}" for i in points)


def place_of_point(contact: CondensedContact, i: int) -> str:
    """The place of a point."""
    x, y = contact.points[i].tolist()
    return vector((x, y), "", scale=float(abs(contact.points).max()))
