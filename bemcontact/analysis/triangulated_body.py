"""Displacement and stress all over a body, on triangles that fill it."""

from typing import NamedTuple

import numpy as np

from bemcontact.analysis.body_stress import BodyStress
from bemcontact.arrays import IntArray
from bemcontact.bem.stress_field import Located
from bemcontact.bem.triangulation import triangulation
from bemcontact.contact.stress import Stress, TriangulatedBody


class FilledBody(NamedTuple):
    """Stress on triangles that fill a body, with the parts of `TriangulatedBody`, and where the points are."""

    at: Located
    triangles: IntArray
    stress: Stress
    element: IntArray


def filled_body(body: BodyStress) -> FilledBody:
    """Fill a body with triangles, and compute the stress at their corners."""
    made = triangulation(body.field.mesh)
    at = body.field.locate(made.points)
    return FilledBody(at, made.triangles, body.at(at), made.element)


def triangulated_body(body: BodyStress, filled: FilledBody, number: int) -> TriangulatedBody:
    """Add the displacement at the corners, and the number of the body."""
    return TriangulatedBody(
        points=filled.at.points,
        triangles=filled.triangles,
        displacement=body.field.displacement(filled.at)[..., 0],
        stress=filled.stress,
        element=filled.element,
        body=np.full(len(filled.triangles), number),
    )
