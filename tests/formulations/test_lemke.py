"""Lemke's method by itself: P-matrices against all contact sets, degenerate problems, rays."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bemcontact.contact.solution import Status
from bemcontact.formulations.complementarity import lemke


def is_p_matrix(M: np.ndarray) -> bool:
    """All principal minors positive: then every q has exactly one solution."""
    n = len(M)
    sets = (list(s) for size in range(1, n + 1) for s in itertools.combinations(range(n), size))
    return all(np.linalg.det(M[np.ix_(s, s)]) > 0 for s in sets)


def p_matrix(rng: np.random.Generator, n: int) -> np.ndarray:
    """A random one, neither symmetric nor definite."""
    while True:
        M = rng.standard_normal((n, n)) + 1.5 * np.eye(n)
        if is_p_matrix(M) and np.linalg.eigvalsh(M + M.T)[0] < 0:
            return M


def values(M: np.ndarray, q: np.ndarray, active: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The z that vanishes off the active set, with w = q + M z zero on it; and w."""
    z = np.zeros(len(q))
    z[active] = np.linalg.solve(M[np.ix_(active, active)], -q[active])
    return z, q + M @ z


def exhaustive(M: np.ndarray, q: np.ndarray) -> np.ndarray:
    """The one z among all 2ⁿ active sets that solves the problem."""
    for active in itertools.product((False, True), repeat=len(q)):
        z, w = values(M, q, np.array(active))
        if min(z.min(), w.min()) >= -1e-10:
            return z
    raise AssertionError("a P-matrix has a solution for every q")


@pytest.mark.parametrize("seed", range(12))
def test_p_matrices_against_all_active_sets(seed):
    rng = np.random.default_rng(seed)
    M, q = p_matrix(rng, 4), rng.standard_normal(4)
    end = lemke(M, q)
    assert end.status is Status.SOLVED
    np.testing.assert_allclose(values(M, q, end.active)[0], exhaustive(M, q), atol=1e-9)


@pytest.mark.parametrize("seed", range(4))
def test_the_artificial_variable_is_reported_after_each_pivot(seed):
    """It enters at the least value that makes q + d z0 >= 0, and leaves at zero."""
    rng = np.random.default_rng(seed)
    M, q, d = p_matrix(rng, 5), rng.standard_normal(5), rng.uniform(0.5, 1.5, 5)
    end = lemke(M, q, covering=d)
    assert end.covers[0] == pytest.approx((-q / d).max(), rel=1e-14)
    assert min(end.covers[:-1]) > 0
    assert end.covers[-1] == 0.0


@pytest.mark.parametrize("covering", ["default", "ones", "random"])
def test_any_covering_vector_leads_to_the_solution(covering):
    """The solution of a positive definite problem is unique: every path ends there; 60 pivots renew the inverse."""
    rng = np.random.default_rng(0)
    n = 80
    A, S = rng.standard_normal((2, n, n))
    M, q = A @ A.T / n + 0.1 * (S - S.T) + 0.1 * np.eye(n), rng.standard_normal(n)
    d = {"default": None, "ones": np.ones(n), "random": rng.uniform(0.5, 1.5, n)}[covering]
    end = lemke(M, q, covering=d)
    z, w = values(M, q, end.active)
    assert end.status is Status.SOLVED
    assert min(z.min(), w.min()) >= -1e-12


def test_covering_vector_decides_how_long_the_path_is():
    """Murty's matrix, n = 8: all 2ⁿ complementary bases with d = (1, 2, 4, ...), two with the default."""
    n = 8
    M = np.eye(n) + 2 * np.triu(np.ones((n, n)), 1)
    assert lemke(M, -np.ones(n), covering=2.0 ** np.arange(n)).pivots == 2**n
    assert lemke(M, -np.ones(n)).pivots == 2


def test_degenerate_problem_does_not_cycle():
    """All q equal and rows in pairs: every ratio is tied; the lexicographic rule leads through."""
    n = 12
    M = np.kron(np.eye(n // 2), np.ones((2, 2))) + np.eye(n) - np.kron(np.eye(n // 2), [[0.0, 1.0], [-1.0, 0.0]])
    end = lemke(M, -np.ones(n), covering=np.ones(n))
    z, w = values(M, -np.ones(n), end.active)
    assert end.status is Status.SOLVED
    assert min(z.min(), w.min()) >= -1e-13


@settings(max_examples=60, deadline=None)
@given(st.data())
def test_semidefinite_integer_problems_are_solved_or_refused_with_proof(data):
    """M = B Bᵀ + skew is row sufficient: no third outcome. Small integers make ties and singular blocks common."""
    entry = st.integers(-1, 1)
    n = 4
    B = np.array(data.draw(st.lists(entry, min_size=2 * n, max_size=2 * n)), float).reshape(n, 2)
    S = np.array(data.draw(st.lists(entry, min_size=n * n, max_size=n * n)), float).reshape(n, n)
    q = np.array(data.draw(st.lists(st.integers(-2, 2), min_size=n, max_size=n)), float)
    M = B @ B.T + S - S.T
    end = lemke(M, q)
    assert end.status in (Status.SOLVED, Status.INFEASIBLE)
    if end.status is Status.SOLVED:
        z, w = values(M, q, end.active)
        assert min(z.min(), w.min()) >= -1e-10


def test_ray_that_proves_infeasibility():
    """With M = -1, w = -1 - z cannot be non-negative for z >= 0; y = 1 has Mᵀy <= 0, qᵀy < 0."""
    assert lemke(np.array([[-1.0]]), np.array([-1.0])).status is Status.INFEASIBLE


def test_ray_that_proves_nothing():
    """The point z = (0, 1), w = (0, 1) is feasible, but no complementary solution exists: nothing is claimed."""
    M, q = np.array([[-1.0, 1.0], [-1.0, 2.0]]), np.array([-1.0, -1.0])
    for active in itertools.product((False, True), repeat=2):
        z, w = values(M, q, np.array(active))
        assert min(z.min(), w.min()) < 0
    assert (q + M @ [0.0, 1.0] >= 0).all()
    assert lemke(M, q).status is Status.NO_SOLUTION_FOUND


def test_limit_is_named():
    rng = np.random.default_rng(1)
    A = rng.standard_normal((20, 20))
    end = lemke(A @ A.T, rng.standard_normal(20), covering=rng.uniform(0.5, 1.5, 20), limit=2)
    assert end.status is Status.ITERATION_LIMIT
    assert end.pivots == 2


def test_nothing_to_do():
    end = lemke(np.eye(3), np.zeros(3))
    assert end.status is Status.SOLVED
    assert not end.active.any()
