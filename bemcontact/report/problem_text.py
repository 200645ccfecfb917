"""Text in the terminal on a problem before it is solved; see `bemcontact.report.text`."""

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from bemcontact.analysis.check import CheckedProblem
from bemcontact.problems import DeflectedContour
from bemcontact.report.formatting import (
    case_in_words,
    deflected_by,
    materials_in_words,
    number,
    plural,
    prescribed,
    reference_in_words,
    surface_in_words,
    tool_in_words,
    vector,
    volume_loads,
    with_unit,
    zero_if_negligible,
)
from bemcontact.report.tables import add, list_of_facts, table_of


def problem_summary(checked: CheckedProblem) -> RenderableType:
    """List edges, zones, mesh, loads, supports and notes of a problem."""
    problem, mesh = checked.problem, checked.mesh
    units, shown = problem.units, list_of_facts()
    for line in materials_in_words(problem):
        add(shown, "Material", line)
    points = sum(map(len, checked.gaps.values()))
    add(shown, "Mesh", f"{len(mesh.elements)} elements, {len(mesh.nodes)} nodes, {points} contact points")
    add(shown, "Degrees of freedom", f"{mesh.degrees_of_freedom}")
    if problem.adapts:
        asked = f"{100 * (problem.asked_accuracy or 0):.3g} %"
        add(shown, "Accuracy", f"{asked}; this mesh is only the first one, solve and compare find a better one")
    for load in volume_loads(problem):
        add(shown, "Volume load", load)
    for name, zone in problem.zones.items():
        if isinstance(zone.surface, DeflectedContour):
            add(shown, "Contour", f"of {name}, deflected by {deflected_by(name, zone.surface, problem)}")
    for name, tool in problem.tools.items():
        action = tool_in_words(problem.tool_action(name), units)
        add(shown, "Tool", f"{name}, the surface of {' and '.join(tool.zones)}: {action}")
    total = vector(checked.total_load, units.line_force, scale=checked.load_magnitude)
    without = " and tools" if problem.tools else ""
    add(shown, "Total load", f"{total}, without reactions{without}")
    held = {0: "all rigid motions", 3 * len(problem.parts): "no rigid motion"}
    add(shown, "Held by conditions", held.get(checked.free_motions, "all rigid motions except those below"))
    if bonded := checked.held_by_bonds:
        add(shown, "Held by bonds", f"{bonded} {plural('rigid motion', bonded)} of bonded bodies")
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
    return Group(Text(problem.title, "bold"), "", _edge_table(checked), "", _zone_table(checked), "", shown)


def _edge_table(checked: CheckedProblem) -> Table:
    """List the edges, loop by loop."""
    problem, mesh = checked.problem, checked.mesh
    table = table_of("edge", "kind", "length", "elements", "condition")
    loops = [
        (part.name, number_of_loop, *loop)
        for part in problem.parts
        for number_of_loop, loop in enumerate(zip(part.boundary.loop_specs, part.loops, strict=True))
    ]
    for body, number_of_loop, stated, loop in loops:
        if number_of_loop:
            table.add_row(Text(f"hole {number_of_loop}{f' of {body}' * bool(body)}", "italic"))
        for shape, edge in zip(stated, loop, strict=True):
            length = with_unit(number(edge.length), problem.units.length)
            elements = f"{len(mesh.ends_on(edge.name)) - 1}"
            condition = ", ".join(prescribed(problem, edge)) or "free"
            table.add_row(*map(Text, (edge.name, shape.kind, length, elements, condition)))
    return table


def _zone_table(checked: CheckedProblem) -> Table:
    """List the contact zones."""
    what = "surface" if checked.problem.several else "rigid surface"
    table = table_of("contact zone", "edges", "points", "smallest gap", what)
    for name, zone in checked.problem.zones.items():
        gap = checked.gaps[name]
        least = zero_if_negligible(checked.smallest_gaps[name], checked.problem.size)
        smallest = with_unit(number(least), checked.problem.units.length)
        edges, surface = ", ".join(checked.problem.edges_of(name)), surface_in_words(zone.surface)
        table.add_row(*map(Text, (name, edges, f"{len(gap)}", smallest, surface)))
    return table
