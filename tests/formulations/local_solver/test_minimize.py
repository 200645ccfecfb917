"""The local solver: every claim of a result checked again from the data of the problem."""

from contextlib import suppress
from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.optimize import linprog

from bemcontact.errors import ProblemError
from bemcontact.formulations.local_solver.minimize import minimize_qp
from bemcontact.formulations.local_solver.result import QPOptions, QPResult, QPStatus

INF = np.inf


def random_qp(seed):
    """A small program: any inertia, whole numbers (degenerate) or not, redundant and contradictory rows."""
    rng = np.random.default_rng(seed)
    n, m = int(rng.integers(1, 6)), int(rng.integers(0, 6))
    whole = rng.random() < 0.5

    def draw(*shape):
        return rng.integers(-2, 3, shape).astype(float) if whole else rng.standard_normal(shape)

    B = draw(n, n)
    b = B[:, :1]
    H = [B + B.T, B @ B.T, np.zeros((n, n)), b @ b.T - B[:, -1:] @ B[:, -1:].T][int(rng.integers(4))]
    A = draw(m, n)
    if m > 1 and rng.random() < 0.4:
        A[-1] = A[0] * rng.choice([-1.0, 2.0])

    def interval(k):
        low, high = -np.abs(draw(k)), np.abs(draw(k))
        low[rng.random(k) < 0.3], high[rng.random(k) < 0.3] = -INF, INF
        fixed = rng.random(k) < 0.15
        low[fixed] = high[fixed] = 0.0
        shift = draw(k) * (rng.random() < 0.4)
        return low + shift, high + shift

    (bl, bu), (cl, cu) = interval(n), interval(m)
    return H, draw(n), A, cl, cu, bl, bu


def constraints(A, cl, cu, bl, bu):
    """[I; A] with its bounds."""
    return np.vstack([np.eye(bl.size), A]), np.concatenate([bl, cl]), np.concatenate([bu, cu])


def assert_first_order(H, c, A, cl, cu, bl, bu, result):
    """Feasible, stationary, multipliers of the right sign on active constraints only: to 1e-8, data of size one."""
    G, low, high = constraints(A, cl, cu, bl, bu)
    values = G @ result.x
    assert np.all(values >= low - 1e-8)
    assert np.all(values <= high + 1e-8)
    multipliers = np.concatenate([result.bound_multipliers, result.constraint_multipliers])
    assert_allclose(G.T @ multipliers, H @ result.x + c, atol=1e-8)
    assert np.all(multipliers[np.abs(values - low) > 1e-7] <= 1e-8)
    assert np.all(multipliers[np.abs(values - high) > 1e-7] >= -1e-8)


def cone_of(H, c, A, cl, cu, bl, bu, x):
    """Normals of the equalities and of the active inequalities (inwards) at x."""
    G, low, high = constraints(A, cl, cu, bl, bu)
    values = G @ x
    fixed = low == high
    at_low, at_high = (np.abs(values - low) < 1e-7) & ~fixed, (np.abs(values - high) < 1e-7) & ~fixed
    return G[fixed], np.vstack([G[at_low], -G[at_high]])


def lowest_curvature_on_faces(H, equal, inwards, gradient):
    """Exhaustive: the least dᵀHd of a unit d in {E d = 0, W d >= 0, gᵀd = 0}, among the eigenvectors on every face."""
    lowest = 0.0
    scale = max(1.0, float(np.abs(gradient).max()))
    for face in product([False, True], repeat=inwards.shape[0]):
        rows = np.vstack([equal, inwards[list(face)], gradient[None] / scale])
        _, s, V = np.linalg.svd(rows)
        N = V[int(np.sum(s > 1e-8)) :].T
        if N.shape[1] == 0:
            continue
        eigenvalues, vectors = np.linalg.eigh(N.T @ H @ N)
        for value, vector in zip(eigenvalues, (N @ vectors).T, strict=True):
            for d in (vector, -vector):
                if np.all(inwards @ d >= -1e-9):
                    lowest = min(lowest, float(value))
    return lowest


def first_order_values(H, c, A, cl, cu, bl, bu):
    """Exhaustive: the objective at every stationary point of every working set that is feasible."""
    G, low, high = constraints(A, cl, cu, bl, bu)
    choices = [
        [2] if a == b else [0] + [-1] * bool(np.isfinite(a)) + [1] * bool(np.isfinite(b))
        for a, b in zip(low, high, strict=True)
    ]
    computed = []
    for sides in product(*choices):
        sides = np.array(sides)
        W = sides != 0
        if W.sum() > c.size and not np.any(sides == 2):
            continue
        right = np.where(sides == 1, high, low)[W]
        K = np.block([[H, G[W].T], [G[W], np.zeros((W.sum(), W.sum()))]])
        x = np.linalg.lstsq(K, np.concatenate([-c, right]), rcond=1e-11)[0][: c.size]
        if np.all(G @ x >= low - 1e-8) and np.all(G @ x <= high + 1e-8):
            computed.append(float(c @ x + 0.5 * x @ H @ x))
    return np.array(computed)


@pytest.mark.slow
@pytest.mark.parametrize("by_numba", [False, True])
@settings(max_examples=300, deadline=None)
@given(seed=st.integers(0, 10**9))
@example(seed=5002655)
@example(seed=5051967)
def test_every_claim_of_a_random_programme_holds(by_numba, seed):
    H, c, A, cl, cu, bl, bu = random_qp(seed)
    result = minimize_qp(H, c, A, cl, cu, bl, bu, options=QPOptions(by_numba=by_numba))
    G, low, high = constraints(A, cl, cu, bl, bu)
    if result.status is QPStatus.INFEASIBLE:
        assert_separates(G, low, high, result.certificate)
    elif result.status is QPStatus.UNBOUNDED:
        assert_ray(H, c, G, low, high, result)
    else:
        assert result.status is QPStatus.LOCAL_MINIMIZER
        assert_first_order(H, c, A, cl, cu, bl, bu, result)
        equal, inwards = cone_of(H, c, A, cl, cu, bl, bu, result.x)
        assert lowest_curvature_on_faces(H, equal, inwards, H @ result.x + c) > -1e-7


