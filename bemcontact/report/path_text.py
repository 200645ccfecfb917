"""Text in the terminal on a path; see `bemcontact.report.text`."""

from rich.console import Group, RenderableType
from rich.text import Text

from bemcontact.parametric.parameter_path import ParameterPath
from bemcontact.report.breakpoints import breakpoint_words
from bemcontact.report.contact_words import units_of
from bemcontact.report.formatting import number, plural
from bemcontact.report.path_verdicts import path_verdicts
from bemcontact.report.tables import add, list_of_facts, table_of
from bemcontact.report.text import add_verdict


def path_summary(path: ParameterPath) -> RenderableType:
    """List where points enter and leave contact, and the peak pressure there."""
    units = units_of(path.contact)
    peak = f"peak, {units.stress}" if units.stress else "peak"
    table = table_of("", "enter", "leave", "in contact", peak, "at", right=frozenset({"", "in contact", peak}))
    for state in path.breakpoints:
        table.add_row(*map(Text, breakpoint_words(path, state)))
    where = f"{path.key} from {number(path.start)} to {number(path.end)}"
    counts = {"breakpoint": len(path.breakpoints), "pivot": path.pivots}
    how = ", ".join(f"{count} {plural(noun, count)}" for noun, count in counts.items())
    shown = list_of_facts()
    for note in path.notes if path.certified else ():
        add(shown, "Note", note)
    for verdict in path_verdicts(path):
        add_verdict(shown, verdict)
    return Group(Text(path.contact.name, "bold"), Text(f"{where}; {how}", "dim"), "", table, "", shown)
