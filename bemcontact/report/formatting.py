"""Numbers, units and parts of a problem in words, for tables, pictures and pages."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from bemcontact.arrays import Array
from bemcontact.problems import (
    AnySurface,
    BodySurface,
    Circle,
    Condition,
    DeflectedContour,
    Edge,
    Field,
    LoadCase,
    Loads,
    Part,
    Plane,
    Polyline,
    Problem,
    Reference,
    Spline,
    Table,
    ToolAction,
    Units,
    Values,
)
from bemcontact.problems.conditions import Along

JsonObject = Mapping[str, Any]
"""A record as it is written in JSON."""
NEGLIGIBLE = 1e-9
"""Share of the largest component, or of a scale, below which a component of a vector is written as zero."""


def number(value: float, figures: int = 5) -> str:
    """Write a number with five figures, or as many as are asked for: 183.33, 2.1e+05."""
    return f"{value:.{figures}g}" if value else "0"


def zero_if_negligible(value: float, scale: float) -> float:
    """The value, or zero where it is negligible beside the scale."""
    return value if abs(value) > NEGLIGIBLE * scale else 0.0


def vector(components: tuple[float, float], unit: str = "", *, scale: float = 0.0, figures: int = 5) -> str:
    """Write a point or a force: (2.7685, 0.48) cm; what is negligible beside it, or beside the scale, is zero."""
    largest = max(*map(abs, components), scale)
    x, y = (number(zero_if_negligible(value, largest), figures) for value in components)
    return with_unit(f"({x}, {y})", unit)


def with_unit(text: str, unit: str) -> str:
    """Put the unit, if there is one, behind a number that is not zero."""
    return f"{text} {unit}" if unit and text != "0" else text


def field_on(field: Field, edge: Edge, unit: str = "") -> str:
    """Write the value of a field on an edge, or from where to where it goes: 50.625 kN/cm²; 3 … 5 N/mm²."""
    ends = np.array([0.0, *(distance / edge.length for distance, _ in field.along), 1.0]).clip(0, 1)
    fractions = np.linspace(ends[:-1], ends[1:], 41)[:, np.diff(ends) > 0]  # between two steps of a table
    within = np.repeat(fractions[20:21], 41, axis=0)
    along = Along(edge.length * fractions.ravel(), edge.length * within.ravel(), edge.length)
    return with_unit(_range(field.at(edge.points(fractions.ravel()), along)), unit)


def _range(values: Array) -> str:
    """Write a value, or from where to where values (k,) go."""
    low, high = float(values.min()), float(values.max())
    return number(low) if np.isclose(low, high) else f"{number(low)} … {number(high)}"


def prescribed(problem: Problem, edge: Edge) -> Iterator[str]:
    """Conditions of an edge: ``u_x = 0``, ``t_y = -3.6 kN/cm²``, ``pressure 3 N/mm²``, ``may touch in foot``."""
    for name in problem.zones:
        if edge.name in (*problem.edges_of(name), *problem.opposite_edges(name)):
            yield f"may touch in {name}"
    yield from (f"bonded in {name}" for name in problem.bonded if edge.name in problem.bonded_edges(name))
    if edge.name in problem.edge_conditions:
        yield from _conditions(problem.edge_conditions[edge.name], edge, problem.units)
    for case, factor in problem.factors().items():
        if (condition := problem.load_cases[case].conditions.get(edge.name)) is not None:
            yield from (f"{text} ({_acting(case, factor)})" for text in _conditions(condition, edge, problem.units))


def _conditions(condition: Condition, edge: Edge, units: Units) -> Iterator[str]:
    """Values that a condition prescribes on an edge."""
    for symbol, fields, unit in (
        ("u", condition.displacement, units.length),
        ("t", condition.traction, units.stress),
    ):
        for axis, field in (("x", fields.x), ("y", fields.y)):
            if field is not None:
                yield f"{symbol}_{axis} = {field_on(field, edge, unit)}"
    if condition.spring is not None:
        for way in condition.spring.given:
            across = {"normal": "across it", "tangent": "along it"}.get(way, f"along {way}")
            yield f"springs {across} {with_unit(number(getattr(condition.spring, way)), units.foundation)}"
    if condition.pressure is not None:
        yield f"pressure {field_on(condition.pressure, edge, units.stress)}"
    for force in condition.force:
        over = ""
        if force.width is not None:
            middle = np.array([sum(force.part(edge.length)) / 2 / edge.length]).clip(0, 1)
            place = vector(edge.points(middle)[0].tolist(), units.length, scale=edge.length)
            over = f" over {with_unit(number(force.width), units.length)} around {place}"
        yield f"force {vector((force.x, force.y), units.line_force)}{over}"


def materials_in_words(problem: Problem) -> list[str]:
    """Constants of the material of each body, and the plane state: ``E = 2 N/mm², Poisson's ratio 0.3, plane strain``.

    Several bodies have their names before it.
    """
    bodies: dict[str, list[str]] = {}
    for part in problem.parts:
        modulus = with_unit(f"{part.material.young_modulus:.9g}", problem.units.stress)
        state, ratio = part.material.state.replace("_", " "), number(part.material.poisson_ratio)
        bodies.setdefault(f"E = {modulus}, Poisson's ratio {ratio}, {state}", []).append(part.name)
    return [f"{', '.join(names)}: {text}" if problem.several else text for text, names in bodies.items()]


def volume_loads(problem: Problem, *, short: bool = False) -> Iterator[str]:
    """Loads on the volume: ``gravity (0, -9.81), density 2``, ``temperature change 20, expansion 1e-05 (1.5 hot)``.

    Short ones are without density and expansion.
    """
    names = ["", *problem.load_cases]
    for name, each in zip(names, problem.volume_loads, strict=True):
        factor = problem.factors().get(name, 0.0) if name else 1.0
        for part, loads in zip(problem.parts, each, strict=True):
            of = f" on {part.name}" if part.name else ""
            case = f" ({_acting(name, factor)})" if name else ""
            words = (load if short else f"{load}, {constant}" for load, constant in _volume_loads(loads, part))
            yield from (f"{load}{of}{case}" for load in words if factor)


def _acting(case: str, factor: float) -> str:
    """Name a load case with the factor by which it acts, if it is not one."""
    return case if factor == 1 else f"{factor:g} {case}"


def _volume_loads(loads: Loads, part: Part) -> Iterator[tuple[str, str]]:
    """Loads on the volume of a body, and the density or expansion that belongs to each."""
    if loads.gravity:
        yield f"gravity {vector(loads.gravity.acceleration)}", f"density {number(loads.gravity.density)}"
    if loads.centrifugal:
        turning = loads.centrifugal
        speed = f"rotation {number(turning.angular_velocity)} about {vector(turning.center)}"
        yield speed, f"density {number(turning.density)}"
    if loads.temperature:
        points = np.concatenate([edge.polyline() for edge in part.edges])
        change = _range(loads.temperature.change.at(points))
        yield f"temperature change {change}", f"expansion {number(loads.temperature.expansion)}"


def tool_in_words(action: ToolAction, units: Units) -> str:
    """Displacement and loads of a tool: ``displaced by x = 0.1 mm; loaded by y = -10 N/mm``."""
    labels = {"moment": units.line_moment, "rotation": ""}
    ways = (
        ("displaced by", action.displacement, units.length),
        ("loaded by", action.force, units.line_force),
    )
    parts = [
        (
            way,
            [f"{key} = {with_unit(number(value), labels.get(key, unit))}" for key, value in part if value is not None],
        )
        for way, part, unit in ways
    ]
    return "; ".join(f"{way} {', '.join(values)}" for way, values in parts if values)


def case_in_words(case: LoadCase) -> str:
    """Description of a load case, or else the names of what it changes."""
    changed = [*case.conditions, *case.tools, *case.bodies, *(key for key, load in case.loads if load is not None)]
    return case.description.strip() or f"changes {', '.join(changed)}"


def surface_in_words(surface: AnySurface) -> str:
    """Description of the surface that is touched."""
    match surface:
        case BodySurface():
            added = f", gap {number(surface.offset)} added" if surface.offset else ""
            return f"{'' if surface.elastic else 'rigid '}body '{surface.body}'{added}"
        case Plane():
            return f"plane through {vector(surface.point)}, normal {vector(surface.unit_normal)}"
        case Circle():
            return f"circle about {vector(surface.center)}, radius {number(surface.radius)}, body {surface.body}"
        case Polyline() | Spline():
            first, last = vector(surface.points[0]), vector(surface.points[-1])
            return f"{surface.kind} of {len(surface.points)} points from {first} to {last}"
        case DeflectedContour():
            return f"own contour, deflected; gap along {vector(surface.unit_direction)}"


def zone_surfaces(problem: Problem) -> list[tuple[str, str, str]]:
    """Name, edges and surface of each contact zone."""
    zones = problem.zones.items()
    return [(name, ", ".join(problem.edges_of(name)), surface_in_words(zone.surface)) for name, zone in zones]


def deflected_by(zone: str, surface: DeflectedContour, problem: Problem) -> str:
    """Conditions and loads that deflect the contour of a zone: ``top t_y = -50 kN/cm²``."""
    conditions = [
        f"{name} {', '.join(_conditions(condition, problem.edge(name), problem.units))}"
        for name, condition in surface.conditions.items()
    ]
    loads = map(", ".join, _volume_loads(surface.loads, problem.touching_parts(zone)[0]))
    return "; ".join([*conditions, *loads])


def load_cases_in_words(problem: Problem) -> Iterator[str]:
    """What each load case adds, and what each combination is, in a sentence."""
    for (name, case), each in zip(problem.load_cases.items(), problem.volume_loads[1:], strict=True):
        added = [
            f"{edge} {', '.join(_conditions(condition, problem.edge(edge), problem.units))}"
            for edge, condition in case.conditions.items()
        ]
        for part, loads in zip(problem.parts, each, strict=True):
            of = f" on {part.name}" if part.name else ""
            added += [f"{', '.join(words)}{of}" for words in _volume_loads(loads, part)]
        added += [f"{tool} {tool_in_words(action, problem.units)}" for tool, action in case.tools.items()]
        yield f"Load case {name} adds: {'; '.join(added)}."
    for name, factors in problem.combinations.items():
        yield f"Combination {name}: {' + '.join(f'{factor:g} {case}' for case, factor in factors.items())}."


def problem_in_words(problem: Problem) -> list[str]:
    """The paragraphs of its description, then the material and the loads on the volume."""
    loads = "; ".join(volume_loads(problem))
    given = f"Material: {'; '.join(materials_in_words(problem))}.{f' On the volume: {loads}.' if loads else ''}"
    return [*paragraphs(problem.description), given]


def paragraphs(text: str) -> list[str]:
    """A description paragraph by paragraph, each in one line."""
    return [" ".join(part.split()) for part in text.split("\n\n") if part.strip()]


def plural(noun: str, count: int) -> str:
    """The noun in the form that belongs to a number."""
    return noun if count == 1 else f"{noun}s"


def seconds_in_words(seconds: float) -> str:
    """Write seconds with two figures, or all before the point."""
    return f"{seconds:.2g} s" if seconds < 10 else f"{seconds:.0f} s"


def sentence_case(text: str) -> str:
    """The text with a capital first letter; not of a key, which stands before a colon."""
    return text if text.partition(" ")[0].endswith(":") else text[:1].upper() + text[1:]


def reference_in_words(reference: Reference) -> str:
    """Closed form or source of a reference, and its load case."""
    of_case = "" if reference.case is None else f", load case '{reference.case}'"
    match reference:
        case Values() | Table():
            return f"{reference.source}{of_case}"
        case _:
            return f"closed form, {reference.kind.replace('_', ' ')}{of_case}"