def nearly_parallel(seed, n):
    """A program with a feasible point of whole numbers, on rows that differ by 1e-6 to 1e-10 from others."""
    rng = np.random.default_rng(seed)
    B, c, x = rng.integers(-3, 4, (n, n)), rng.integers(-3, 4, n).astype(float), rng.integers(-2, 3, n)
    A, apart = rng.integers(-2, 3, (2, n)).astype(float), 10.0 ** -rng.uniform(6, 10)
    A = np.vstack([A, *(rng.choice([-1, 1]) * A[i] + apart * rng.integers(-2, 3, n) for i in (0, 0, 1))])
    low = np.where(rng.random(5) < 0.5, A @ x - rng.choice([0.0, 1.0, apart], 5), -INF)
    high = np.where(np.isinf(low), A @ x + rng.choice([0.0, 1.0, apart], 5), INF)
    return (B + B.T).astype(float) * rng.integers(0, 2), c, A, low, high, np.full(n, -4.0), np.full(n, 4.0)


@settings(max_examples=200, deadline=None)
@given(seed=st.integers(0, 10**9), n=st.integers(2, 5))
@example(4800, 2)
def test_a_program_with_a_feasible_point_is_not_called_infeasible(seed, n):
    assert minimize_qp(*nearly_parallel(seed, n)).status is not QPStatus.INFEASIBLE


def parallel_to_a_power_of_two(seed):
    """A program with a feasible point of whole numbers, on rows that differ by 2^-10 to 2^-44, all without rounding."""
    rng = np.random.default_rng(seed)
    n, m = rng.integers(1, 7), rng.integers(1, 10)
    A = rng.integers(-3, 4, n) + 2.0 ** -rng.integers(10, 45) * rng.integers(-3, 4, (m, n))
    x, sizes = rng.integers(-5, 6, n).astype(float), 2.0 ** rng.integers(-20, 21, m)
    exact = [sum((Fraction(a) * Fraction(b) for a, b in zip(row, x, strict=True)), Fraction()) for row in A]
    values = np.array([float(value) for value in exact])
    assume(all(Fraction(value) == other for value, other in zip(values, exact, strict=True)))
    low, high = values - rng.choice([0.0, 0.0, INF], m), values + rng.choice([0.0, 1.0, INF], m)
    box = np.where(rng.random(n) < 0.4, np.minimum(x, 0.0), -INF), np.where(rng.random(n) < 0.3, x, INF)
    B = rng.integers(-2, 3, (n, n))
    return (B @ B.T).astype(float), np.ones(n), sizes[:, None] * A, sizes * low, sizes * high, *box


@pytest.mark.slow
@settings(max_examples=300, deadline=None)
@given(seed=st.integers(0, 10**9))
def test_rows_that_meet_far_away_are_not_called_infeasible(seed):
    """Their natural size, bounds over entries, is up to 1e13 times smaller than the only point at which they meet."""
    assert minimize_qp(*parallel_to_a_power_of_two(seed)).status is not QPStatus.INFEASIBLE


@pytest.mark.parametrize(("n", "power"), [(2, 50), (10, 46), (60, 43), (300, 39)])
def test_many_columns_hide_no_point(n, power):
    """Σx <= 0 and Σx + small x_n >= 1 hold where x_n is 1/small; an entry differs by more than its rounding."""
    A = np.ones((2, n))
    A[1, -1] += 2.0**-power
    result = minimize_qp(np.eye(n), np.zeros(n), A, [-INF, 1.0], [0.0, INF])
    assert result.status is not QPStatus.INFEASIBLE


@settings(max_examples=200, deadline=None)
@given(seed=st.integers(0, 10**9), started=st.booleans())
@example(1, True)
def test_a_strictly_convex_program_on_nearly_parallel_rows_is_solved_or_left_open(seed, started):
    """Rows differ by 2^-25 to 2^-39, so that the search may come from far away. Weak duality bounds the minimum.

    The units in which such rows are of size one cost all but two or three digits of the multipliers.
    """
    rng = np.random.default_rng(seed)
    B, c, a = rng.integers(-2, 3, (3, 3)), rng.integers(-3, 4, 3), rng.integers(-2, 3, 3)
    x0, apart = rng.integers(-3, 4, 3).astype(float), 2.0 ** -rng.integers(25, 40)
    H, A = (B @ B.T + np.eye(3)).astype(float), np.array([a, a + apart * rng.integers(-2, 3, 3)])
    low = a @ x0 + np.array([0.0, rng.integers(1, 3)])
    high = np.where(rng.random(3) < 0.4, x0, INF)
    result = minimize_qp(H, c, A, low, None, None, high, x0=x0 if started else None)
    if result.status is QPStatus.LOCAL_MINIMIZER:
        of_rows, of_bounds = result.constraint_multipliers, result.bound_multipliers
        of_rows, of_bounds = np.maximum(of_rows, 0.0), np.where(high < INF, np.minimum(of_bounds, 0.0), 0.0)
        slope = c - A.T @ of_rows - of_bounds
        held = of_bounds != 0.0
        below = -0.5 * slope @ np.linalg.solve(H, slope) + of_rows @ low + of_bounds[held] @ high[held]
        assert result.objective - below <= 1e-2 * (1.0 + abs(result.objective))


def test_two_rows_that_meet_far_away_are_not_called_infeasible():
    """Both equations hold at (-1, 3); multipliers of 3e11 leave 0.2 of each other, and a sum of 0.6."""
    A = np.array([[-3.0000000000013642, -1.0000000000013642], [-2.9999999999995453, -1.0]])
    b = np.array([-2.7284841053187847e-12, -4.547473508864641e-13])
    result = minimize_qp(np.eye(2), np.array([2.0, -1.0]), A, b, b, [-INF, 0.0])
    assert result.status is not QPStatus.INFEASIBLE


@settings(max_examples=100, deadline=None)
@given(seed=st.integers(0, 10**9), gap=st.sampled_from([1e-6, 1e-3, 1.0]))
def test_a_row_that_contradicts_a_sum_of_others_is_called_infeasible(seed, gap):
    """The row is the sum of others up to rounding, and its bound is above theirs; variables may be free."""
    rng = np.random.default_rng(seed)
    n, m = rng.integers(2, 30), rng.integers(2, 40)
    A, x = rng.standard_normal((m, n)), rng.standard_normal(n)
    high, weights = A @ x + rng.random(m), np.where(np.arange(m) < 5, rng.random(m) + 0.1, 0.0)
    box = np.where(rng.random(n) < 0.5, x - 1.0, -INF), np.where(rng.random(n) < 0.5, x + 1.0, INF)
    rows, low = np.vstack([A, weights @ A]), np.append(np.full(m, -INF), weights @ high + gap)
    result = minimize_qp(np.eye(n), np.ones(n), rows, low, np.append(high, INF), *box)
    assert result.status is QPStatus.INFEASIBLE


