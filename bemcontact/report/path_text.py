"""Text in the terminal on a path; see `bemcontact.report.text`."""

from rich.console import Group, RenderableType
from rich.text import Text

from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.parametric.parameter_path import ParameterPath, PathState
from bemcontact.report.bars import with_bar
from bemcontact.report.contact_words import units_of
from bemcontact.report.formatting import number, plural, vector
from bemcontact.report.path_verdicts import path_verdicts
from bemcontact.report.tables import list_of_facts, table_of
from bemcontact.report.text import add_verdict

MANY = 4
"""Number of points up to which those that enter or leave together are named."""


def path_summary(path: ParameterPath) -> RenderableType:
    """List where points enter and leave contact, and the peak pressure there."""
    units = units_of(path.contact)
    peak = f"peak, {units.stress}" if units.stress else "peak"
    table = table_of("", "enter", "leave", "in contact", peak, "at", right=frozenset({"", "in contact", peak}))
    for state in path.breakpoints:
        table.add_row(*map(Text, _cells(path.contact, state)))
    where = f"{path.key} from {number(path.start)} to {number(path.end)}"
    counts = {"breakpoint": len(path.breakpoints), "pivot": path.pivots}
    how = ", ".join(f"{count} {plural(noun, count)}" for noun, count in counts.items())
    shown = list_of_facts()
    for verdict in path_verdicts(path):
        add_verdict(shown, verdict)
    return Group(Text(path.contact.name, "bold"), Text(f"{where}; {how}", "dim"), "", table, "", shown)


def _cells(contact: CondensedContact, state: PathState) -> list[str]:
    """A row: value, what enters, what leaves, how many touch, the peak and where."""
    at = "" if state.at is None else _place(contact, state.at)
    entered, left = (_named(contact, points) for points in (state.entered, state.left))
    unknown = " ± ?" * bool(state.peak and state.bars and state.peak_bar is None)
    peak = "infinite" if state.peak is None else with_bar(state.peak, state.peak_bar) + unknown
    return [number(state.value), entered, left, f"{len(state.touching)}", peak, at]


def _named(contact: CondensedContact, points: tuple[int, ...]) -> str:
    """Name points by their number and place."""
    if len(points) > MANY:
        return f"{len(points)} points"
    return ", ".join(f"{i} at {_place(contact, i)}" for i in points)


def _place(contact: CondensedContact, i: int) -> str:
    """The place of a point."""
    x, y = contact.points[i].tolist()
    return vector((x, y), "", scale=float(abs(contact.points).max()))
