"""Problems of several bodies, for the tests of every room."""

from collections.abc import Mapping, Sequence
from typing import Any

from bemcontact import Problem

Spec = dict[str, Any]

GUIDED = {"left": {"displacement": {"x": 0}}}
HELD = {"bottom": {"displacement": {"x": 0, "y": 0}}}


def block(x: tuple[float, float], y: tuple[float, float], elements: Sequence[int | None] = (None,) * 4) -> Spec:
    """Boundary of a block with the edges bottom, right, top, left."""
    corners = [[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]]
    edges = []
    for i, (name, number) in enumerate(zip(("bottom", "right", "top", "left"), elements, strict=True)):
        stated = {} if number is None else {"elements": number}
        edges.append({"name": name, "start": corners[i], "end": corners[(i + 1) % 4], **stated})
    return {"outer": edges}


def polygon(**edges: Sequence[float]) -> Spec:
    """Boundary through the starts of edges, by name."""
    names, points = [*edges], [*map(list, edges.values())]
    ends = [*points[1:], points[0]]
    return {"outer": [{"name": n, "start": a, "end": b} for n, a, b in zip(names, points, ends, strict=True)]}


def circle(name: str, radius: float, *, start: float = 0.0, elements: int | None = None, hole: bool = False) -> Spec:
    """A whole circle about the origin as one edge; clockwise if it is a hole."""
    turn = -360 if hole else 360
    edge = {"name": name, "kind": "arc", "center": [0, 0], "radius": radius, "angles": [start, start + turn]}
    return edge if elements is None else {**edge, "elements": elements}


def elastic(
    boundary: Spec, conditions: Mapping[str, Any] | None = None, modulus: float = 1000.0, **others: Any
) -> Spec:
    """An elastic body with Poisson's ratio 0.3."""
    material = {"young_modulus": modulus, "poisson_ratio": 0.3}
    return {"material": material, "boundary": boundary, "conditions": dict(conditions or {}), **others}


def rigid(boundary: Spec) -> Spec:
    """A rigid body."""
    return {"rigid": True, "boundary": boundary}


def problem(bodies: Mapping[str, Spec], accuracy: float | None = None, **contacts: Any) -> Problem:
    """A problem with contacts between pairs of bodies or edges, or mappings."""
    stated = {name: pair if isinstance(pair, Mapping) else {"between": pair} for name, pair in contacts.items()}
    return Problem(name="several bodies", bodies=dict(bodies), contacts=stated, accuracy=accuracy)  # pyright: ignore[reportArgumentType]


def stated(**spec: Any) -> Problem:
    """A problem from the values of a spec."""
    return Problem(**spec)
