"""The benchmark of stress states its link rightly, and recovers linear fields."""

import numpy as np
import pytest
from finite_elements_contact import ElasticBody
from finite_elements_stress import (
    CORNER,
    CUT,
    EXPANSION,
    HALF_HEIGHT,
    LENGTH,
    POISSON,
    RADIUS,
    WEIGHT,
    YOUNG,
    Pressed,
    heat,
    link,
    pressed,
    sample,
)
from skfem.models.elasticity import lame_parameters

SIZE = 0.6
AREA = 2 * (np.radians(180 - CORNER) * RADIUS**2 + CUT * HALF_HEIGHT) + 2 * HALF_HEIGHT * (LENGTH - 2 * CUT)
"""Two sectors, the triangles from the centers to the corners, and what is between the corners."""


@pytest.fixture(scope="module")
def mesh():
    return link(SIZE)


@pytest.fixture(scope="module")
def on_supports():
    return pressed(SIZE)


def test_the_link_has_its_area(mesh):
    """Quadratic sides leave h⁴ of the arcs: sides of less than 10° differ by 1e-6."""
    assert ElasticBody(mesh=mesh, young_modulus=1.0, poisson_ratio=0.0).basis.dx.sum() == pytest.approx(AREA, rel=2e-6)


def test_stress_of_a_linear_displacement_is_exact(mesh):
    """Quadratic elements, curved too, hold linear fields; what temperature adds to them is linear."""
    body = ElasticBody(mesh=mesh, young_modulus=YOUNG, poisson_ratio=POISSON)
    u = np.zeros(body.freedoms.size)
    u[body.freedoms] = 1e-3 * np.array([[1.0, 2.0], [3.0, -1.5]]) @ body.nodes.T
    lam, mu = lame_parameters(YOUNG, POISSON)
    held = Pressed(body=body, displacement=u, contacts={}, forces={})
    points = np.array([(-9.0, 1.0), (50.0, 7.9), (109.0, 0.0), (0.0, 0.0)])
    swelling = (3 * lam + 2 * mu) * EXPANSION * heat(*points.T)
    strained = 1e-3 * np.array([lam * -0.5 + 2 * mu, lam * -0.5 - 3 * mu, 5 * mu])
    right = strained - swelling[:, None] * [1, 1, 0]
    assert held.stress(points)[:, :3] == pytest.approx(right, rel=1e-9, abs=1e-9 * abs(right).max())


def test_supports_carry_load_and_weight(on_supports):
    """Forces act along the normals where contact is; these differ from those at first by 0.2 mm over 90 mm at most."""
    x, y = WEIGHT * AREA
    drum, table, wall = (on_supports.forces[name] for name in ("drum", "table", "wall"))
    assert 0.6 * drum + x == pytest.approx(wall, rel=2e-3)
    assert 0.8 * drum + table == pytest.approx(400 - y, rel=2e-3)


def test_fifty_points(on_supports):
    points = sample(on_supports.contacts)
    assert [len(group) for group in points.values()] == [24, 10, 16]