def test_rounding_of_large_multipliers_proves_nothing():
    """Rows meet in a point. What multipliers of 4e9 leave of each other is 1e-7, as is the sum that separates."""
    apart, point, H, c = 7.417858771674446e-09, np.array([-1.0, 2.0, -1.0]), np.zeros((3, 3)), np.array([2.0, 1, 0])
    parallel = [2 + apart, 2 + 2 * apart, 2 - 2 * apart], [2 - apart, 2, 2]
    A = np.array([[-2.0, 0, 1], [-2, 2, 0], [-2, -2, -2], *parallel])
    low, high = np.array([1, 6 - apart, -INF, -INF, -INF]), np.array([INF, INF, 0, 1 + 5 * apart, apart])
    assert (A @ point >= low).all()
    assert (A @ point <= high).all()
    result = minimize_qp(H, c, A, low, high, np.array([-INF, -4.0, -4.0]), np.full(3, 4.0))
    assert result.status is QPStatus.LOCAL_MINIMIZER
    assert result.violation <= 1e-9


@pytest.mark.slow
@settings(max_examples=200, deadline=None)
@given(seed=st.integers(0, 10**9))
def test_no_edge_of_nearly_parallel_rows_goes_down_from_a_minimizer(seed):
    """In the plane a cone has two edges, along rows that are active: its rows are compared in fractions."""
    H, c, A, low, high, *box = nearly_parallel(seed, 2)
    result = minimize_qp(H, c, A, low, high, *box)
    if result.status is not QPStatus.LOCAL_MINIMIZER:
        return
    G, low, high = constraints(A, low, high, *box)
    values, slope = G @ result.x, H @ result.x + c
    outwards = [*G[high - values <= 2e-9], *-G[values - low <= 2e-9]]
    rows = [[Fraction(entry) for entry in row] for row in outwards if row.any()]
    edges = [(-s * row[1], s * row[0]) for row in rows for s in (-1, 1)] or [tuple(map(Fraction, -slope))]
    for edge in edges:
        if all(row[0] * edge[0] + row[1] * edge[1] <= 0 for row in rows):
            d = np.array(edge, float)
            assert slope @ d >= -1e-6 * np.linalg.norm(d)


def assert_separates(G, low, high, y):
    """Farkas: [I; A]ᵀy = 0 and the bounds that y uses sum to more than zero."""
    assert y is not None
    used = np.where(y > 0.0, low, high)[y != 0.0]
    assert_allclose(G.T @ y, 0.0, atol=1e-9 * np.abs(y).sum())
    assert float(y[y != 0.0] @ used) > 1e-9 * np.abs(y).sum()


def assert_ray(H, c, G, low, high, result):
    """A feasible x, ray a recession direction, objective quadratic to -inf or linear to -inf."""
    d, x = result.ray, result.x
    assert d is not None
    assert np.all(G @ x >= low - 1e-8)
    assert np.all(G @ x <= high + 1e-8)
    assert np.all((G @ d)[np.isfinite(low)] >= -1e-9 * np.abs(d).max())
    assert np.all((G @ d)[np.isfinite(high)] <= 1e-9 * np.abs(d).max())
    curvature, slope = d @ H @ d, (H @ x + c) @ d
    assert curvature < -1e-9 or (abs(curvature) < 1e-12 and slope < -1e-9)


@pytest.mark.parametrize("seed", range(40))
def test_the_value_is_one_of_all_first_order_values(seed):
    """All working sets enumerated, n <= 5."""
    H, c, A, cl, cu, bl, bu = random_qp(seed)
    A, cl, cu = A[:2], cl[:2], cu[:2]
    bl, bu = np.maximum(bl, -3.0), np.minimum(bu, 5.0)
    result = minimize_qp(H, c, A, cl, cu, bl, bu)
    values = first_order_values(H, c, A, cl, cu, bl, bu)
    if result.status is QPStatus.INFEASIBLE:
        assert values.size == 0
    else:
        assert result.status is QPStatus.LOCAL_MINIMIZER
        assert np.abs(values - result.objective).min() < 1e-8


@pytest.mark.parametrize("seed", range(30))
def test_convex_programmes_reach_the_least_value_of_all_working_sets(seed):
    H, c, A, cl, cu, bl, bu = random_qp(seed)
    H = H @ H
    A, cl, cu = A[:2], cl[:2], cu[:2]
    result = minimize_qp(H, c, A, cl, cu, np.maximum(bl, -3.0), np.minimum(bu, 5.0))
    values = first_order_values(H, c, A, cl, cu, np.maximum(bl, -3.0), np.minimum(bu, 5.0))
    if values.size:
        assert_allclose(result.objective, values.min(), atol=1e-8)


@pytest.mark.parametrize("seed", range(30))
def test_infeasibility_agrees_with_linear_programming(seed):
    rng = np.random.default_rng(seed)
    A = rng.integers(-2, 3, (5, 3)).astype(float)
    cl = rng.integers(-1, 3, 5).astype(float)
    result = minimize_qp(-np.eye(3), np.ones(3), A, cl, cl + 2.0, np.full(3, -1.0), np.full(3, 1.0))
    feasible = linprog(np.zeros(3), np.vstack([A, -A]), np.concatenate([cl + 2.0, -cl]), bounds=(-1, 1)).status == 0
    assert (result.status is QPStatus.INFEASIBLE) == (not feasible)


@pytest.mark.parametrize("seed", range(20))
def test_units_of_variables_rows_and_objective_change_no_answer(seed):
    """The equilibration removes powers of two, save where a factor is a tie of rounding: same status, same value."""
    H, c, A, cl, cu, bl, bu = random_qp(seed)
    rng = np.random.default_rng(seed)
    D, E = 4.0 ** rng.integers(-6, 7, c.size), 2.0 ** rng.integers(-12, 13, cl.size)
    plain = minimize_qp(H, c, A, cl, cu, bl, bu)
    scaled = minimize_qp(
        1024.0 * D[:, None] * H * D, 1024.0 * D * c, E[:, None] * A * D, E * cl, E * cu, bl / D, bu / D
    )
    assert scaled.status is plain.status
    if plain.status is QPStatus.LOCAL_MINIMIZER and np.linalg.eigvalsh(H)[0] > -1e-12:
        assert_allclose(scaled.objective, 1024.0 * plain.objective, rtol=1e-8, atol=1e-8)


