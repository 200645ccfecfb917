"""Displacement and stress all over a body, on triangles that fill it."""

from bemcontact.analysis.body_stress import BodyStress
from bemcontact.bem.triangulation import triangulation
from bemcontact.contact.stress import TriangulatedBody


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
