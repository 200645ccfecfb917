"""The residual of nonnegative least squares by its optimality conditions; least squares and singular values."""

from types import SimpleNamespace

import numpy as np
import pytest
import scipy

from bemcontact.arrays import freeze_arrays, least_squares, nonnegative_residual, short_svd


def of_whole_numbers(rng, k, n):
    return rng.integers(-1, 2, (k, n)).astype(float), rng.integers(-1, 2, k).astype(float)


def of_any_size(rng, k, n):
    return rng.standard_normal((k, n)) * 10.0 ** rng.uniform(-6, 6, n), rng.standard_normal(k)


def nearly_parallel(rng, k, n):
    columns = rng.standard_normal((k, n))
    return np.hstack([columns, columns * (1 + 1e-13 * rng.standard_normal(columns.shape))]), rng.standard_normal(k)


def side_by_side(rng, k, n):
    """The right side is between two columns: a residual beside one of them is small, and must turn to the other."""
    columns = rng.standard_normal((k, n + 2))
    columns[:, 1] = columns[:, 0] + 10.0 ** rng.uniform(-10, -4) * columns[:, 1]
    return columns, columns[:, :2] @ rng.uniform(0.5, 1.5, 2)


def carried(rng, k, n):
    columns = rng.standard_normal((k, n))
    return columns, columns @ np.maximum(rng.standard_normal(n), 0.0)


@pytest.mark.parametrize("kind", [of_whole_numbers, of_any_size, nearly_parallel, side_by_side, carried])
@pytest.mark.parametrize("seed", range(40))
def test_residual_is_the_least(kind, seed: int):
    """The vector r + b is A x with x >= 0, by a linear program; Aᵀr >= 0 and rᵀA x = 0, so no x is better."""
    rng = np.random.default_rng(seed)
    columns, right = kind(rng, int(rng.integers(1, 8)), int(rng.integers(0, 40)))
    residual = nonnegative_residual(columns, right)
    size, length = np.linalg.norm(right), np.linalg.norm(columns, axis=0)
    assert (columns.T @ residual >= -1e-11 * size * length).all()
    assert abs(residual @ (residual + right)) <= 1e-13 * size**2
    unit = columns[:, length > 0] / length[length > 0]
    if unit.size:
        assert scipy.optimize.linprog(np.zeros(unit.shape[1]), A_eq=unit, b_eq=residual + right).success
    else:
        np.testing.assert_array_equal(residual, -right)


@pytest.mark.parametrize("kind", [side_by_side, carried])
@pytest.mark.parametrize("seed", range(40))
def test_what_is_carried_leaves_round_off(kind, seed: int):
    rng = np.random.default_rng(seed)
    columns, right = kind(rng, int(rng.integers(1, 8)), int(rng.integers(0, 40)))
    assert np.linalg.norm(nonnegative_residual(columns, right)) <= 1e-14 * np.linalg.norm(right)


def test_ties_are_no_descent():
    """(1, 1/2, 1/2, 1) is orthogonal to four of the columns and behind the fifth."""
    columns = np.array([[0, -1, 0, -1, 0], [-1, -1, -1, 1, -1], [-1, 0, 1, 1, -1], [1, -1, 0, 0, 1]], float)
    residual = nonnegative_residual(columns, np.array([1.0, 0, 1, 1]))
    np.testing.assert_allclose(residual, [-1, -0.5, -0.5, -1], rtol=1e-15)


def test_singular_values_are_those_of_the_matrix_with_rows_of_zeros():
    """Few rows, and one column, have the values and null vectors of any other matrix: rows of zeros change neither."""
    generator = np.random.default_rng(3)
    for n, k in ((0, 1), (0, 3), (1, 1), (5, 1), (2, 3), (7, 3)):
        matrix = generator.standard_normal((n, k))
        values, vectors = short_svd(matrix)
        assert values == pytest.approx(np.linalg.svd(np.vstack([matrix, np.zeros((k, k))]))[1], abs=1e-15)
        assert np.linalg.norm(matrix @ vectors.T, axis=0) == pytest.approx(values, abs=1e-14)
        assert vectors @ vectors.T == pytest.approx(np.eye(k), abs=1e-14)


def test_least_squares_are_the_shortest_ones():
    """They are A⁺b by the pseudo-inverse of Moore and Penrose, also of one row or column, of zeros, and of rank one."""
    generator = np.random.default_rng(4)
    for n, k in ((0, 1), (1, 1), (5, 1), (1, 4), (6, 3), (3, 6)):
        columns, right = generator.standard_normal((n, k)), generator.standard_normal(n)
        alike = np.outer(columns.sum(axis=1), np.ones(k))
        for matrix in (columns, alike, 0 * columns):
            np.testing.assert_allclose(least_squares(matrix, right), np.linalg.pinv(matrix) @ right, rtol=0, atol=1e-13)


def test_nobody_can_write_to_frozen_arrays():
    """Copied are arrays that somebody may write to, also by what they are views of; others are shared."""
    mine, own = np.zeros(3), np.zeros(3)
    view = mine[:2]
    view.setflags(write=False)
    own.setflags(write=False)
    holder = SimpleNamespace(mine=mine, view=view, own=own)
    freeze_arrays(holder)
    mine[:] = 1.0
    assert not any(array.any() or array.flags.writeable for array in vars(holder).values())
    assert holder.own is own
