"""The table of a load path for the terminal."""

from rich.console import Group, RenderableType
from rich.text import Text

from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.parametric.parameter_path import ParameterPath, PathState
from bemcontact.report.formatting import number, plural, sentence_case, units_of, vector
from bemcontact.report.tables import table_of, verdict

MANY = 4
"""Number of points up to which those that enter or leave together are named."""


def path_summary(path: ParameterPath) -> RenderableType:
    """List where points enter and leave contact, and the peak pressure there."""
    units = units_of(path.contact)
    peak = f"peak, {units.stress}" if units.stress else "peak"
    table = table_of("", "enter", "leave", "in contact", peak, "at", right=frozenset({"", "in contact", peak}))
    for state in path.breakpoints:
        table.add_row(*map(Text, _cells(path.contact, state)))
    word = "certified" if path.certified else "NOT certified"
    where = f"{path.key} from {number(path.start)} to {number(path.end)}"
    counts = {"breakpoint": len(path.breakpoints), "pivot": path.pivots}
    how = ", ".join(f"{count} {plural(noun, count)}" for noun, count in counts.items())
    end = verdict(word, path.certified, path_sentence(path))
    return Group(Text(path.contact.name, "bold"), Text(f"{where}; {how}", "dim"), "", table, "", end)


def path_sentence(path: ParameterPath) -> str:
    """Say how far a path can be trusted."""
    first, last = map(number, path.reaches)
    exact = f"Natural residual {path.residual:.0e} at the worst breakpoint."
    if path.certified:
        return f"Every state from {first} to {last} is the contact state, the only one. {exact}"
    return " ".join((*(f"{sentence_case(note)}." for note in path.notes), exact))


def _cells(contact: CondensedContact, state: PathState) -> list[str]:
    """A row: value, what enters, what leaves, how many touch, the peak and where."""
    at = "" if state.at is None else _place(contact, state.at)
    entered, left = (_named(contact, points) for points in (state.entered, state.left))
    return [number(state.value), entered, left, f"{len(state.touching)}", number(state.peak), at]


def _named(contact: CondensedContact, points: tuple[int, ...]) -> str:
    """Name points by their number and place."""
    if len(points) > MANY:
        return f"{len(points)} points"
    return ", ".join(f"{i} at {_place(contact, i)}" for i in points)


def _place(contact: CondensedContact, i: int) -> str:
    """The place of a point."""
    x, y = contact.points[i].tolist()
    return vector((x, y), "", scale=float(abs(contact.points).max()))