@pytest.mark.parametrize("seed", range(20))
def test_order_of_variables_and_rows_changes_no_status_and_no_convex_value(seed):
    H, c, A, cl, cu, bl, bu = random_qp(seed)
    H = H @ H
    rng = np.random.default_rng(seed)
    v, r = rng.permutation(c.size), rng.permutation(cl.size)
    plain = minimize_qp(H, c, A, cl, cu, bl, bu)
    moved = minimize_qp(H[np.ix_(v, v)], c[v], A[np.ix_(r, v)], cl[r], cu[r], bl[v], bu[v])
    assert moved.status is plain.status
    if plain.status is QPStatus.LOCAL_MINIMIZER:
        assert_allclose(moved.objective, plain.objective, atol=1e-8)


def test_scaling_off_gives_the_same_minimizer():
    H, c = np.array([[2.0, 0.5], [0.5, 1.0]]), np.array([1.0, -3.0])
    for scale in (True, False):
        result = minimize_qp(H, c, options=QPOptions(scale=scale))
        assert_allclose(result.x, np.linalg.solve(H, -c), rtol=1e-12)


@pytest.mark.parametrize("unit", [1.0, 1e-7, 1e-12])
def test_equalities_with_tiny_right_hand_sides_are_met_to_their_own_size(unit):
    """The least u·p with u = M p + q, u, p >= 0: the complementarity problem, where u is in small units."""
    n = 12
    x = np.linspace(-1.0, 1.0, n)
    M = np.exp(-np.abs(x[:, None] - x)) + np.eye(n)
    q = x**2 - 0.4
    H = np.block([[np.zeros((n, n)), np.eye(n)], [np.eye(n), np.zeros((n, n))]])
    A = np.hstack([np.eye(n), -unit * M])
    result = minimize_qp(H, np.zeros(2 * n), A, unit * q, unit * q, np.zeros(2 * n))
    u, p = result.x[:n] / unit, result.x[n:]
    assert result.status is QPStatus.LOCAL_MINIMIZER
    assert_allclose(u, M @ p + q, atol=1e-12)
    assert_allclose(np.minimum(u, p), 0.0, atol=1e-12)


def test_minus_xy_over_the_quadrant_is_unbounded_from_its_dead_point():
    """At 0 the gradient and all multipliers vanish; along (1, 1) the objective is -t²."""
    result = minimize_qp(np.array([[0.0, -1.0], [-1.0, 0.0]]), np.zeros(2), bl=np.zeros(2))
    assert result.status is QPStatus.UNBOUNDED
    assert_allclose(result.ray / result.ray[0], [1.0, 1.0])


def test_xy_over_the_quadrant_has_its_minimizer_at_the_dead_point():
    """On the quadrant xy >= 0: copositive though indefinite."""
    result = minimize_qp(np.array([[0.0, 1.0], [1.0, 0.0]]), np.zeros(2), bl=np.zeros(2))
    assert result.status is QPStatus.LOCAL_MINIMIZER
    assert_allclose(result.weakly_active, [0, 1])
    assert result.inertia == (1, 0, 1)


def test_dead_point_of_minus_xy_in_a_box_is_left_for_the_corner():
    """-xy over [0, 1] x [0, 2] has its least value -2 at (1, 2)."""
    result = minimize_qp(np.array([[0.0, -1.0], [-1.0, 0.0]]), np.zeros(2), bl=np.zeros(2), bu=np.array([1.0, 2.0]))
    assert_allclose(result.x, [1.0, 2.0])


def test_saddle_without_constraints_is_unbounded_along_the_negative_eigenvector():
    result = minimize_qp(np.diag([1.0, -1.0]), np.zeros(2))
    assert result.status is QPStatus.UNBOUNDED
    assert_allclose(np.abs(result.ray), [0.0, 1.0], atol=1e-12)
    assert result.reduced_inertia_start == (1, 0, 1)


def test_flat_direction_with_a_slope_is_an_unbounded_ray():
    result = minimize_qp(np.diag([1.0, 0.0]), np.array([0.0, -1.0]), bl=np.zeros(2))
    assert result.status is QPStatus.UNBOUNDED
    assert_allclose(result.ray, [0.0, 1.0], atol=1e-12)


def test_a_variable_that_a_row_holds_hides_no_falling_cone():
    """At (-2, -2, 0) the gradient is zero; dHd falls where d2/d1 is from 1 to 1 + 1e-7/2, and d3 = 0 by a row.

    The units of the third variable make its terms a million times larger than those of the others.
    """
    columns, rise = np.array([10.0, 1e-5, 1e3]), 1e5
    H = rise * np.array([[2.0, 1.0, 1.0], [1.0, -4.0, -3.0], [1.0, -3.0, 0.0]]) * np.outer(columns, columns)
    A = np.array(
        [[-2, 2, 0], [-2e7, 19999999, 0], [0, 0, 2], [-1e7, -2e7, -1], [2, 0, 0], [-19999999, 2e7, 0]]
    )  # fmt: skip
    low, high = [-INF, 2.0, 0.0, -INF, -INF, -6.0], [INF, 5.0, 0.0, INF, -4.0, INF]
    upper = np.array([-2.0, -2.0, INF]) / columns
    result = minimize_qp(H, rise * columns * [6.0, -6.0, -4.0], A * columns, low, high, [-INF] * 3, upper)
    x, y, _ = result.x * columns
    assert result.status is not QPStatus.LOCAL_MINIMIZER or (x + 2) ** 2 + (y + 2) ** 2 > 1e-12


@pytest.mark.parametrize("size", [5, 8])
def test_the_horn_form_is_copositive_and_the_bounded_search_states_when_it_stops(size):
    """Horn's form (Hall and Newman 1963) is copositive, but not a sum of a semidefinite and a nonnegative one."""
    row = np.array([1.0, -1.0, 1.0, 1.0, -1.0])
    H = np.eye(size)
    H[:5, :5] = [np.roll(row, i) for i in range(5)]
    proved = minimize_qp(H, np.zeros(size), bl=np.zeros(size))
    assert proved.status is QPStatus.LOCAL_MINIMIZER
    stopped = minimize_qp(H, np.zeros(size), bl=np.zeros(size), options=QPOptions(search=2))
    assert stopped.status is QPStatus.UNDECIDED


