"""What the terminal shows of a problem and of its results.

The functions return a renderable for `rich`, no wider than 100 columns where the names are not. All text of a user goes
into them as plain text, never as markup.
"""

from collections.abc import Iterator
from pathlib import Path

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from bemcontact.analysis.check import CheckedProblem
from bemcontact.analysis.load_cases import CaseResults
from bemcontact.analysis.result import Result
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.parametric.parameter_path import ParameterPath, PathState
from bemcontact.problem import DeflectedContour, Problem
from bemcontact.report.facts import Record, facts, peak_in_words, pressed_by, size_of, span, zone_forces
from bemcontact.report.formatting import (
    case_in_words,
    certificate_sentence,
    deflected_by,
    held_by,
    number,
    per_thickness,
    plural,
    prescribed,
    reference_in_words,
    search_in_words,
    seconds_in_words,
    sentence_case,
    surface_in_words,
    tool_in_words,
    units_of,
    vector,
    volume_loads,
    with_unit,
)
from bemcontact.report.tables import add, add_verdict, list_of_facts, table_of, verdict_text

MANY = 4
"""Number of points up to which those that enter or leave together are named."""


def problem_summary(checked: CheckedProblem) -> RenderableType:
    """List edges, zones, mesh, loads, what holds the body, and remarks."""
    problem, mesh = checked.problem, checked.mesh
    material, units = problem.material, problem.units
    modulus = with_unit(number(material.young_modulus), units.stress)
    shown = list_of_facts()
    add(
        shown,
        "Material",
        f"E = {modulus}, Poisson's ratio {number(material.poisson_ratio)}, {material.state.replace('_', ' ')}",
    )
    points = sum(map(len, checked.gaps.values()))
    add(shown, "Mesh", f"{len(mesh.elements)} elements, {len(mesh.nodes)} nodes, {points} contact points")
    add(shown, "Degrees of freedom", f"{mesh.degrees_of_freedom}")
    if problem.mesh.fit_contact_edges:
        add(shown, "Mesh fit", "solve and compare grade the contact zones towards the ends of contact")
    for load in volume_loads(problem):
        add(shown, "Volume load", load)
    for name, zone in problem.contact_zones.items():
        if isinstance(zone.surface, DeflectedContour):
            add(shown, "Contour", f"of {name}, deflected by {deflected_by(zone.surface, problem)}")
    for name, tool in problem.tools.items():
        action = tool_in_words(problem.tool_action(name), units)
        add(shown, "Tool", f"{name}, the surface of {' and '.join(tool.zones)}: {action}")
    total = vector(checked.total_load, per_thickness(units), scale=checked.load_magnitude)
    add(shown, "Total load", f"{total}, reactions not counted")
    add(shown, "Held by conditions", "all but those below" if checked.free_motions else "all rigid motions")
    for motion in checked.held_by_contact:
        add(shown, "Held by contact", motion)
    for name, case in problem.load_cases.items():
        add(shown, "Load case", f"{name}: {case_in_words(case)}")
    for name, factors in problem.combinations.items():
        add(shown, "Combination", f"{name}: {' + '.join(f'{factor:g} {case}' for case, factor in factors.items())}")
    for name, reference in problem.reference.items():
        add(shown, "Reference", f"{name}: {reference_in_words(reference)}")
    for name, variant in problem.variants.items():
        changes = ", ".join(f"{key}={value}" for key, value in variant.set.items())
        add(shown, "Variant", f"{name}: {variant.description.strip() or changes}")
    for note in checked.notes:
        add(shown, "Note", note)
    return Group(Text(problem.title, "bold"), "", _edge_table(problem), "", _zone_table(checked), "", shown)


