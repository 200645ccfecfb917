"""The table of all load cases for the terminal."""

from rich.console import Group, RenderableType
from rich.text import Text

from bemcontact.load_cases import CaseResults
from bemcontact.report.tables import add, list_of_facts, table_of
from bemcontact.report.words import number, per_thickness, size_of, span, units_of, vector, verdict, with_unit


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
        places = [f"{item.zone}: {span(result.contact, item)}" for item in result.footprint.intervals]
        cells = [
            name,
            "certified" if result.certified else "NOT certified",
            with_unit(number(peak.pressure), units.stress) if peak else "",
            vector(peak.at, units.length, scale=size_of(result.contact)) if peak else "",
            force,
            "\n".join(places) or "nowhere",
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


def _notes(found: CaseResults) -> list[str]:
    """All notes, each once."""
    return [*dict.fromkeys(note for result in found.results.values() for note in result.notes)]
