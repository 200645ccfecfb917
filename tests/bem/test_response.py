"""Solutions of the equations of a body from the factors of their matrix."""

import numpy as np
import pytest

from bemcontact.bem.response import Response
from bemcontact.contact.lu import LU
from bemcontact.errors import SingularSystemError


def response(condition, seed, loads=2, count=60):
    """Solutions for a matrix with singular values from 1 to 1/condition, and random right sides; the exact ones."""
    rng = np.random.default_rng(seed)
    left, right = (np.linalg.qr(rng.standard_normal((count, count)))[0] for _ in range(2))
    values = np.ones(count)
    values[-1] = 1 / condition
    matrix = np.asfortranarray(left * values @ right.T)
    sides = rng.standard_normal((count, 20))
    lu = LU.of(matrix.copy(order="F"))
    found = Response.of(lu, np.arange(count), count, sides, loads, lambda x, weights: sides @ weights - matrix @ x)
    return found, matrix, sides


@pytest.mark.parametrize("seed", range(10))
@pytest.mark.parametrize("condition", [1e17, 1e20, np.inf])
def test_matrices_that_are_singular_to_working_precision_are_refused(condition, seed):
    """Also where no pivot is zero: rounding in the residual has a part along the null vector."""
    with pytest.raises(SingularSystemError, match="no unique solution"):
        response(condition, seed)


@pytest.mark.parametrize("seed", range(10))
@pytest.mark.parametrize("condition", [1.0, 1e6, 1e13])
def test_other_matrices_are_solved(condition, seed):
    """The residual of a refined solution is rounding of its terms, whatever the condition."""
    found, matrix, sides = response(condition, seed)
    solution = found.last
    terms = abs(matrix) @ abs(solution) + abs(sides)
    assert (abs(matrix @ solution - sides) / terms).max() < 1e-14


def test_no_pressure_and_no_load_is_no_solution_of_a_singular_matrix():
    matrix = np.asfortranarray(np.ones((4, 4)))
    with pytest.raises(SingularSystemError):
        Response.of(LU.of(matrix.copy(order="F")), np.arange(4), 4, np.zeros((4, 1)), 1, lambda x, w: -matrix @ x)


def test_rows_that_were_not_solved_are_refused():
    """Else a gap would get the displacement of another place."""
    matrix = np.asfortranarray(np.diag([2.0, 4.0, 8.0]))
    sides, order = np.asfortranarray(np.eye(3)), np.array([1, 2, 0])
    lu = LU.of(matrix[:, order].copy(order="F"))
    found = Response.of(lu, order, 2, sides, 1, lambda x, weights: sides @ weights - matrix @ x)
    assert np.array_equal(found.rows(np.array([0, 2])), [[0.5, 0, 0], [0, 0, 0.125]])
    with pytest.raises(IndexError):
        found.rows(np.array([1]))
