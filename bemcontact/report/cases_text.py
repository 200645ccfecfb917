"""The table of all load cases for the terminal."""

from collections.abc import Iterator

from rich.console import Group, RenderableType
from rich.text import Text

from bemcontact.analysis.load_cases import CaseResults
from bemcontact.analysis.result import Result
from bemcontact.report.formatting import (
    number,
    per_thickness,
    size_of,
    span,
    units_of,
    vector,
    verdict,
    with_unit,
    zone_forces,
)
from bemcontact.report.tables import add, list_of_facts, table_of


def cases_summary(found: CaseResults) -> RenderableType:
    """Tell of each load case and combination how hard and where the body touches, and whether that is certain.

    Parameters
    ----------
    found : CaseResults

    Returns
    -------
    RenderableType
        For `rich`; no wider than 100 columns where the names are not.
    """
    table, facts = table_of("load case", "verdict", "peak", "at", "resultant", "contact"), list_of_facts()
    for name, result in found.results.items():
        units, peak = units_of(result.contact), result.footprint.peak
        pressed = float(result.contact.weights @ result.solution.pressure)
        force = vector(result.footprint.resultant.force, per_thickness(units), scale=pressed)
        cells = [
            name,
            "certified" if result.certified else "NOT certified",
            with_unit(number(peak.pressure), units.stress) if peak else "",
            vector(peak.at, units.length, scale=size_of(result.contact)) if peak else "",
            "\n".join(zone_forces(result)) or force,
            "\n".join(_places(result)) or "nowhere",
        ]
        table.add_row(*map(Text, cells), style="" if result.certified else "red")
    notes = {note: [key for key, item in found.results.items() if note in item.notes] for note in _notes(found)}
    for note, names in notes.items():
        add(facts, "Note", note if len(names) == len(found.results) else f"{', '.join(names)}: {note}")
    if found.worst is not None:
        add(facts, "Largest peak", f"in {found.worst}; pressures are per UNDEFORMED length")
    style, word = ("bold green", "all certified") if found.certified else ("bold red", "NOT all certified")
    facts.add_row(Text("Verdict", "bold"), Text.assemble((word, style), ". ", uncertified(found)))
    return Group(Text(found.name, "bold"), "", table, "", facts)


def uncertified(found: CaseResults) -> str:
    """Say of each case that is not certified why."""
    return " ".join(f"{name}: {verdict(item)}" for name, item in found.results.items() if not item.certified)


def _places(result: Result) -> Iterator[str]:
    """Where the body touches; of several zones along what length alone, so that the table is no wider than a page."""
    contact = result.contact
    for item in result.footprint.intervals:
        length = with_unit(number(item.end_arc - item.start_arc), units_of(contact).length)
        yield f"{item.zone}: {span(contact, item) if len(contact.zone_names) == 1 else length}"


def _notes(found: CaseResults) -> list[str]:
    """All notes, each once."""
    return [*dict.fromkeys(note for result in found.results.values() for note in result.notes)]
