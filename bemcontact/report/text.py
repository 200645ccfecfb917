"""Numbers to words and tables, for people.

The functions that return a renderable are for `rich`; all text of a user goes into them as plain text, never as markup.
"""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from bemcontact.assessment.footprint import ContactInterval
from bemcontact.bem.condense import Body
from bemcontact.contact import CondensedContact
from bemcontact.problem import Circle, Edge, Field, Plane, Polyline, Problem, Units
from bemcontact.result import Result
from bemcontact.solution import LocalSearch, Penalty, Status

NEGLIGIBLE = 1e-9
"""Share of the largest component, or of a scale, below which a component of a vector is written as zero."""


def number(value: float) -> str:
    """Write a number with five figures: 183.33, 2.1e+05."""
    return f"{value:.5g}" if value else "0"


def vector(components: tuple[float, float], unit: str = "", *, scale: float = 0.0) -> str:
    """Write a point or a force: (2.7685, 0.48) cm; what is negligible beside it, or beside the scale, is zero."""
    largest = max(*map(abs, components), scale)
    x, y = (number(value if abs(value) > NEGLIGIBLE * largest else 0.0) for value in components)
    return with_unit(f"({x}, {y})", unit)


def with_unit(text: str, unit: str) -> str:
    """Put the unit, if there is one, behind a number that is not zero."""
    return f"{text} {unit}" if unit and text != "0" else text


def units_of(contact: CondensedContact) -> Units:
    """Read the labels of the units back from a condensed problem."""
    return Units(length=contact.units.get("length", ""), force=contact.units.get("force", ""))


def per_thickness(units: Units) -> str:
    """Label of a force on a body of unit thickness: kN/cm."""
    return f"{units.force}/{units.length}" if units.force and units.length else ""


def field_on(field: Field, edge: Edge, unit: str = "") -> str:
    """Write the value of a field on an edge, or from where to where it goes: 50.625 kN/cm²; 3 … 5 N/mm²."""
    return with_unit(_range(field.at(edge.points(np.linspace(0, 1, 41)))), unit)


def _range(values: NDArray[np.float64]) -> str:
    """Write a value, or from where to where values (k,) go."""
    low, high = float(values.min()), float(values.max())
    return number(low) if np.isclose(low, high) else f"{number(low)} … {number(high)}"


def prescribed(problem: Problem, edge: Edge) -> Iterator[str]:
    """Say what an edge is told: ``u_x = 0``, ``t_y = -3.6 kN/cm²``, ``pressure 3 N/mm²``, ``may touch in foot``."""
    yield from (f"may touch in {name}" for name, zone in problem.contact_zones.items() if edge.name in zone.edges)
    condition = problem.conditions.get(edge.name)
    if condition is None:
        return
    for symbol, fields, unit in (
        ("u", condition.displacement, problem.units.length),
        ("t", condition.traction, problem.units.stress),
    ):
        for axis, field in (("x", fields.x), ("y", fields.y)):
            if field is not None:
                yield f"{symbol}_{axis} = {field_on(field, edge, unit)}"
    if condition.pressure is not None:
        yield f"pressure {field_on(condition.pressure, edge, problem.units.stress)}"


def volume_loads(problem: Problem) -> Iterator[str]:
    """Say what acts on the volume: ``gravity (0, -9.81)``, ``rotation 100 about (0, 0)``."""
    loads = problem.loads
    if loads.gravity:
        yield f"gravity {vector(loads.gravity.acceleration)}"
    if loads.centrifugal:
        yield f"rotation {number(loads.centrifugal.angular_velocity)} about {vector(loads.centrifugal.center)}"
    if loads.temperature:
        points = np.concatenate([edge.polyline() for edge in problem.boundary.edges])
        yield f"temperature change {_range(loads.temperature.change.at(points))}"


def surface_in_words(surface: Plane | Circle | Polyline) -> str:
    """Say what a rigid surface is."""
    match surface:
        case Plane():
            return f"plane through {vector(surface.point)}, normal {vector(surface.unit_normal)}"
        case Circle():
            return f"circle about {vector(surface.center)}, radius {number(surface.radius)}, body {surface.body}"
        case Polyline():
            first, last = vector(surface.points[0]), vector(surface.points[-1])
            return f"polyline of {len(surface.points)} points from {first} to {last}"