BEALE = (
    [-0.75, 150.0, -0.02, 6.0],
    [[0.25, -60.0, -0.04, 9.0], [0.5, -90.0, -0.02, 3.0], [0.0, 0.0, 1.0, 0.0]],
    [0.0, 0.0, 1.0],
    -0.05,
)
"""Beale, Naval Research Logistics Quarterly 2 (1955) 269-275; optimum -1/20."""

CHVATAL = (
    [-10.0, 57.0, 9.0, 24.0],
    [[0.5, -5.5, -2.5, 9.0], [0.5, -1.5, -0.5, 1.0], [1.0, 0.0, 0.0, 0.0]],
    [0.0, 0.0, 1.0],
    -1.0,
)
"""Chvatal, Linear Programming (1983), page 31; optimum -1."""

KUHN = (
    [-2.0, -3.0, 1.0, 12.0],
    [[-2.0, -9.0, 1.0, 9.0], [1.0 / 3.0, 1.0, -1.0 / 3.0, -2.0], [2.0, 3.0, -1.0, -12.0]],
    [0.0, 0.0, 2.0],
    -2.0,
)
"""Kuhn's example, in Balinski and Tucker, SIAM Review 11 (1969) 347-377, with its bound on the objective: -2."""


@pytest.mark.parametrize("cycling", [BEALE, CHVATAL, KUHN], ids=["Beale", "Chvatal", "Kuhn"])
def test_cycling_linear_programmes_end_at_their_published_optimum(cycling):
    c, A, cu, best = cycling
    result = minimize_qp(np.zeros((4, 4)), c, A, None, cu, np.zeros(4))
    assert result.status is QPStatus.LOCAL_MINIMIZER
    assert_allclose(result.objective, best, atol=1e-12)


@pytest.mark.parametrize("seed", range(20))
def test_a_very_degenerate_vertex_is_left_or_proved_optimal(seed):
    """60 rows through the origin in 6 dimensions, no bound elsewhere: the answer agrees with linear programming."""
    rng = np.random.default_rng(seed)
    A, c = rng.integers(-2, 3, (60, 6)).astype(float), rng.standard_normal(6)
    A[:, 0] = np.abs(A[:, 0])  # the cone holds (1, 0, ..., 0)
    result = minimize_qp(np.zeros((6, 6)), c, A, np.zeros(60), None, np.full(6, -1.0), np.full(6, 1.0))
    assert result.status is QPStatus.LOCAL_MINIMIZER
    assert_allclose(result.objective, linprog(c, -A, np.zeros(60), bounds=(-1, 1)).fun, atol=1e-9)


@pytest.mark.parametrize("seed", range(30))
def test_a_warm_start_from_the_solution_changes_nothing(seed):
    rng = np.random.default_rng(seed)
    B, c, A = rng.standard_normal((8, 8)), rng.standard_normal(8), rng.standard_normal((4, 8))
    data = B + B.T, c, A, np.full(4, -1.0), np.full(4, 1.0), np.full(8, -1.0), np.full(8, 1.0)
    cold = minimize_qp(*data)
    warm = minimize_qp(*data, x0=cold.x, working_set=cold.working_set)
    assert cold.working_set_changes > 0
    assert warm.working_set_changes == 0
    assert warm.status is QPStatus.LOCAL_MINIMIZER
    assert_allclose(warm.x, cold.x, atol=1e-12)


@pytest.mark.parametrize("seed", range(10))
def test_one_nonpositive_eigenvalue_at_most_and_an_objective_that_never_rises(seed):
    rng = np.random.default_rng(seed)
    B, c, A = rng.standard_normal((20, 20)), rng.standard_normal(20), rng.standard_normal((10, 20))
    lines = []
    result = minimize_qp(
        B + B.T,
        c,
        A,
        np.full(10, -1.0),
        np.full(10, 1.0),
        np.full(20, -1.0),
        np.full(20, 1.0),
        options=QPOptions(log=lines.append),
    )
    assert tuple(lines) == result.log
    assert len(lines) == result.iterations == result.phase_one_iterations + result.phase_two_iterations
    values = np.array([line.value for line in lines if line.phase == 2])
    assert np.all(np.diff(values) <= 1e-9)
    assert {line.nonpositive for line in lines} <= {0, 1}
    assert "step" in str(lines[0])
    eigenvalues = np.linalg.eigvalsh(B + B.T)
    assert result.inertia == (int(np.sum(eigenvalues > 0)), 0, int(np.sum(eigenvalues < 0)))
    assert result.reduced_inertia_end[2] == 0


def test_the_iteration_limit_is_a_status_and_not_a_claim():
    result = minimize_qp(-np.eye(6), np.ones(6), bl=-np.ones(6), bu=np.ones(6), options=QPOptions(max_iterations=2))
    assert result.status is QPStatus.ITERATION_LIMIT
    assert result.iterations == 2


def test_no_iteration_is_needed_to_know_an_optimal_start():
    """(1, -1) is the minimizer of a bowl inside its box; one iteration less than none is asked for and none is used."""
    H, c = np.array([[2.0, 1.0], [1.0, 3.0]]), np.array([-1.0, 2.0])
    result = minimize_qp(H, c, x0=[1.0, -1.0], bl=[-2.0, -2.0], options=QPOptions(max_iterations=0))
    assert result.status is QPStatus.LOCAL_MINIMIZER
    assert result.iterations == 0
    away = minimize_qp(H, c, x0=[0.0, 0.0], bl=[-2.0, -2.0], options=QPOptions(max_iterations=0))
    assert away.status is QPStatus.ITERATION_LIMIT


@pytest.mark.parametrize("coupling", [4e-3, 0.0])
@pytest.mark.parametrize("curvature", [2e-6, 2e-10, 2e-12, 2e-16, 2e-24])
def test_a_small_curvature_is_distinguished_from_zero_by_its_own_terms(coupling, curvature):
    """½ x'Hx + c'x at (0, t) is curvature (t²/2 - 5e10 t), least at t = 5e10; the multiplier of x1 is coupling t."""
    H = np.array([[2.0, coupling], [coupling, curvature]])
    result = minimize_qp(H, np.array([0.0, -5e10 * curvature]), bl=np.zeros(2))
    assert result.status is QPStatus.LOCAL_MINIMIZER
    assert_allclose(result.x, [0.0, 5e10], rtol=1e-12)


