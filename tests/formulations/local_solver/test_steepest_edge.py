"""Curvatures of edges against their definition as a minimum, and the pricing of large programs by them."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bemcontact.formulations.local_solver.minimize import minimize_qp
from bemcontact.formulations.local_solver.phase_two import WORTH_EDGES, ReducedHessian
from bemcontact.formulations.local_solver.result import QPStatus
from bemcontact.formulations.local_solver.statement import read_statement
from bemcontact.formulations.local_solver.steepest_edge import FLOOR, SteepestEdge
from bemcontact.formulations.local_solver.working_set import WorkingSet


def _least_curvature(H, normals, place):
    """The least dᵀHd of all d that move one of the constraints by one and no other, by its equations."""
    r, n = normals.shape
    matrix = np.block([[H, normals.T], [normals, np.zeros((r, r))]])
    d = np.linalg.solve(matrix, np.eye(n + r)[n + place])[:n]
    return d @ H @ d


@settings(max_examples=15)
@given(st.integers(0, 10**9))
def test_curvatures_that_are_updated_are_the_least_of_their_edges(seed):
    rng = np.random.default_rng(seed)
    n, m = int(rng.integers(3, 9)), int(rng.integers(1, 4))
    B, A = rng.standard_normal((n, n)), rng.standard_normal((m, n))
    H = B @ B.T + 0.1 * np.eye(n)
    statement = read_statement(H, np.zeros(n), A, -np.ones(m), np.ones(m), -np.ones(n), np.ones(n))
    sides = np.zeros(n + m, dtype=np.int8)
    sides[rng.permutation(n + m)[: n // 2 + 1]] = -1
    working = WorkingSet(statement, sides)
    hessian = ReducedHessian(statement, working.null_space)
    edges = SteepestEdge(statement, working, hessian.Z)
    for _ in range(8):
        held, free = working.held.nonzero()[0], (~working.held).nonzero()[0]
        if held.size and (rng.random() < 0.5 or hessian.size == 0):
            place = int(rng.choice([*(~working.free.astype(bool)).nonzero()[0], *(n + np.arange(working.size))]))
            constraint, direction = working.drop(place)
            hessian.enter(direction)
            assert edges.follow_release(constraint, hessian.Z[:, -1])
        else:
            normal = working.add(int(rng.choice(free)), -1)
            if normal is None:
                return
            column = hessian.leave(normal)
            assert column is not None
            edges.follow_entry(column)
            for variable in (working.free == 0.0).nonzero()[0]:
                hessian.clear(variable)
        held = working.held.nonzero()[0]
        normals, of_all = np.vstack([np.eye(n), A])[held], np.zeros(n + m)
        of_all[working.numbers] = edges.curvatures
        expected = [_least_curvature(H, normals, place) for place in range(held.size)]
        np.testing.assert_allclose(of_all[held], np.maximum(expected, FLOOR), rtol=1e-6)


@pytest.mark.parametrize("seed", range(3))
def test_a_large_convex_program_in_a_box_has_its_closed_form(seed):
    """H is diagonal, so that each component is clipped by itself."""
    rng = np.random.default_rng(seed)
    n = WORTH_EDGES + 10
    curvatures, c = 10.0 ** rng.uniform(-2, 2, n), rng.standard_normal(n)
    result = minimize_qp(np.diag(curvatures), c, bl=np.zeros(n), bu=np.full(n, 0.5))
    assert result.status is QPStatus.LOCAL_MINIMIZER
    np.testing.assert_allclose(result.x, np.clip(-c / curvatures, 0.0, 0.5), atol=1e-12)


def test_variables_of_a_large_program_are_released_once_each():
    """At most a release and a step for each x_i > 0 of the solution, which y > 0 marks: no wrong one is released."""
    rng = np.random.default_rng(0)
    n = WORTH_EDGES + 10
    M = np.eye(n) + 0.5 / n * rng.random((n, n))
    H, y = M @ M.T, rng.choice([-1.0, 1.0], n)
    result = minimize_qp(H, -H @ np.maximum(y, 0.0) + np.maximum(-y, 0.0), bl=np.zeros(n))
    assert result.status is QPStatus.LOCAL_MINIMIZER
    np.testing.assert_allclose(result.x, np.maximum(y, 0.0), atol=1e-9)
    assert result.iterations <= 2 * np.count_nonzero(y > 0.0)
