"""Text in the terminal on results.

The functions return a renderable for `rich`, no wider than 100 columns where the names are not. All text of a user goes
into them as plain text, never as markup.
"""

from pathlib import Path

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from bemcontact.analysis.load_cases import CaseResults
from bemcontact.analysis.result import Result
from bemcontact.assessment.certificate import CertificateKind
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.report.bars import mesh_in_short
from bemcontact.report.contact_words import held_by, search_in_words, units_of
from bemcontact.report.facts import contact_intervals, facts, forces_on_bodies, peak_of, peak_place, rotations_of_cases
from bemcontact.report.formatting import seconds_in_words
from bemcontact.report.tables import add, list_of_facts, table_of
from bemcontact.report.verdicts import Verdict, case_verdicts, overall, result_verdicts


def result_summary(result: Result) -> RenderableType:
    """List the facts of a result and its certificate."""
    solution, shown = result.solution, list_of_facts()
    solved = result.certificate.kind is not CertificateKind.NOT_A_SOLUTION
    for verdict in () if solved else result_verdicts(result):
        add_verdict(shown, verdict)
    for name, value in facts(result.to_dict(), units_of(result.contact)):
        if solved or name == "Residuals":  # where the solver stopped there is no contact
            add(shown, name, value)
    if solution.search is not None:
        add(shown, "Search", search_in_words(solution.search, result.contact))
    if result.starts is not None:
        add(shown, "Starts", str(result.starts))
    for note in sorted(result.notes, key=lambda note: note in result.contact.notes):  # doubts of the units last
        add(shown, "Note", note)
    for verdict in result_verdicts(result) if solved else ():
        add_verdict(shown, verdict)
    polished = ", polished" if solution.polished else ""
    freedom = "" if result.degrees_of_freedom is None else f"{result.degrees_of_freedom} degrees of freedom, "
    took = seconds_in_words(sum(result.seconds.values()))
    how = (
        f"{solution.formulation} by {solution.solver}{polished}; {freedom}{result.contact.size} contact points, {took}"
    )
    return Group(Text(result.contact.name, "bold"), Text(how, "dim"), "", shown)


def condensed_summary(contact: CondensedContact, path: Path) -> RenderableType:
    """List what was condensed, and where it was written."""
    shown = list_of_facts()
    add(shown, "Contact points", f"{contact.size} in {', '.join(contact.zone_names)}")
    add(shown, "Rigid motions", held_by(contact))
    add(shown, "Written", str(path))
    for note in contact.notes:
        add(shown, "Note", note)
    return Group(Text(contact.name, "bold"), "", shown)


def cases_summary(cases: CaseResults) -> RenderableType:
    """List certificate and peak of each load case and combination, then force and contact of each zone."""
    several = any(result.sides for result in cases.results.values())
    table, shown = table_of("load case", "equations", "mesh", "peak", "at"), list_of_facts()
    zones = table_of("load case", "zone", "force" if several else "force on the body", "contact")
    for name, result in cases.results.items():
        record, units = result.to_dict(), units_of(result.contact)
        verdicts = result_verdicts(result)
        cells = [
            name,
            verdicts[0].word,
            mesh_in_short(result.accuracy.to_dict()),
            peak_of(record, units) if record["intervals"] else "",
            peak_place(record, units),
        ]
        style = "" if result.holds is not False else {"good": "", "fair": "yellow", "bad": "red"}[overall(verdicts)]
        table.add_row(*map(Text, cells), style=style)
        forces = forces_on_bodies(record, units)
        places = [*contact_intervals(record, units, short=len(forces) > 1)]  # so that lines stay short
        for i, (zone, force) in enumerate(forces.items()):
            touching = "\n".join(place for where, place in places if where == zone) or "nowhere"
            zones.add_row(*map(Text, (name if i == 0 else "", zone, force, touching)), style=style)
    for case, words in rotations_of_cases({name: result.to_dict() for name, result in cases.results.items()}):
        add(shown, "Rotation", f"{case}: {words}" if case else words)
    for note in dict.fromkeys(note for result in cases.results.values() for note in result.notes):
        names = [name for name, result in cases.results.items() if note in result.notes]
        add(shown, "Note", note if len(names) == len(cases.results) else f"{', '.join(names)}: {note}")
    if cases.worst is not None:
        add(shown, "Largest peak", f"in {cases.worst}; pressures are per UNDEFORMED length")
    if cases.infinite:
        add(shown, "Largest peak", f"infinite in {', '.join(repr(name) for name in cases.infinite)}")
    for verdict in case_verdicts(cases):
        add_verdict(shown, verdict)
    return Group(Text(cases.name, "bold"), "", table, "", zones, "", shown)


def add_verdict(facts: Table, verdict: Verdict) -> None:
    """Add a verdict to a list: in a word, and in sentences."""
    facts.add_row(Text(verdict.of, "bold"), verdict_text(verdict))


def verdict_text(verdict: Verdict) -> Text:
    """Write a verdict: green, amber or red."""
    style = {"good": "bold green", "fair": "bold yellow", "bad": "bold red"}[verdict.quality]
    return Text.assemble((verdict.word, style), ". ", verdict.words)
