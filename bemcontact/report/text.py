"""Text in the terminal on a problem, its results and comparisons.

The functions return a renderable for `rich`, no wider than 100 columns where the names are not. All text of a user goes
into them as plain text, never as markup.
"""

from pathlib import Path

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from bemcontact.analysis.check import CheckedProblem
from bemcontact.analysis.mesh_study import MeshLevel, MeshStudy
from bemcontact.analysis.result import Result
from bemcontact.assessment.certificate import CertificateKind
from bemcontact.assessment.comparison import Comparison
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.parametric.parameter_path import ParameterPath, PathState
from bemcontact.problem import DeflectedContour, Problem, Units
from bemcontact.report.bars import with_bar
from bemcontact.report.facts import facts, scores_in_words
from bemcontact.report.formatting import (
    case_in_words,
    convexity_in_words,
    deflected_by,
    held_by,
    number,
    plural,
    prescribed,
    reference_in_words,
    search_in_words,
    seconds_in_words,
    surface_in_words,
    tool_in_words,
    units_of,
    vector,
    volume_loads,
    with_unit,
    zero_if_negligible,
)
from bemcontact.report.verdicts import (
    Verdict,
    mesh_study_verdicts,
    path_verdicts,
    result_verdicts,
)

MANY = 4
"""Number of points up to which those that enter or leave together are named."""


def problem_summary(checked: CheckedProblem) -> RenderableType:
    """List edges, zones, mesh, loads, supports and notes of a problem."""
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
    if problem.adapts:
        asked = f"{100 * (problem.asked_accuracy or 0):.3g} %"
        add(shown, "Accuracy", f"{asked}; this mesh is only the first one, solve and compare find a better one")
    for load in volume_loads(problem):
        add(shown, "Volume load", load)
    for name, zone in problem.contact_zones.items():
        if isinstance(zone.surface, DeflectedContour):
            add(shown, "Contour", f"of {name}, deflected by {deflected_by(zone.surface, problem)}")
    for name, tool in problem.tools.items():
        action = tool_in_words(problem.tool_action(name), units)
        add(shown, "Tool", f"{name}, the surface of {' and '.join(tool.zones)}: {action}")
    total = vector(checked.total_load, units.line_force, scale=checked.load_magnitude)
    without = " and tools" if problem.tools else ""
    add(shown, "Total load", f"{total}, without reactions{without}")
    held = {0: "all rigid motions", 3: "no rigid motion"}
    add(shown, "Held by conditions", held.get(checked.free_motions, "all rigid motions except those below"))
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


def _edge_table(problem: Problem) -> Table:
    """List the edges, loop by loop."""
    table = table_of("edge", "kind", "length", "elements", "condition")
    boundary = problem.boundary
    for number_of_loop, (stated, loop) in enumerate(zip(boundary.loop_specs, boundary.loops, strict=True)):
        if number_of_loop:
            table.add_row(Text(f"hole {number_of_loop}", "italic"))
        for shape, edge in zip(stated, loop, strict=True):
            length = with_unit(number(edge.length), problem.units.length)
            elements = f"{len(edge.breakpoints(problem.mesh.refine)) - 1}"
            condition = ", ".join(prescribed(problem, edge)) or "free"
            table.add_row(*map(Text, (edge.name, shape.kind, length, elements, condition)))
    return table


def _zone_table(checked: CheckedProblem) -> Table:
    """List the contact zones."""
    table = table_of("contact zone", "edges", "points", "smallest gap", "rigid surface")
    for name, zone in checked.problem.contact_zones.items():
        gap = checked.gaps[name]
        least = zero_if_negligible(checked.smallest_gaps[name], checked.problem.boundary.size)
        smallest = with_unit(number(least), checked.problem.units.length)
        edges, surface = ", ".join(checked.problem.edges_of(name)), surface_in_words(zone.surface)
        table.add_row(*map(Text, (name, edges, f"{len(gap)}", smallest, surface)))
    return table


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


RIGHT = frozenset({
    "length", "elements", "points", "objective", "unpolished", "difference", "iterations", "seconds", "computed",
    "expected", "allowed", "in contact",
})  # fmt: skip
"""Columns of numbers."""


CONTENDERS = (
    "objective: 0 at the contact state. difference: of the pressure from the direct solution, over the peak; "
    "unpolished: the same before the last exact step."
)
CURVATURE = (
    "Numbers of positive, zero and negative eigenvalues: of the whole Hessian, and reduced to what may change where "
    "the search starts and where it ends. convex in equilibrium: where forces balance, each minimum is the least of "
    "all; μ is the penalty of QP2."
)
"""What the columns of the tables of a comparison mean, below them."""


def list_of_facts() -> Table:
    """Make a list of facts: name and value."""
    facts = Table.grid(padding=(0, 2))
    facts.add_column(no_wrap=True)
    facts.add_column(overflow="fold", max_width=76)
    return facts


def add(facts: Table, name: str, value: str) -> None:
    """Add a fact to a list."""
    facts.add_row(Text(name, "cyan"), Text(value))


def add_verdict(facts: Table, verdict: Verdict) -> None:
    """Add a verdict to a list: in a word, and in sentences."""
    facts.add_row(Text(verdict.of, "bold"), verdict_text(verdict))


def verdict_text(verdict: Verdict) -> Text:
    """Write a verdict: green, amber or red."""
    style = {"good": "bold green", "fair": "bold yellow", "bad": "bold red"}[verdict.quality]
    return Text.assemble((verdict.word, style), ". ", verdict.words)


