"""Displacement and stress on triangles: those of the points, and their integrals those of the body."""

from pathlib import Path

import numpy as np
import pytest

import bemcontact

MODELS = Path(__file__).parents[2] / "models"


@pytest.mark.parametrize("name", ["cylinder_on_plane", "gallery/shrink_fit", "gallery/three_zones"])
def test_values_are_those_of_the_points(name: str):
    result = bemcontact.solve(bemcontact.load(MODELS / f"{name}.yaml", variant="stated mesh"))
    body = result.triangulated
    assert body.displacement == pytest.approx(result.displacement(body.points), rel=1e-12, abs=0)
    again = result.stress(body.points)
    assert (again.kind == body.stress.kind).all()
    assert again.components == pytest.approx(body.stress.components, rel=1e-12, nan_ok=True)


def test_mean_stress_is_that_of_the_tractions():
    """∫ σ dA = ∮ t xᵀ ds without volume loads; the triangles integrate the field to second order, chords included."""
    result = bemcontact.solve(bemcontact.load(MODELS / "cylinder_on_plane.yaml"), accuracy=0.003)
    body, state = result.triangulated, result.boundary
    a, b, c = np.moveaxis(body.points[body.triangles], 1, 0)
    areas = ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]) / 2
    whole = areas @ body.stress.components[body.triangles].mean(axis=1)
    weights = result._stresses.bodies[0].field.mesh.tributary
    moments = np.einsum("mk,mki,mkj->ij", weights, state.traction, state.points)
    expected = np.array([moments[0, 0], moments[1, 1], (moments[0, 1] + moments[1, 0]) / 2])
    assert whole == pytest.approx(expected, abs=0.01 * abs(expected).max())
