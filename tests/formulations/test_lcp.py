"""Lemke's method and linear complementarity problems: against all active sets, on worst cases, with proofs."""

import itertools
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.sparse.csgraph import connected_components

from bemcontact.contact.solution import Status
from bemcontact.errors import ProblemError
from bemcontact.formulations.lcp import solve_lcp
from bemcontact.formulations.lemke import equilibrating, holds, lemke


def murty(n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """M, q and the solution (0, ..., 0, 1): principal pivoting by least index takes 2ⁿ steps (Murty 1978)."""
    return np.eye(n) + 2 * np.triu(np.ones((n, n)), 1), -np.ones(n), np.eye(n)[-1]


def fathi(n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """M = L Lᵀ, q and the solution (1, 0, ..., 0): the same for a symmetric positive definite M (Fathi 1979)."""
    L = np.eye(n) + 2 * np.tril(np.ones((n, n)), -1)
    return L @ L.T, -np.ones(n), np.eye(n)[0]


@pytest.mark.parametrize("family", [murty, fathi])
@pytest.mark.parametrize("n", [10, 50, 200])
def test_worst_cases_of_pivoting(family, n):
    """The solution is known in closed form."""
    M, q, z = family(n)
    result = solve_lcp(M, q)
    assert result.status is Status.SOLVED
    np.testing.assert_allclose(result.z, z, atol=1e-12)
    np.testing.assert_allclose(result.w, q + M @ z, atol=1e-9)


def test_lemke_takes_over_where_the_active_set_cycles():
    """A P-matrix on which the sets come back; the conditions are recomputed."""
    M = np.array([[1, 1, -3, 2, 0], [-1, 2, 1, -2, -2], [3, 2, 2, 0, 2], [-1, 2, 0, 1, 0], [-1, 0, -2, 0, 1]], float)
    result = solve_lcp(M, np.array([1.0, -1.0, 1.0, -2.0, -3.0]))
    assert result.method == "Lemke's method"
    assert result.status is Status.SOLVED
    np.testing.assert_allclose(np.minimum(result.z, result.w), 0, atol=1e-14)


GRID = np.array(list(itertools.product(np.linspace(0, 3, 7), repeat=4)))
"""Points z of four coordinates."""


@settings(max_examples=100, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_any_matrix_gives_a_solution_or_none_but_never_a_wrong_one(seed):
    """Small integers, any signs: what is called solved solves, what is called infeasible has no complementary point."""
    rng = np.random.default_rng(seed)
    n = 4
    M, q = rng.integers(-2, 3, (n, n)).astype(float), rng.integers(-2, 3, n).astype(float)
    result = solve_lcp(M, q)
    if result.status is Status.SOLVED:
        np.testing.assert_allclose(np.minimum(result.z, result.w), 0, atol=1e-10)
    if result.status is Status.INFEASIBLE:
        assert ((q + GRID @ M.T).min(axis=1) < 0).all()


@pytest.mark.parametrize(("M", "q"), [(np.ones((2, 3)), np.ones(2)), (np.diag([1.0, np.inf]), np.ones(2))])
def test_numbers_that_state_no_problem_are_refused(M, q):
    with pytest.raises(ProblemError, match="finite numbers"):
        solve_lcp(M, q)


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


def solution_of_lcp(M: np.ndarray, q: np.ndarray) -> np.ndarray:
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
    np.testing.assert_allclose(values(M, q, end.active)[0], solution_of_lcp(M, q), atol=1e-9)


@pytest.mark.slow
def test_no_row_is_violated_whatever_its_size():
    """Semidefinite problems with rows and columns of any size: a solution holds in each row, beside its own terms.

    Rounding of B Bᵀ can make an infeasible problem feasible far away: a few are left open.
    """
    left_open = 0
    for seed in range(200):
        rng = np.random.default_rng(seed)
        size = int(rng.integers(5, 40))
        factors = 10.0 ** rng.uniform(-3, 3, size)
        B = rng.standard_normal((size, int(rng.integers(1, size + 1))))
        M, q = factors[:, None] * (B @ B.T) * factors, rng.standard_normal(size)
        result = solve_lcp(M, factors * q if seed % 2 else q)
        left_open += result.status not in (Status.SOLVED, Status.INFEASIBLE)
        if result.status is Status.SOLVED:
            terms = np.abs(result.w - M @ result.z) + np.abs(M) @ result.z
            assert (result.z >= 0).all()
            assert (result.w >= -1e-9 * terms).all()
            assert result.z @ np.abs(result.w) <= 1e-9 * (result.z @ terms)
    assert left_open <= 4


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


def has_solution(M: np.ndarray, q: np.ndarray) -> bool:
    """Whether one of all 2ⁿ active sets, solved in fractions, has z >= 0 and w >= 0."""
    whole = [[Fraction(int(entry)) for entry in row] for row in np.column_stack([M, q])]
    sets = (active for size in range(len(q) + 1) for active in itertools.combinations(range(len(q)), size))
    return any(_solves(whole, active) for active in sets)


def _solves(whole: list[list[Fraction]], active: tuple[int, ...]) -> bool:
    """Whether w = 0 on the active set, by Gauss and Jordan, gives z >= 0 there and w >= 0 elsewhere."""
    rows = [[whole[i][j] for j in active] + [-whole[i][-1]] for i in active]
    for c in range(len(rows)):
        pivot = next((row for row in rows[c:] if row[c]), None)
        if pivot is None:
            return False
        place = rows.index(pivot, c)
        rows[place], rows[c] = rows[c], [entry / pivot[c] for entry in pivot]
        rows = [rows[c] if k == c else _less(row, row[c], rows[c]) for k, row in enumerate(rows)]
    z = [row[-1] for row in rows]
    others = (row[-1] + sum(row[j] * value for j, value in zip(active, z, strict=True)) for row in whole)
    return min(z, default=0) >= 0 and min(others) >= 0


def _less(row: list[Fraction], factor: Fraction, other: list[Fraction]) -> list[Fraction]:
    """A row less a multiple of another."""
    return [entry - factor * item for entry, item in zip(row, other, strict=True)]


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 10**6), n=st.integers(3, 6), decades=st.sampled_from([0, 0, 7]))
@example(seed=16617, n=6, decades=7)
def test_skew_integer_problems_against_all_active_sets(seed, n, decades):
    """Semidefinite parts of any rank: right, or, where integers span seven decades, honestly open."""
    rng = np.random.default_rng(seed)
    S = rng.integers(-9, 10, (n, n)) * 10 ** rng.integers(0, decades + 1, (n, n))
    B = rng.integers(-3, 4, (n, int(rng.integers(0, 3))))
    M, q = (S - S.T + B @ B.T).astype(float), rng.integers(-9, 10, n).astype(float)
    result = solve_lcp(M, q)
    assert decades or result.status in (Status.SOLVED, Status.INFEASIBLE)
    if result.status in (Status.SOLVED, Status.INFEASIBLE):
        assert has_solution(M, q) == (result.status is Status.SOLVED)
    if result.status is Status.SOLVED:
        factors = equilibrating(M)
        assert holds(factors[:, None] * M * factors, factors * q, result.z / factors)


def test_a_solution_holds_beside_its_terms_only():
    """M = diag(1, 1e-6), q = (-1, -1e-9): z = (1, 1e-3). A row of small numbers counts as much as the other."""
    M, q = np.diag([1.0, 1e-6]), np.array([-1.0, -1e-9])
    assert holds(M, q, np.array([1.0, 1e-3]))
    assert not holds(M, q, np.array([1.0, 0.0]))
    assert not holds(M, q, np.array([1.0, 2e-3]))
    assert not holds(M, -q, np.array([0.0, -1e-3]))
    assert holds(M, -q, np.zeros(2))


def test_a_path_whose_end_does_not_hold_claims_nothing(monkeypatch):
    for module in ("lcp", "lemke"):
        monkeypatch.setattr(f"bemcontact.formulations.{module}.holds", lambda *_: False)
    result = solve_lcp(np.eye(2), np.array([-1.0, 1.0]))
    assert result.status is Status.NO_SOLUTION_FOUND


def skew_in_units(seed: int, n: int, decades: int) -> tuple[Status, bool]:
    """How D M D and D q end, D positive and M = S - Sᵀ and q of integers, and whether M and q have a solution."""
    rng = np.random.default_rng(seed)
    S, q, units = rng.integers(-9, 10, (n, n)), rng.integers(-9, 10, n), 10.0 ** rng.uniform(-decades, decades, n)
    return lemke(units[:, None] * (S - S.T) * units, units * q).status, has_solution(S - S.T, q)


@pytest.mark.parametrize(
    ("M", "q"),
    [([[2.0**-32, -2, 4], [2, 0, -1], [-4, 1, 0]], [1, -3, 1]), ([[4 + 2.0**-48, -4], [-4, 4]], [-3, 1]),
     ([[709 + 2.0**-27, -456, 329], [-456, 685, -500], [329, -500, 365]], [-2, 1, -1])],
)  # fmt: skip
def test_solutions_far_away_are_not_excluded(M, q):
    """Definite or semidefinite up to the last digits, which are more than rounding: w = 0 at z of 1e10 to 1e15."""
    z = np.linalg.solve(M, np.negative(q))
    assert (z > 0).all()
    assert solve_lcp(M, q).status is not Status.INFEASIBLE


@pytest.mark.parametrize("unit", [1.0, 2.0**20, 2.0**60])
@pytest.mark.parametrize("small", [2.0**-20, 2.0**-36, 2.0**-44])
def test_a_row_of_small_numbers_is_violated_too(small, unit):
    """w1 = -small - z2 is negative for each z >= 0; M is the same in all units of the rows."""
    units = np.array([unit, 1.0 / unit])
    assert solve_lcp([[0, -1], [1, 0]], units * [-small, -1]).status is not Status.SOLVED


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 10**6), n=st.integers(3, 6), decades=st.integers(0, 8))
def test_infeasibility_is_proved_in_other_units(seed, n, decades):
    """About every fourth problem is infeasible. With units of ten decades and more, it may be left open."""
    status, solvable = skew_in_units(seed, n, decades)
    left_open = decades > 4 and status is Status.NO_SOLUTION_FOUND
    assert left_open or status is (Status.SOLVED if solvable else Status.INFEASIBLE)


