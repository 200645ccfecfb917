"""Tables for the terminal.

The functions return a renderable for `rich`; all text of a user goes into them as plain text, never as markup.
"""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from bemcontact.analysis.result import Result
from bemcontact.analysis.study import MeshLevel, Study
from bemcontact.assessment.comparison import Comparison
from bemcontact.bem.body import Body
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.problem import DeflectedContour, Problem
from bemcontact.report.formatting import (
    case_in_words,
    convexity_in_words,
    deflected_by,
    held_by,
    number,
    per_thickness,
    prescribed,
    reference_in_words,
    search_in_words,
    seconds_in_words,
    sentence_case,
    settled,
    size_of,
    span,
    surface_in_words,
    tool_in_words,
    units_of,
    vector,
    verdict,
    volume_loads,
    with_unit,
    zone_forces,
)
from bemcontact.report.tables import add, list_of_facts, table_of


def problem_summary(body: Body) -> RenderableType:
    """Tell what is seen in a problem: edges, zones, mesh, loads, what holds the body, remarks.

    Parameters
    ----------
    body : the problem on its mesh

    Returns
    -------
    RenderableType
        For `rich`; no wider than 100 columns where the names are not.
    """
    problem, mesh = body.problem, body.mesh
    material, units = problem.material, problem.units
    modulus = with_unit(number(material.young_modulus), units.stress)
    facts = list_of_facts()
    add(
        facts,
        "Material",
        f"E = {modulus}, Poisson's ratio {number(material.poisson_ratio)}, {material.state.replace('_', ' ')}",
    )
    add(facts, "Mesh", f"{len(mesh.elements)} elements, {len(mesh.nodes)} nodes, {len(body.points)} contact points")
    add(facts, "Degrees of freedom", f"{mesh.degrees_of_freedom}")
    if problem.mesh.fit_contact_edges:
        add(facts, "Mesh fit", "solve and compare grade the contact zones towards the ends of contact")
    for load in volume_loads(problem):
        add(facts, "Volume load", load)
    for name, zone in problem.contact_zones.items():
        if isinstance(zone.surface, DeflectedContour):
            add(facts, "Contour", f"of {name}, deflected by {deflected_by(zone.surface, problem)}")
    for name, tool in problem.tools.items():
        action = tool_in_words(problem.tool_action(name), units)
        add(facts, "Tool", f"{name}, the surface of {' and '.join(tool.zones)}: {action}")
    add(facts, "Total load", f"{_total_load(body)}, reactions not counted")
    add(facts, "Held by conditions", "all rigid motions" if not len(body.motions) else "all but those below")
    for motion in body.seen.describe():
        add(facts, "Held by contact", motion)
    for name, case in problem.load_cases.items():
        add(facts, "Load case", f"{name}: {case_in_words(case)}")
    for name, factors in problem.combinations.items():
        add(facts, "Combination", f"{name}: {' + '.join(f'{factor:g} {case}' for case, factor in factors.items())}")
    for name, reference in problem.reference.items():
        add(facts, "Reference", f"{name}: {reference_in_words(reference)}")
    for name, variant in problem.variants.items():
        told = variant.description.strip() or ", ".join(f"{key}={value}" for key, value in variant.set.items())
        add(facts, "Variant", f"{name}: {told}")
    for note in body.notes:
        add(facts, "Note", note)
    return Group(Text(problem.title, "bold"), "", _edge_table(problem), "", _zone_table(body), "", facts)


def result_summary(result: Result) -> RenderableType:
    """Tell what was found: where the body touches, how hard, how well the equations hold, and how sure that is.

    Returns
    -------
    RenderableType
        For `rich`; no wider than 100 columns where the names are not.
    """
    facts = list_of_facts()
    _add_footprint(facts, result)
    _add_tools(facts, result)
    add(facts, "Residuals", _residuals(result))
    if result.solution.search is not None:
        add(facts, "Search", search_in_words(result.solution.search, result.contact))
    if result.starts is not None:
        add(facts, "Starts", str(result.starts))
    for note in result.notes:
        add(facts, "Note", note)
    style = "bold green" if result.certified else "bold red"
    word = "certified" if result.certified else "NOT certified"
    facts.add_row(Text("Verdict", "bold"), Text.assemble((word, style), ". ", verdict(result)))
    return Group(Text(result.contact.name, "bold"), Text(_how(result), "dim"), "", facts)


def condensed_summary(condensed: CondensedContact, path: Path) -> RenderableType:
    """Tell what was condensed, and where it was written."""
    facts = list_of_facts()
    add(facts, "Contact points", f"{condensed.size} in {', '.join(condensed.zone_names)}")
    add(facts, "Rigid motions", held_by(condensed))
    add(facts, "Written", str(path))
    for note in condensed.notes:
        add(facts, "Note", note)
    return Group(Text(condensed.name, "bold"), "", facts)