@pytest.mark.parametrize("seed", range(10))
def test_variables_of_very_different_size_are_judged_each_by_its_own(seed):
    """A complementarity problem in squares: |u - M p - q|² + u'p >= 0 is 0 at its solution alone; M is about 1e-6."""
    rng = np.random.default_rng(seed)
    n, small = 9, 1e-6
    x = np.linspace(-1.0, 1.0, n)
    M = small * (np.exp(-np.abs(x[:, None] - x)) + np.eye(n))
    p = np.where(np.abs(x) < 0.6, rng.uniform(1e4, 2e5, n), 0.0)
    u = np.where(p > 0.0, 0.0, rng.uniform(0.05, 0.2, n))
    q = u - M @ p
    G = np.hstack([np.eye(n), -M])
    H = 2.0 * G.T @ G + np.block([[np.zeros((n, n)), np.eye(n)], [np.eye(n), np.zeros((n, n))]])
    result = minimize_qp(H, -2.0 * G.T @ q, bl=np.zeros(2 * n))
    assert result.status is QPStatus.LOCAL_MINIMIZER
    assert_allclose(result.x[:n], u, atol=1e-8 * u.max())
    assert_allclose(result.x[n:], p, atol=1e-8 * p.max())


@pytest.mark.parametrize("noise", [0.0, 3e-16])
def test_noise_in_a_column_hides_no_contradiction(noise):
    """x1 + x2 = 1 and x1 + x2 + noise x3 = 2 with x3 + x4 = 0: only x3 of 3e15 could reconcile the two."""
    A = np.array([[1.0, 1.0, 0.0, 0.0], [1.0, 1.0, noise, 0.0], [0.0, 0.0, 1.0, 1.0]])
    b = np.array([1.0, 2.0, 0.0])
    result = minimize_qp(np.eye(4), np.zeros(4), A, b, b)
    assert result.status is (QPStatus.NUMERICAL_FAILURE if noise else QPStatus.INFEASIBLE)


@pytest.mark.parametrize("small", [1e-3, 1e-11, 1e-30])
def test_inertia_counts_small_eigenvalues(small):
    """Inertia does not change with the units of a variable (Sylvester): diag(1, ±small) and a rank-one matrix."""
    for sign, expected in ((1.0, (2, 0, 0)), (-1.0, (1, 0, 1))):
        H = np.diag([1.0, sign * small])
        result = minimize_qp(H, np.zeros(2), bl=[-1.0, -1.0], bu=[1.0, 1.0])
        assert result.inertia == expected
    v = np.array([1.0, small, 3.0])
    result = minimize_qp(np.outer(v, v), np.zeros(3))
    assert result.inertia == (1, 2, 0)
    assert result.reduced_inertia_end == (1, 2, 0)


def test_the_result_has_one_line_and_logs_the_objective_in_the_units_of_the_data():
    result = minimize_qp(1e6 * np.eye(2), [-4e6, 1e6], bl=[0.0, 0.0])
    phases = f"{result.phase_one_iterations} + {result.phase_two_iterations}"
    assert str(result) == f"local minimizer: objective -8000000 after {phases} iterations (phase 1 + phase 2)"
    assert result.log[-1].value == pytest.approx(-8e6)
    assert "LogLine" not in repr(result)


def test_a_bound_of_1e20_is_none():
    """Least x² - 2x + y over y >= 0 with all other bounds of 1e20 or 1e30 given as numbers."""
    H, c = np.diag([2.0, 0.0]), np.array([-2.0, 1.0])
    result = minimize_qp(H, c, np.eye(2), [-1e20, -1e30], [1e20, 1e25], [-1e20, 0.0], [1e30, 1e20])
    assert_allclose(result.x, [1.0, 0.0], atol=1e-12)
    unbounded = minimize_qp(H, -c, np.eye(2), [-1e20, -1e30], [1e20, 1e25])
    assert unbounded.status is QPStatus.UNBOUNDED


def test_a_start_outside_the_bounds_is_moved_to_them():
    result = minimize_qp(np.eye(2), np.zeros(2), bl=[1.0, -1.0], bu=[2.0, 1.0], x0=[9.0, -9.0])
    assert isinstance(result, QPResult)
    assert_allclose(result.x, [1.0, 0.0], atol=1e-12)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"H": [[1.0, 2.0], [0.0, 1.0]]}, "not symmetric"),
        ({"H": [[1.0]]}, "H has shape"),
        ({"H": [[1.0, 2.0], [3.0]]}, "H cannot be read as an array: .*rows of equal length"),
        ({"c": ["a", "b"]}, "c must contain real numbers; found texts"),
        ({"bl": [1j, 0.0]}, "bl must contain real numbers; found complex numbers"),
        ({"c": [np.nan, 0.0]}, "not finite"),
        ({"bl": [2.0, 0.0], "bu": [1.0, 1.0]}, "exceeds"),
        ({"cl": [0.0]}, "without A"),
        ({"A": [[1.0]]}, "columns"),
        ({"bl": [INF, 0.0]}, "give a number"),
        ({"x0": [1.0]}, "x0 has shape"),
        ({"working_set": [3, 0]}, "working_set"),
        ({"options": {"search": 3}}, "options is a dict"),
        ({"H": np.eye(2) * 1j}, "H must contain real numbers; found complex numbers"),
        ({"H": np.zeros((0, 0)), "c": []}, "c is empty"),
    ],
)
def test_invalid_input_is_refused_with_the_reason(change, message):
    with pytest.raises(ProblemError, match=message):
        minimize_qp(**({"H": np.eye(2), "c": np.zeros(2)} | change))


@pytest.mark.parametrize(
    ("option", "value"),
    [
        ("optimality_tolerance", 0.0), ("optimality_tolerance", -1e-9), ("feasibility_tolerance", np.nan),
        ("feasibility_tolerance", "1e-9"), ("search", -1), ("search", 1.5), ("max_iterations", "a"),
        ("max_iterations", -1), ("log", True), ("scale", 2),
    ],
)  # fmt: skip
def test_invalid_options_are_refused_when_they_are_made(option, value):
    with pytest.raises(ProblemError, match=f"^{option} is {value!r}: give "):
        QPOptions(**{option: value})


