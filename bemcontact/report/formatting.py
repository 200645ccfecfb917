"""Numbers, units and parts of a problem in words, for tables, pictures and pages."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from bemcontact.arrays import Array
from bemcontact.problem import (
    Circle,
    Condition,
    DeflectedContour,
    Edge,
    Field,
    LoadCase,
    Loads,
    Plane,
    Polyline,
    Problem,
    Reference,
    RigidSurface,
    Spline,
    Table,
    ToolAction,
    Units,
    Values,
)

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
    return with_unit(_range(field.at(edge.points(np.linspace(0, 1, 41)))), unit)


def _range(values: Array) -> str:
    """Write a value, or from where to where values (k,) go."""
    low, high = float(values.min()), float(values.max())
    return number(low) if np.isclose(low, high) else f"{number(low)} … {number(high)}"


def prescribed(problem: Problem, edge: Edge) -> Iterator[str]:
    """Conditions of an edge: ``u_x = 0``, ``t_y = -3.6 kN/cm²``, ``pressure 3 N/mm²``, ``may touch in foot``."""
    yield from (f"may touch in {name}" for name in problem.contact_zones if edge.name in problem.edges_of(name))
    if edge.name in problem.conditions:
        yield from _conditions(problem.conditions[edge.name], edge, problem.units)
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
    if condition.pressure is not None:
        yield f"pressure {field_on(condition.pressure, edge, units.stress)}"


def material_in_words(problem: Problem) -> str:
    """Constants of the material and the plane state: ``E = 210000 N/mm², Poisson's ratio 0.3, plane strain``."""
    material, units = problem.material, problem.units
    modulus = with_unit(f"{material.young_modulus:.9g}", units.stress)
    state = material.state.replace("_", " ")
    return f"E = {modulus}, Poisson's ratio {number(material.poisson_ratio)}, {state}"


def volume_loads(problem: Problem) -> Iterator[str]:
    """Loads on the volume: ``gravity (0, -9.81)``, ``rotation 100 about (0, 0) (1.5 spinning)``."""
    yield from _volume_loads(problem.loads, problem)
    for case, factor in problem.factors().items():
        loads = _volume_loads(problem.load_cases[case].loads, problem)
        yield from (f"{load} ({_acting(case, factor)})" for load in loads)


def _acting(case: str, factor: float) -> str:
    """Name a load case with the factor by which it acts, if it is not one."""
    return case if factor == 1 else f"{factor:g} {case}"


def _volume_loads(loads: Loads, problem: Problem) -> Iterator[str]:
    """Loads on the volume of the body."""
    if loads.gravity:
        yield f"gravity {vector(loads.gravity.acceleration)}"
    if loads.centrifugal:
        yield f"rotation {number(loads.centrifugal.angular_velocity)} about {vector(loads.centrifugal.center)}"
    if loads.temperature:
        points = np.concatenate([edge.polyline() for edge in problem.boundary.edges])
        yield f"temperature change {_range(loads.temperature.change.at(points))}"


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
    changed = [*case.conditions, *case.tools, *(key for key, load in case.loads if load is not None)]
    return case.description.strip() or f"changes {', '.join(changed)}"


def surface_in_words(surface: RigidSurface) -> str:
    """Description of a rigid surface."""
    match surface:
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
    """Name, edges and rigid surface of each contact zone."""
    zones = problem.contact_zones.items()
    return [(name, ", ".join(problem.edges_of(name)), surface_in_words(zone.surface)) for name, zone in zones]


def deflected_by(surface: DeflectedContour, problem: Problem) -> str:
    """Conditions and loads that deflect a contour: ``top t_y = -50 kN/cm²``."""
    conditions = [
        f"{name} {', '.join(_conditions(condition, problem.edge(name), problem.units))}"
        for name, condition in surface.conditions.items()
    ]
    return "; ".join([*conditions, *_volume_loads(surface.loads, problem)])


def problem_in_words(problem: Problem) -> list[str]:
    """The paragraphs of its description, then the material and the loads on the volume."""
    loads = "; ".join(volume_loads(problem))
    given = f"Material: {material_in_words(problem)}.{f' On the volume: {loads}.' if loads else ''}"
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
    """The text with a capital first letter."""
    return text[:1].upper() + text[1:]


def reference_in_words(reference: Reference) -> str:
    """Closed form or source of a reference, and its load case."""
    of_case = "" if reference.case is None else f", load case '{reference.case}'"
    match reference:
        case Values() | Table():
            return f"{reference.source}{of_case}"
        case _:
            return f"closed form, {reference.kind.replace('_', ' ')}{of_case}"