def verdict(result: Result) -> str:
    """Say in words whether the answer is proved, and what to do where it is not."""
    ending = "" if result.solution.status is Status.SOLVED else f"The solver: {result.solution.status.value}. "
    return ending + result.certificate.words


def _plural(noun: str, count: int) -> str:
    """The noun as it stands after a number."""
    return noun if count == 1 else f"{noun}s"


def search_in_words(search: LocalSearch, contact: CondensedContact) -> str:
    """Say how a local solver came to its end: from where, in how many iterations, over what curvature."""
    first, second, changes = search.phase_one_iterations, search.phase_two_iterations, search.working_set_changes
    sentences = [
        f"from the {search.start}: {first + second} {_plural('iteration', first + second)} ({first} to a feasible "
        f"point, {second} from there)",
        f"{changes} {_plural('change', changes)} of the working set",
        f"eigenvalues of the whole Hessian: {_inertia(search.inertia)}; on what the working set leaves free: "
        f"{_inertia(search.reduced_inertia_start)} at the feasible point, {_inertia(search.reduced_inertia_end)} at "
        "the end",
    ]
    if search.penalty is not None:
        sentences.append(_penalty(search.penalty, contact))
    return "; ".join(sentences)


def _inertia(inertia: tuple[int, int, int]) -> str:
    """Write how many eigenvalues are positive, zero and negative."""
    kinds = zip(inertia, ("positive", "zero", "negative"), strict=True)
    return ", ".join(f"{count} {kind}" for count, kind in kinds if count) or "none"


def _penalty(penalty: Penalty, contact: CondensedContact) -> str:
    """Write the penalty, and up to which one QP2 is convex, which equilibrium helps it to be."""
    units = units_of(contact)
    pressures = penalty.dimension == "p/L²"
    unit = f"{units.force}/{units.length}⁴" if pressures else f"{units.length}²/{units.force}"
    unit = unit if units.force and units.length else "in the units of the problem"
    told = f"penalty {number(penalty.value)} ({number(penalty.raw)} {unit})"
    kept = " where equilibrium is kept" if contact.free_motions else ""
    if penalty.convexity_limit is None or penalty.convexity_limit_raw is None:
        return f"{told}, convex{kept} for every penalty"
    if penalty.convexity_limit == 0:
        return f"{told}, convex for no penalty"
    return (
        f"{told}, convex{kept} up to {number(penalty.convexity_limit)} ({number(penalty.convexity_limit_raw)} {unit})"
    )


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
    facts = _facts()
    _add(
        facts,
        "Material",
        f"E = {modulus}, Poisson's ratio {number(material.poisson_ratio)}, {material.state.replace('_', ' ')}",
    )
    _add(facts, "Mesh", f"{len(mesh.elements)} elements, {len(mesh.nodes)} nodes, {len(body.points)} contact points")
    _add(facts, "Degrees of freedom", f"{mesh.degrees_of_freedom}")
    for load in volume_loads(problem):
        _add(facts, "Volume load", load)
    _add(facts, "Total load", f"{_total_load(body)}, reactions not counted")
    _add(facts, "Held by conditions", "all rigid motions" if not len(body.motions) else "all but those below")
    for motion in body.seen.describe():
        _add(facts, "Held by contact", motion)
    for note in body.notes:
        _add(facts, "Note", note)
    return Group(Text(problem.name, "bold"), "", _edge_table(problem), "", _zone_table(body), "", facts)


def result_summary(result: Result) -> RenderableType:
    """Tell what was found: where the body touches, how hard, how well the equations hold, and how sure that is.

    Returns
    -------
    RenderableType
        For `rich`; no wider than 100 columns where the names are not.
    """
    contact, found, units = result.contact, result.footprint, units_of(result.contact)
    facts = _facts()
    if not found.intervals:
        _add(facts, "Contact", "nowhere")
    for interval in found.intervals:
        _add(facts, "Contact", f"{interval.zone}: {_span(contact, interval)}")
    if found.peak:
        pressure = with_unit(number(found.peak.pressure), units.stress)
        at = vector(found.peak.at, units.length, scale=_size(contact))
        _add(facts, "Peak pressure", f"{pressure} at {at}; per UNDEFORMED length")
    pressed = float(contact.weights @ np.abs(result.solution.pressure))
    force = vector(found.resultant.force, per_thickness(units), scale=pressed)
    _add(facts, "Resultant", f"{force}, of the rigid surfaces on the body")
    _add(facts, "Residuals", _residuals(result))
    if result.solution.search is not None:
        _add(facts, "Search", search_in_words(result.solution.search, contact))
    if result.starts is not None:
        _add(facts, "Starts", str(result.starts))
    for note in result.notes:
        _add(facts, "Note", note)
    style = "bold green" if result.certified else "bold red"
    word = "certified" if result.certified else "NOT certified"
    facts.add_row(Text("Verdict", "bold"), Text.assemble((word, style), ". ", verdict(result)))
    return Group(Text(result.contact.name, "bold"), Text(_how(result), "dim"), "", facts)