def result_summary(result: Result) -> RenderableType:
    """List the facts of a result, and what is proved of it."""
    solution, shown = result.solution, list_of_facts()
    for name, value in facts(result.to_dict(), units_of(result.contact)):
        add(shown, name, value)
    if solution.search is not None:
        add(shown, "Search", search_in_words(solution.search, result.contact))
    if result.starts is not None:
        add(shown, "Starts", str(result.starts))
    for note in result.notes:
        add(shown, "Note", note)
    word = "certified" if result.certified else "NOT certified"
    add_verdict(shown, word, result.certified, uncertified(result))
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
    """List of each load case and combination how hard and where the body touches, and whether that is certified."""
    table, shown = table_of("load case", "verdict", "peak", "at", "resultant", "contact"), list_of_facts()
    for name, result in cases.results.items():
        record, units = result.to_dict(), units_of(result.contact)
        peak, _, at = (
            ("", "", "")
            if not record["peak"]
            else peak_in_words(record["peak"], size_of(record), units).partition(" at ")
        )
        force = vector(record["resultant"], per_thickness(units), scale=pressed_by(record))
        cells = [
            name,
            "certified" if result.certified else "NOT certified",
            peak,
            at,
            "\n".join(zone_forces(record, units)) or force,
            "\n".join(_places(record, result.contact)) or "nowhere",
        ]
        table.add_row(*map(Text, cells), style="" if result.certified else "red")
    for note in dict.fromkeys(note for result in cases.results.values() for note in result.notes):
        names = [name for name, result in cases.results.items() if note in result.notes]
        add(shown, "Note", note if len(names) == len(cases.results) else f"{', '.join(names)}: {note}")
    if cases.worst is not None:
        add(shown, "Largest peak", f"in {cases.worst}; pressures are per UNDEFORMED length")
    add_verdict(shown, "all certified" if cases.certified else "NOT all certified", cases.certified, uncertified(cases))
    return Group(Text(cases.name, "bold"), "", table, "", shown)


def uncertified(results: Result | CaseResults) -> str:
    """Say of a result, or of each load case, that is not certified why."""
    if isinstance(results, Result):
        return certificate_sentence(results.solution, results.certificate)
    return " ".join(f"{name}: {uncertified(item)}" for name, item in results.results.items() if not item.certified)


def _places(record: Record, contact: CondensedContact) -> Iterator[str]:
    """Where the body touches; of several zones along what length alone, so that the table is no wider than a page."""
    units = units_of(contact)
    for interval in record["intervals"]:
        start, end = interval["arc"]
        alone = len(contact.zone_names) == 1
        length = with_unit(number(end - start), units.length)
        yield f"{interval['zone']}: {span(interval, size_of(record), units) if alone else length}"


def _edge_table(problem: Problem) -> Table:
    """List the edges, loop by loop."""
    table = table_of("edge", "kind", "length", "elements", "condition")
    boundary = problem.boundary
    for number_of_loop, (stated, loop) in enumerate(zip(boundary.loop_specs, boundary.loops, strict=True)):
        if number_of_loop:
            table.add_row(Text(f"hole {number_of_loop}", "italic"))
        for shape, edge in zip(stated, loop, strict=True):
            length = with_unit(number(edge.length), problem.units.length)
            elements = f"{edge.elements * problem.mesh.refine}"
            condition = ", ".join(prescribed(problem, edge)) or "free"
            table.add_row(*map(Text, (edge.name, shape.kind, length, elements, condition)))
    return table


def _zone_table(checked: CheckedProblem) -> Table:
    """List the contact zones."""
    table = table_of("contact zone", "edges", "points", "smallest gap", "rigid surface")
    for name, zone in checked.problem.contact_zones.items():
        gap = checked.gaps[name]
        smallest = with_unit(number(float(gap.min())), checked.problem.units.length)
        edges, surface = ", ".join(zone.edges), surface_in_words(zone.surface)
        table.add_row(*map(Text, (name, edges, f"{len(gap)}", smallest, surface)))
    return table


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
    end = verdict_text(word, path.certified, path_sentence(path))
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