def study_summary(study: Study) -> RenderableType:
    """Tell what each formulation found on the finest mesh, and how the answer changes from mesh to mesh.

    Parameters
    ----------
    study : Study

    Returns
    -------
    RenderableType
        For `rich`; no wider than 100 columns where the names are not.
    """
    level = study.finest
    compared, answer = level.comparison, level.answer
    facts = list_of_facts()
    _add_footprint(facts, answer)
    add(facts, "Residuals", _residuals(answer))
    for name, remark in {item.name: item.remark for item in level.expected if item.remark}.items():
        add(facts, name, remark)
    for contender in compared.everyone:
        if not contender.certified:
            add(facts, contender.label, contender.verdict.words)
    reasons = (item.verdict.reason for item in compared.contenders if item.verdict.reason)
    for reason in dict.fromkeys(reasons):
        add(facts, "Reason", reason)
    if study.convergence is not None and study.convergence.remark:
        add(facts, "Meshes", study.convergence.remark)
    for note in answer.notes:
        add(facts, "Note", note)
    style = "bold green" if study.certified else "bold red"
    word = "certified" if study.certified else compared.heading
    words = [sentence_case(compared.verdict), *_uncertified_meshes(study)]
    facts.add_row(Text("Verdict", "bold"), Text.assemble((word, style), ". ", " ".join(words)))
    tables = [_contender_table(compared), _curvature_table(compared), _score_table(level), _mesh_table(study)]
    parts = [part for table in tables if table.row_count for part in (table, "")]
    return Group(Text(study.name, "bold"), Text(_compared_how(study), "dim"), "", *parts, facts)


def _uncertified_meshes(study: Study) -> Iterator[str]:
    """Name coarser meshes on which not all is certified."""
    coarser = [f"{level.refine}" for level in study.levels[:-1] if not level.comparison.certified]
    if coarser:
        yield f"On the coarser mesh{'es' * (len(coarser) > 1)} (refine {', '.join(coarser)}) not all is certified."


def _contender_table(compared: Comparison) -> Table:
    """List the formulations, the direct solution last."""
    searched = any(item.found.starts for item in compared.contenders)
    table = table_of(
        "", "verdict", "objective", "unpolished", "off direct", "iterations", "seconds", *["starts"] * searched
    )
    for item in compared.everyone:
        difference = compared.difference(item.label)
        judged, starts = item.judged, item.found.starts
        cells = [
            item.label,
            item.verdict.outcome.value,
            "" if item.objective is None else f"{item.objective:.0e}",
            "" if difference is None else f"{difference.unpolished:.0e}",
            "" if difference is None else f"{difference.largest:.0e}",
            "" if judged is None else f"{judged.solution.iterations}",
            "" if judged is None else f"{item.found.seconds:.3f}",
        ]
        if searched:
            cells.append("" if starts is None else f"{starts.solved} of {starts.count}")
        table.add_row(*map(Text, cells), style="" if item.certified else "red")
    return table


def _curvature_table(compared: Comparison) -> Table:
    """List how many eigenvalues are positive, zero and negative where a local solver searched."""
    table = table_of("eigenvalues + 0 -", "whole Hessian", "free at start", "free at end", "convex in equilibrium")
    for item in compared.contenders:
        search = item.judged.solution.search if item.judged else None
        if search is None:
            continue
        inertias = (search.inertia, search.reduced_inertia_start, search.reduced_inertia_end)
        told = (" ".join(map(str, inertia)) for inertia in inertias)
        table.add_row(*map(Text, (item.label, *told, convexity_in_words(item))))
    return table


def _score_table(level: MeshLevel) -> Table:
    """List what is known of the answer, and how far it is off."""
    table = table_of("reference", "quantity", "found", "expected", "difference", "")
    for item in level.scores:
        allowed = f"{100 * item.tolerance:.2g}%"
        holds = f"within {allowed}" if item.holds else f"MORE THAN {allowed}"
        cells = [
            item.reference,
            item.quantity,
            "" if item.found is None else number(item.found),
            number(item.expected),
            "" if item.difference is None else f"{round(item.difference, 6) + 0.0:+.2%}",
            holds if item.judged else "not judged",
        ]
        table.add_row(*map(Text, cells), style="red" if item.judged and not item.holds else "")
    return table


