"""The table of a load path for the terminal."""

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.parametric.parameter_path import ParameterPath, PathState
from bemcontact.report.formatting import number, plural, sentence_case, units_of, vector

MANY = 4
"""Points that are named where they enter or leave together; of more the number is told."""
COLUMNS = ("", "enter", "leave", "in contact", "peak", "at")


def path_summary(found: ParameterPath) -> RenderableType:
    """Tell where points enter and leave contact, and how the peak pressure goes.

    Parameters
    ----------
    found : ParameterPath

    Returns
    -------
    RenderableType
        For `rich`; no wider than 100 columns where the names are not.
    """
    units = units_of(found.contact)
    table = Table(box=None, padding=(0, 2, 0, 0), header_style="cyan", pad_edge=False)
    for name in COLUMNS:
        numbers = name in ("", "in contact", "peak")
        title = f"peak, {units.stress}" if name == "peak" and units.stress else name
        table.add_column(title, justify="right" if numbers else "left", no_wrap=numbers, overflow="fold")
    for state in found.breakpoints:
        table.add_row(*map(Text, _cells(found.contact, state)))
    style = "bold green" if found.certified else "bold red"
    word = "certified" if found.certified else "NOT certified"
    where = f"{found.key} from {number(found.start)} to {number(found.end)}"
    counts = {"breakpoint": len(found.breakpoints), "pivot": found.path.pivots}
    how = ", ".join(f"{count} {plural(noun, count)}" for noun, count in counts.items())
    end = Text.assemble((word, style), ". ", verdict(found))
    return Group(Text(found.contact.name, "bold"), Text(f"{where}; {how}", "dim"), "", table, "", end)


def verdict(found: ParameterPath) -> str:
    """Say in a sentence or two how far the path can be trusted."""
    first, last = map(number, found.reaches)
    exact = f"Natural residual {found.path.residual:.0e} at the worst breakpoint."
    if found.certified:
        return f"Every state from {first} to {last} is the contact state, the only one. {exact}"
    return " ".join((*(f"{sentence_case(note)}." for note in found.notes), exact))


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
