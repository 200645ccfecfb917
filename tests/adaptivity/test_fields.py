"""What bisecting every element changes: nothing where the answer is in the space of the elements."""

import numpy as np
import pytest
from adaptive_problems import block_on_flat_floor, half_disk

from bemcontact.adaptivity.adapt import first_mesh
from bemcontact.adaptivity.fields import MeshDifference, halves, norm_squared, solved
from bemcontact.problem import Problem


def difference(problem: Problem) -> MeshDifference:
    """The first mesh and its halves."""
    coarse = first_mesh(problem)
    fine = coarse.model_copy(update={"mesh": coarse.mesh.model_copy(update={"refine": 2})})
    return MeshDifference(coarse=solved(coarse), fine=solved(fine), number=0)


def test_halves_prolong_quadratics_exactly():
    """Values of a quadratic at -1, 0, 1 become those at -1, -1/2, 0 and 0, 1/2, 1, whatever axes follow."""
    rng = np.random.default_rng(1)
    coefficients = rng.normal(size=(4, 3, 2))

    def at(xi: list[float]) -> np.ndarray:
        return np.einsum("mjx,jk->mkx", coefficients, np.array([np.ones(3), xi, np.square(xi)]))

    found = halves(at([-1, 0, 1]))
    assert found[0::2] == pytest.approx(at([-1, -0.5, 0]))
    assert found[1::2] == pytest.approx(at([0, 0.5, 1]))


def test_halves_of_scalars_have_the_shape_of_scalars():
    assert halves(np.arange(6.0).reshape(2, 3)).tolist() == [[0, 0.5, 1], [1, 1.5, 2], [3, 3.5, 4], [4, 4.5, 5]]


@pytest.fixture(scope="module")
def patch() -> MeshDifference:
    return difference(block_on_flat_floor()[0])


def test_a_patch_test_changes_by_nothing(patch: MeshDifference):
    """Uniform pressure and linear displacements are in the space of the elements: what changes is round-off."""
    coarse = patch.coarse
    one, two = patch.pair
    norm = norm_squared(coarse, one.pressure[0]).sum()
    assert norm == pytest.approx(7.0**2 * 40, rel=1e-9)
    assert patch.pressure_squared.sum() < 1e-16 * norm
    assert two.displacement == pytest.approx(halves(one.displacement), abs=1e-8 * np.abs(one.displacement).max())
    shear = patch.fine.body.problem.material.shear_modulus
    assert patch.energy.sum() < 1e-16 * 7.0**2 / shear * 120**2


def test_the_weights_integrate_along_the_boundary(patch: MeshDifference):
    """Its length is 120."""
    assert patch.coarse.weights.sum() == pytest.approx(120, rel=1e-12)
    assert patch.fine.weights.sum() == pytest.approx(120, rel=1e-12)


def test_contact_on_an_arc_changes_and_its_stretch_is_found():
    """Half of a disk: one stretch from the axis to a free end; the pressure changes most in its elements."""
    changed = difference(half_disk(2000.0))
    one, _ = changed.pair
    (stretch,) = one.stretches[0]
    assert (stretch.start, stretch.start_free, stretch.end_free) == (0.0, False, True)
    touching = (one.pressure[0] > 0).any(axis=1)
    squares = changed.pressure_squared[0]
    assert squares.sum() > 0
    assert squares[touching].sum() > 0.9 * squares.sum()


def test_fields_of_a_stretch_are_zero_outside_the_zone():
    changed = difference(half_disk(2000.0))
    one, _ = changed.pair
    assert (one.pressure[0][~changed.coarse.in_zone[0]] == 0).all()