@pytest.mark.parametrize("far", [1e6, 1e9, 1e12, 1e20])
def test_a_far_bound_takes_no_digit_from_the_near_one(far):
    """Least x1 + x2 with 1 <= x1 + x2 <= far, x >= 0: 1, however far the other bound is."""
    result = minimize_qp(np.zeros((2, 2)), [1.0, 1.0], [[1.0, 1.0]], [1.0], [far], [0.0, 0.0])
    assert result.status is QPStatus.LOCAL_MINIMIZER
    assert_allclose(result.objective, 1.0, rtol=1e-9)


@pytest.mark.parametrize("seed", range(60))
def test_rows_satisfied_at_the_start_do_not_stop_the_search(seed):
    """Complementarity with a kernel matrix and whole numbers: many rows hold at 0; M is definite, so 0 is the least."""
    rng = np.random.default_rng(seed)
    k = int(rng.integers(4, 24))
    t = np.linspace(-1.0, 1.0, k)
    M = np.exp(-float(rng.integers(1, 11)) * np.abs(t[:, None] - t))
    q, identity, zero = np.round(rng.standard_normal(k)), np.eye(k), np.zeros((k, k))
    H = np.block([[zero, identity], [identity, zero]])
    result = minimize_qp(H, np.zeros(2 * k), np.hstack([identity, -M]), q, q, np.zeros(2 * k))
    assert result.status is QPStatus.LOCAL_MINIMIZER
    assert_allclose(result.objective, 0.0, atol=1e-12)


def test_a_variable_that_nothing_moves_is_a_minimizer():
    assert minimize_qp([[0.0]], [0.0]).status is QPStatus.LOCAL_MINIMIZER