def table_of(*columns: str, right: frozenset[str] = RIGHT) -> Table:
    """Make a table with these columns, those of numbers at the right."""
    table = Table(box=None, padding=(0, 2, 0, 0), header_style="cyan", pad_edge=False)
    for column in columns:
        numbers = column in right
        table.add_column(column, justify="right" if numbers else "left", no_wrap=numbers, overflow="fold")
    return table


def mesh_study_summary(study: MeshStudy) -> RenderableType:
    """List each formulation's verdict on the finest mesh, and how the answer changes from mesh to mesh."""
    level = study.finest
    compared, answer = level.comparison, level.answer
    shown = list_of_facts()
    for name, value in facts(answer.to_dict(), units_of(answer.contact)):
        add(shown, name, value)
    for name, remark in {item.name: item.remark for item in level.expected if item.remark}.items():
        add(shown, name, remark)
    for contender in compared.everyone:
        if not contender.certified:
            add(shown, contender.label, contender.verdict.words)
    reasons = (item.verdict.reason for item in compared.contenders if item.verdict.reason)
    for reason in dict.fromkeys(reasons):
        add(shown, "Reason", reason)
    if study.convergence is not None and study.convergence.remark:
        add(shown, "Meshes", study.convergence.remark)
    for note in answer.notes:
        add(shown, "Note", note)
    for verdict in mesh_study_verdicts(study.to_dict()):
        add_verdict(shown, verdict)
    tables = {
        _contender_table(compared): CONTENDERS,
        _curvature_table(compared): CURVATURE,
        _score_table(level, units_of(answer.contact)): "",
        _mesh_table(study): "",
    }
    shown_tables = ((table, words) for table, words in tables.items() if table.row_count)
    parts = [part for table, words in shown_tables for part in (table, *([Text(words, "dim")] * bool(words)), "")]
    return Group(Text(study.name, "bold"), Text(_compared_how(study), "dim"), "", *parts, shown)


def _contender_table(compared: Comparison) -> Table:
    """List the formulations, the direct solution last."""
    searched = any(item.attempt.starts for item in compared.contenders)
    table = table_of(
        "", "verdict", "objective", "unpolished", "difference", "iterations", "seconds", *["starts"] * searched
    )
    for item in compared.everyone:
        difference = compared.difference(item.label)
        solution, starts = item.solution, item.attempt.starts
        cells = [
            item.label,
            item.verdict.outcome,
            "" if item.objective is None else f"{item.objective:.0e}",
            "" if difference is None else f"{difference.unpolished:.0e}",
            "" if difference is None else f"{difference.largest:.0e}",
            "" if solution is None else f"{solution.iterations}",
            "" if solution is None else f"{item.attempt.seconds:.3f}",
        ]
        if searched:
            cells.append("" if starts is None else f"{starts.solved} of {starts.count}")
        table.add_row(*map(Text, cells), style="" if item.certified else "red")
    return table


def _curvature_table(compared: Comparison) -> Table:
    """List how many eigenvalues are positive, zero and negative where a local solver searched."""
    table = table_of("eigenvalues", "whole Hessian", "reduced, start", "reduced, end", "convex in equilibrium")
    for item in compared.contenders:
        search = item.solution.search if item.solution else None
        if search is None:
            continue
        inertias = (search.inertia, search.reduced_inertia_start, search.reduced_inertia_end)
        written = (" ".join(map(str, inertia)) for inertia in inertias)
        table.add_row(*map(Text, (item.label, *written, convexity_in_words(item))))
    return table


def _score_table(level: MeshLevel, units: Units) -> Table:
    """List the references and the differences from them."""
    table = table_of("reference", "quantity", "computed", "expected", "difference", "")
    scores, references = ([item.to_dict() for item in items] for items in (level.scores, level.expected))
    judged = {"holds": "within", "does not hold": "MORE THAN"}
    for row in scores_in_words(scores, references, units):
        expected = row["expected"].removesuffix(f" {row['unit']}")
        verdict = f"{judged[row['verdict']]} {row['tolerance']}" if row["verdict"] in judged else row["verdict"]
        cells = (row["reference"], row["quantity"], row["computed"], expected, row["difference"], verdict)
        table.add_row(*map(Text, cells), style="red" if row["color"] == "bad" else "")
    return table


def _mesh_table(study: MeshStudy) -> Table:
    """List how the answer changes from mesh to mesh, with the last observed order and what it leads to."""
    convergence = study.convergence
    if convergence is None:
        return table_of("")
    table = table_of("mesh", *(f"refine {parts}" for parts in convergence.refine), "order", "limit")
    units = units_of(study.finest.answer.contact)
    labels = {"p": units.stress, "L": units.length, "1": ""}
    for item in convergence.quantities:
        order = item.orders[-1] if item.orders else None
        unit = labels[item.dimension]
        cells = [f"{item.name}, {unit}" if unit else item.name, *(f"{value:.6g}" for value in item.values)]
        cells += ["" if order is None else f"{order:.1f}", "" if item.limit is None else f"{item.limit:.6g}"]
        table.add_row(*map(Text, cells))
    return table


def _compared_how(study: MeshStudy) -> str:
    """Size and time of a comparison."""
    level = study.finest
    freedom = (
        "" if level.answer.degrees_of_freedom is None else f"{level.answer.degrees_of_freedom} degrees of freedom, "
    )
    took = seconds_in_words(study.seconds)
    return f"compared with the direct solution; {freedom}{level.answer.contact.size} contact points, {took}"