@settings(max_examples=100, deadline=None)
@given(seed=st.integers(0, 10**6), n=st.integers(2, 6))
def test_units_of_any_size_change_no_claim(seed, n):
    """D M D and D q, D of powers of two up to 2^60 and 2^-60, which change no digit of integers."""
    rng = np.random.default_rng(seed)
    S, B, q = rng.integers(-2, 3, (n, n)), rng.integers(-2, 3, (n, n // 2)), rng.integers(-2, 3, n)
    M, units = S - S.T + B @ B.T * rng.integers(0, 2), 2.0 ** rng.integers(-60, 61, n)
    result = solve_lcp(units[:, None] * M * units, units * q)
    assert result.status is (Status.SOLVED if has_solution(M, q) else Status.INFEASIBLE)


@pytest.mark.parametrize(("seed", "n", "decades"), [(337, 4, 6), (1519, 6, 6), (1600, 3, 5), (2192, 3, 5)])
def test_a_proof_by_rows_of_small_numbers_counts(seed, n, decades):
    """Where qᵀy is 1e-8 of the largest numbers of q and y, but not of its own terms."""
    assert skew_in_units(seed, n, decades) == (Status.INFEASIBLE, False)


@given(seed=st.integers(0, 10**6), n=st.integers(2, 7))
def test_weights_on_rows_lose_no_answer(seed, n):
    """A row sufficient matrix stays one if rows are multiplied by positive numbers: there is a solution, or none.

    It is the Laplacian of a random graph; a potential on a part of it adds up the right sides there to a negative sum.
    """
    rng = np.random.default_rng(seed)
    links = np.triu(rng.integers(0, 3, (n, n)), 1)
    M = np.diag((links + links.T).sum(axis=1)) - (links + links.T) + 0.0
    q, rows = rng.integers(-3, 2, n) + 0.0, 2.0 ** rng.integers(-2, 3, n)
    result = solve_lcp(rows[:, None] * M, rows * q)
    parts = connected_components(links)[1]
    exists = all(q[parts == part].sum() >= 0 for part in parts)
    assert result.status is (Status.SOLVED if exists else Status.INFEASIBLE)


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


@given(seed=st.integers(0, 10**6), n=st.integers(6, 24))
@settings(max_examples=40, deadline=None)
def test_zeros_that_rounding_left_are_taken_away(seed, n):
    """Semidefinite M = A Aᵀ of low rank in units of its own, with rows in which zeros of z meet zeros of q."""
    rng = np.random.default_rng(seed)
    A = rng.integers(-3, 4, (n, max(1, n // 3))) + 0.0
    z, w = rng.integers(0, 3, n) + 0.0, rng.integers(0, 3, n) + 0.0
    w[z > 0] = 0.0
    units = 2.0 ** rng.integers(-12, 13, n)
    M = units[:, None] * (A @ A.T) * units
    result = solve_lcp(M, units * (w - A @ (A.T @ z)))
    assert result.status is Status.SOLVED


@pytest.mark.parametrize("M", [2.0, 1e-300, 1e300])
def test_one_variable_needs_one_pivot(M: float):
    """Then z = -q/M is positive for positive M, however small it is; for q >= 0 it is zero."""
    end = lemke(np.array([[M]]), np.array([-1.0]))
    assert (end.status, end.active.tolist(), end.pivots) == (Status.SOLVED, [True], 1)
    assert lemke(np.array([[M]]), np.array([1.0])).active.tolist() == [False]