def condensed_summary(condensed: CondensedContact, path: Path) -> RenderableType:
    """Tell what was condensed, and where it was written."""
    facts = _facts()
    _add(facts, "Contact points", f"{condensed.size} in {', '.join(condensed.zone_names)}")
    _add(facts, "Rigid motions", _held(condensed))
    _add(facts, "Written", str(path))
    for note in condensed.notes:
        _add(facts, "Note", note)
    return Group(Text(condensed.name, "bold"), "", facts)


def _facts() -> Table:
    """Make a list of facts: what, and how much."""
    facts = Table.grid(padding=(0, 2))
    facts.add_column(no_wrap=True)
    facts.add_column(overflow="fold", max_width=76)
    return facts


def _add(facts: Table, what: str, how_much: str) -> None:
    facts.add_row(Text(what, "cyan"), Text(how_much))


def _table(*columns: str) -> Table:
    table = Table(box=None, padding=(0, 2, 0, 0), header_style="cyan", pad_edge=False)
    for column in columns:
        table.add_column(column, justify="right" if column in {"length", "elements", "points"} else "left")
    return table


def _edge_table(problem: Problem) -> Table:
    """List the edges, loop by loop."""
    table = _table("edge", "kind", "length", "elements", "condition")
    boundary = problem.boundary
    for number_of_loop, (stated, loop) in enumerate(zip(boundary.stated_loops, boundary.loops, strict=True)):
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
    table = _table("contact zone", "edges", "points", "smallest gap", "rigid surface")
    for index, (name, zone) in enumerate(body.problem.contact_zones.items()):
        gap = body.points.gap[body.points.zone == index]
        smallest = with_unit(number(float(gap.min())), body.problem.units.length)
        edges, surface = ", ".join(zone.edges), surface_in_words(zone.surface)
        table.add_row(*map(Text, (name, edges, f"{len(gap)}", smallest, surface)))
    return table


def _total_load(body: Body) -> str:
    """Write the resultant of the prescribed tractions and of the body forces."""
    x, y = body.forces.sum(axis=(0, 1)) + body.particular.force
    return vector((float(x), float(y)), per_thickness(body.problem.units), scale=body.load_magnitude)


def _size(contact: CondensedContact) -> float:
    """The largest coordinate of a contact point, beside which round-off is written as zero."""
    return float(np.abs(contact.points).max(initial=0.0))


def _span(contact: CondensedContact, interval: ContactInterval) -> str:
    """Say from where to where there is contact: at one point, along a stretch, or all round a closed zone."""
    unit, scale = units_of(contact).length, _size(contact)
    start, end = vector(interval.start, scale=scale), vector(interval.end, unit, scale=scale)
    length = interval.end_arc - interval.start_arc
    if length == 0:
        return f"at the point {end} alone"
    along = with_unit(number(length), unit)
    all_round = (np.isfinite(contact.run_length) & np.isclose(contact.run_length, length)).any()
    return f"all round, {along}" if all_round else f"{start} to {end}, {along} long"


def _held(condensed: CondensedContact) -> str:
    """Say which rigid motions contact alone holds."""
    if not condensed.free_motions:
        return "all held by conditions"
    return f"held by contact alone: {', '.join(condensed.motion_names)}"


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
    return f"{solution.formulation} by {solution.solver}{polished}; {size}, {_time(sum(result.seconds.values()))}"


def _time(seconds: float) -> str:
    """Write seconds with two figures, or all before the point."""
    return f"{seconds:.2g} s" if seconds < 10 else f"{seconds:.0f} s"