def test_multipliers_of_rounding_hold_no_saddle():
    """At 0 with c = 0 all multipliers vanish; along d, which the active constraints allow, the form falls."""
    H = np.array([[-2.0, 2.0, 0.0], [2.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    A = np.array([[-1.0, 1.0, -2.0], [-1.0, -1.0, 1.0], [-1.0, 1.0, -2.0], [0.0, 0.0, 0.0]])
    d = np.array([-0.734, 0.385, 0.5595])
    assert np.all((A @ d)[:3] >= -1e-12)
    assert d @ H @ d < -2.0
    result = minimize_qp(H, np.zeros(3), A, np.zeros(4), [0.0, INF, INF, 0.0], [-INF, 0.0, 0.0], x0=[-2.0, 2.0, 0.0])
    assert result.status is QPStatus.UNBOUNDED


def test_a_dead_point_is_left_only_where_the_objective_falls():
    """x1 and x3 have 9e-8 and 2e-10 of room: the least is at x2 = -2, and no walk goes to and fro between the ends."""
    H = [[-4.0, -2.0, 2.0], [-2.0, -1.0, 1.0], [2.0, 1.0, -1.0]]
    result = minimize_qp(H, [0.0, 1.0, 2.0], bl=[0.0, -2.0, 0.0], bu=[8.8e-8, 0.0, 2.06e-10])
    assert result.status is QPStatus.LOCAL_MINIMIZER
    assert_allclose(result.x, [0.0, -2.0, 0.0], atol=1e-9)


def test_a_start_far_away_is_no_obstacle():
    """Least |x|²/2 + x1 + x2 with 1 <= x1 + x2 <= 2 is at (1/2, 1/2), from 1e20 too."""
    result = minimize_qp(np.eye(2), [1.0, 1.0], [[1.0, 1.0]], [1.0], [2.0], x0=[1e20, 1e20])
    assert result.status is QPStatus.LOCAL_MINIMIZER
    assert_allclose(result.objective, 1.25, rtol=1e-6)


def test_an_entry_of_1e_12_in_a_row_counts():
    """x1 + 1e-12 x2 in [-2, 1] with x1 <= 1: x2 grows for ever as x1 falls; with ½x1² to pay, until x1 = -1e12."""
    row, bounds = [1.0, 1e-12], ([-2.0], [1.0])
    free = minimize_qp(np.zeros((2, 2)), [0.0, -1.0], [row], *bounds, bu=[1.0, INF])
    assert free.status is QPStatus.UNBOUNDED
    paid = minimize_qp(np.diag([1.0, 0.0]), [0.0, -1.0], [row], *bounds)
    assert paid.status is QPStatus.LOCAL_MINIMIZER
    assert_allclose(paid.x, [-1e12, 1e24], rtol=1e-9)


def test_tiny_and_huge_entries_neither_vanish_nor_overflow():
    """1e-170 x1 >= 1e-170 asks for x1 >= 1; a form of 1e308 has its least value where the one of size one has."""
    tiny = minimize_qp(np.eye(2), [1.0, 1.0], [[1e-170, 0.0]], [1e-170])
    assert tiny.status is QPStatus.LOCAL_MINIMIZER
    assert_allclose(tiny.x, [1.0, -1.0], rtol=1e-9)
    huge = minimize_qp(1e307 * np.eye(2), [1e307, -1e307])
    assert huge.status is QPStatus.LOCAL_MINIMIZER
    assert_allclose(huge.x, [-1.0, 1.0], rtol=1e-9)


@pytest.mark.parametrize("gap", [1e-13, 1e-15, 0.0])
def test_rows_that_are_nearly_one_end_with_a_status_and_numbers(gap):
    """Two rows apart by rounding: whatever is claimed, x has numbers and meets the first row."""
    rng = np.random.default_rng(0)
    a = rng.standard_normal(4)
    A = np.vstack([a, a + gap * rng.standard_normal(4)])
    result = minimize_qp(-np.eye(4), np.ones(4), A, [1.0, 1.0], [1.0, 1.0], np.full(4, -5.0), np.full(4, 5.0))
    assert np.isfinite(result.x).all()
    assert result.status is QPStatus.LOCAL_MINIMIZER
    assert_allclose(A[0] @ result.x, 1.0, atol=1e-8)


@pytest.mark.parametrize("power", [23, 28, 35, 40])
@pytest.mark.parametrize("kind", ["curved", "saddle", "concave", "linear"])
def test_a_function_that_turns_far_away_is_not_called_unbounded(kind, power):
    """On (1 + e) x1 = x2 the first is -(2 + e) x1 + e² x1²/2; the others are bounded, as is 0 <= x1 <= 1/e."""
    apart = 2.0**-power
    if kind == "curved":
        result = minimize_qp([[1, -1], [-1, 1]], [-1, -1], [[1 + apart, -1]], [0], [0])
    else:
        H, c = {"saddle": ([[0, -1], [-1, 0]], 0), "concave": (-np.eye(2), 0), "linear": (np.zeros((2, 2)), -1)}[kind]
        result = minimize_qp(H, [c, c], [[1, -1], [1 + apart, -1]], [-1, -INF], [INF, 0], [0, 0])
    assert result.status is not QPStatus.UNBOUNDED


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 10**9))
def test_null_directions_of_products_are_rays(seed):
    """H = B Bᵀ and rows are rounded, and the objective falls along what both leave free."""
    rng = np.random.default_rng(seed)
    n = rng.integers(3, 30)
    rank = rng.integers(1, n - 1)
    B, A = rng.standard_normal((n, rank)), rng.standard_normal((rng.integers(1, n - rank), n))
    result = minimize_qp(B @ B.T, rng.standard_normal(n), A, -np.ones(len(A)), -np.ones(len(A)))
    assert result.status is QPStatus.UNBOUNDED


@given(st.integers(0, 2**32 - 1), st.integers(2, 6), st.booleans())
def test_assignments_are_minimized(seed, n, fractional):
    """Vertices at which many multipliers are zero; HiGHS has the same cost, and the vertices are exact."""
    rng = np.random.default_rng(seed)
    A = np.vstack([np.kron(np.eye(n), np.ones(n)), np.kron(np.ones(n), np.eye(n))])
    supply = rng.integers(1, 4, n) + 0.0
    sides = np.concatenate([supply, rng.permutation(supply)])
    cost = rng.integers(0, 6, n * n) / (7.0 if fractional else 1.0)
    result = minimize_qp(np.zeros((n * n, n * n)), cost, A, sides, sides, np.zeros(n * n))
    assert result.status is QPStatus.LOCAL_MINIMIZER
    best = linprog(cost, A_eq=A, b_eq=sides, bounds=(0, None))
    assert result.objective == pytest.approx(best.fun, rel=1e-12, abs=1e-12)


def test_multipliers_that_are_rounding_of_larger_ones_hold_no_point():
    """Rows that are parallel to 2^-21: with multipliers of 2e17 any gradient seems to vanish, at an objective of -42.9.

    The vertex between row 0 and the side 5 - 2^-21 · 5 of row 2 has multipliers 2 and 2e-7, and the least objective.
    """
    e, far = 2.0**-21, np.inf
    H = np.array([[6.0, 0, 3, 3], [0, 2, -1, 1], [3, -1, 5, 4], [3, 1, 4, 5]])
    c = np.array([29.000000469386464, -4.999999765306711, 36.999999530613195, 33.99999953061365])
    A = np.array([[2, 1, -2, -2], [-1, 2, 1, 2], [-2 + e, -1, 2 + 2 * e, 2 - 2 * e], [-2, -1, 2, 2], [-2, -1, 2, 2]])
    lower, upper = [5.0, -2, -far, -5, -5], [5.0, -1, -5 - 5 * e, far, far]
    result = minimize_qp(H, c, A, lower, upper, [-far, 0, -far, -far], [far, 2, far, far])
    if result.status is QPStatus.LOCAL_MINIMIZER:
        assert result.objective == pytest.approx(-140.5, abs=1e-5)


SIZES = [0.0, 5e-324, 1e-310, 1e-300, 1e-20, 1.0, 1e19, 1e100]


@pytest.mark.parametrize("seed", range(100))
def test_numbers_of_any_size_have_an_answer_or_an_error_and_no_warning(seed: int):
    """Denormal numbers beside huge ones; warnings are errors in tests."""
    rng = np.random.default_rng(seed)
    n, m = int(rng.integers(1, 4)), int(rng.integers(0, 4))

    def drawn(*shape: int) -> np.ndarray:
        return rng.choice(SIZES, shape) * rng.choice([-1, 1], shape)

    H, rows = np.triu(drawn(n, n)), drawn(m)
    with suppress(ProblemError):
        minimize_qp(H + H.T, drawn(n), drawn(m, n), rows, rows, -np.abs(drawn(n)), np.abs(drawn(n)))


def test_numbers_that_double_precision_cannot_bring_together_are_refused():
    with pytest.raises(ProblemError, match="too far apart for double precision; choose other units"):
        minimize_qp(np.diag([1e100, 5e-324]), [5e-324, 1e100], [[5e-324, 1e100]], [1e100], [1e100], [0, 0], [1, 5e-324])


@given(st.integers(0, 2**32 - 1), st.sampled_from([1, 2, 1000]))
@settings(max_examples=60)
def test_ranges_as_thin_as_rounding_have_an_answer(seed, width):
    """Bounds that differ by units in the last place, as 0.3 and 0.1 + 0.2: rounding decides which one is reached."""
    rng = np.random.default_rng(seed)
    n, m = int(rng.integers(1, 7)), int(rng.integers(1, 5))
    A, x = rng.integers(-3, 4, (m, n)) + 0.0, 0.1 * rng.integers(0, 4, n)
    lower = A @ x
    cost = A.T @ rng.integers(-3, 4, m) + rng.integers(0, 2, n)
    result = minimize_qp(np.zeros((n, n)), cost, A, lower, lower + width * np.spacing(np.abs(lower)), np.zeros(n))
    best = linprog(cost, A_eq=A, b_eq=lower, bounds=(0, None))
    assert result.status is QPStatus.LOCAL_MINIMIZER
    assert result.objective == pytest.approx(best.fun, abs=1e-8)


def test_an_end_without_a_minimizer_shows_no_objective_as_if_it_were_one():
    """An interval that is empty by 2, and a line that falls without end."""
    nothing, falls = np.zeros((1, 1)), np.array([-1.0])
    empty = minimize_qp(nothing, falls, [[1.0], [1.0]], [5.0, -9.0], [9.0, 3.0], [0.0], [10.0])
    assert str(empty).startswith("infeasible: violation of up to 2 at the nearest point after ")
    assert str(minimize_qp(nothing, falls)).startswith("unbounded: the objective falls without end from 0 after ")
