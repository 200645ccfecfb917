"""Text in the terminal on all load cases, and on formulations that are compared under them."""

from collections.abc import Iterator

from rich.console import Group, RenderableType
from rich.text import Text

from bemcontact.analysis.case_comparisons import CaseComparisons
from bemcontact.analysis.load_cases import CaseResults
from bemcontact.report.bars import mesh_in_short
from bemcontact.report.facts import contact_intervals, peak_of, peak_place, zone_forces
from bemcontact.report.formatting import units_of
from bemcontact.report.text import add, add_verdict, list_of_facts, table_of
from bemcontact.report.verdicts import case_verdicts, overall, result_verdicts

DIFFERENCE = "difference: of the pressures from the direct solution, over the largest"
"""What a column of the table of comparisons means."""


def cases_summary(cases: CaseResults) -> RenderableType:
    """List certificate and peak of each load case and combination, then force and contact of each zone."""
    return Group(*_parts(cases))


def case_comparisons_summary(comparisons: CaseComparisons) -> RenderableType:
    """List the verdict on each formulation under each load case, then the direct solutions of all."""
    labels = [item.label for item in next(iter(comparisons.levels.values())).comparison.contenders]
    table = table_of("load case", *labels, "difference", right=frozenset({"difference"}))
    for name, level in comparisons.levels.items():
        compared = level.comparison
        outcomes = [item.verdict.outcome for item in compared.contenders]
        apart = "" if compared.agreement is None else f"{compared.agreement:.0e}"
        table.add_row(*map(Text, (name, *outcomes, apart)), style="" if level.certified else "red")
    title, *parts = _parts(comparisons.answers)
    return Group(title, "", table, Text(DIFFERENCE, "dim"), *parts)


def _parts(cases: CaseResults) -> Iterator[RenderableType]:
    """Title, tables and facts of all load cases."""
    table, shown = table_of("load case", "equations", "mesh", "peak", "at"), list_of_facts()
    zones = table_of("load case", "zone", "force on the body", "contact")
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
        forces = zone_forces(record, units)
        places = [*contact_intervals(record, units, short=len(forces) > 1)]  # so that lines stay short
        for i, (zone, force) in enumerate(forces.items()):
            touching = "\n".join(place for where, place in places if where == zone) or "nowhere"
            zones.add_row(*map(Text, (name if i == 0 else "", zone, force, touching)), style=style)
    for note in dict.fromkeys(note for result in cases.results.values() for note in result.notes):
        names = [name for name, result in cases.results.items() if note in result.notes]
        add(shown, "Note", note if len(names) == len(cases.results) else f"{', '.join(names)}: {note}")
    if cases.worst is not None:
        add(shown, "Largest peak", f"in {cases.worst}; pressures are per UNDEFORMED length")
    if cases.infinite:
        add(shown, "Largest peak", f"infinite in {', '.join(repr(name) for name in cases.infinite)}")
    for verdict in case_verdicts(cases):
        add_verdict(shown, verdict)
    yield from (Text(cases.name, "bold"), "", table, "", zones, "", shown)