def _mesh_table(study: Study) -> Table:
    """List how the answer changes from mesh to mesh, with the last observed order and what it leads to."""
    found = study.convergence
    if found is None:
        return table_of("")
    table = table_of("mesh", *(f"refine {parts}" for parts in found.refine), "order", "limit")
    units = units_of(study.finest.answer.contact)
    labels = {"p": units.stress, "L": units.length, "1": ""}
    for item in found.quantities:
        order = item.orders[-1] if item.orders else None
        unit = labels[item.dimension]
        cells = [f"{item.name}, {unit}" if unit else item.name, *(f"{value:.6g}" for value in item.values)]
        cells += ["" if order is None else f"{order:.1f}", "" if item.limit is None else f"{item.limit:.6g}"]
        table.add_row(*map(Text, cells))
    return table


def _compared_how(study: Study) -> str:
    """Say what was compared, on what."""
    level = study.finest
    freedom = (
        "" if level.answer.degrees_of_freedom is None else f"{level.answer.degrees_of_freedom} degrees of freedom, "
    )
    took = seconds_in_words(study.seconds)
    return f"compared with the direct solution; {freedom}{level.answer.contact.size} contact points, {took}"


def _add_footprint(facts: Table, result: Result) -> None:
    """Add where the body touches, and how hard."""
    contact, found, units = result.contact, result.footprint, units_of(result.contact)
    if not found.intervals:
        add(facts, "Contact", "nowhere")
    for interval in found.intervals:
        add(facts, "Contact", f"{interval.zone}: {span(contact, interval)}")
    if found.peak:
        pressure = with_unit(number(found.peak.pressure), units.stress)
        at = vector(found.peak.at, units.length, scale=size_of(contact))
        add(facts, "Peak pressure", f"{pressure} at {at}; per UNDEFORMED length")
    pressed = float(contact.weights @ np.abs(result.solution.pressure))
    force = vector(found.resultant.force, per_thickness(units), scale=pressed)
    add(facts, "Resultant", f"{force}, of the rigid surfaces on the body")
    for told in zone_forces(result):
        add(facts, "Resultant", f"of {told}")


def _add_tools(facts: Table, result: Result) -> None:
    """Add where the tools are, and what the body presses on them with."""
    contact, units = result.contact, units_of(result.contact)
    size, moves = size_of(contact), contact.scales.displacement
    pressed = float(contact.weights @ np.abs(result.solution.pressure))
    places = contact.tools.displacement(result.solution.rigid_amplitudes)
    forces = contact.tool_reactions(result.solution.pressure)
    each = zip(contact.tools.names, contact.tools.point.tolist(), places, forces, strict=True)
    for name, point, (x, y, turn), (fx, fy, moment) in each:
        turned = settled(turn * size, moves) / (size or 1.0)
        moved = f"moves by {vector((x, y), units.length, scale=moves)}, turns by {turned:.6g}"
        force = vector((fx, fy), per_thickness(units), scale=pressed)
        about = with_unit(f"{settled(moment, pressed * size):.6g}", units.force)
        told = f"{name}: {moved}; the body presses on it with {force}, moment {about} about {vector(point)}"
        add(facts, "Tool", told)


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
            told = ", ".join(prescribed(problem, edge)) or "free"
            table.add_row(*map(Text, (edge.name, shape.kind, length, elements, told)))
    return table


def _zone_table(body: Body) -> Table:
    """List the contact zones."""
    table = table_of("contact zone", "edges", "points", "smallest gap", "rigid surface")
    for index, (name, zone) in enumerate(body.problem.contact_zones.items()):
        gap = body.points.gap[body.points.zone == index]
        smallest = with_unit(number(float(gap.min())), body.problem.units.length)
        edges, surface = ", ".join(zone.edges), surface_in_words(zone.surface)
        table.add_row(*map(Text, (name, edges, f"{len(gap)}", smallest, surface)))
    return table


def _total_load(body: Body) -> str:
    """Write the resultant of the prescribed tractions and of the body forces."""
    x, y = body.acting.resultant(body.mesh)
    return vector(
        (float(x), float(y)), per_thickness(body.problem.units), scale=body.pinned.total(body.factors, body.forces)
    )


def _residuals(result: Result) -> str:
    """List the residuals, each free of units."""
    left = result.residuals
    values = {
        "penetration": left.penetration,
        "tension": left.tension,
        "complementarity": left.complementarity,
        "equilibrium": left.equilibrium,
        "force balance": left.force_balance,
    }
    return ", ".join(f"{name} {value + 0.0:.1e}" for name, value in values.items() if value is not None)


def _how(result: Result) -> str:
    """Say which statement was solved, by what, on what."""
    solution = result.solution
    polished = ", polished" if solution.polished else ""
    freedom = "" if result.degrees_of_freedom is None else f"{result.degrees_of_freedom} degrees of freedom, "
    size = f"{freedom}{result.contact.size} contact points"
    took = seconds_in_words(sum(result.seconds.values()))
    return f"{solution.formulation} by {solution.solver}{polished}; {size}, {took}"
