"""Displacement and stress all over a body, on triangles that fill it."""

from dataclasses import dataclass
from typing import ClassVar

from bemcontact.analysis.body_stress import BodyStress
from bemcontact.arrays import Array, IntArray
from bemcontact.bem.triangulation import triangulation
from bemcontact.checks.attributes import PLACE, WithHints, Words
from bemcontact.contact.stress import Stress


@dataclass(frozen=True, kw_only=True, eq=False)
class TriangulatedBody(WithHints):
    """Displacement and stress on triangles that fill the undeformed body: for pictures and files.

    The values at each point are those of `Result.stress` and `Result.displacement`. Between them they are not exact.
    """

    _called: ClassVar[Words] = {"points": PLACE, "triangles": ("elements", "cells", "faces", "connectivity")}

    points: Array
    """Points (k, 2) [L], those on the boundary first."""
    triangles: IntArray
    """Points (t, 3) of each triangle, counterclockwise."""
    displacement: Array
    """Displacement (k, 2) [L]."""
    stress: Stress
    """Stress at the points; not a number where it is infinite."""
    element: IntArray
    """Boundary element (b,) on which, or at the start of which, each of the first b points lies."""


def triangulated_body(body: BodyStress) -> TriangulatedBody:
    """Fill a body with triangles, and compute displacement and stress at their corners."""
    field = body.field
    made = triangulation(field.mesh)
    at = field.locate(made.points)
    return TriangulatedBody(
        points=made.points,
        triangles=made.triangles,
        displacement=field.displacement(at)[..., 0],
        stress=body.at(at),
        element=made.element,
    )
