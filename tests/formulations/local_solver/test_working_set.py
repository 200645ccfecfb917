"""The updated working set and reduced Hessian against what defines them, after many changes."""

from fractions import Fraction

import numpy as np
import pytest
from numpy.testing import assert_allclose

from bemcontact.arrays import exact_remainders, fine_remainders
from bemcontact.formulations.local_solver.factorizations import orthogonal
from bemcontact.formulations.local_solver.phase_two import ReducedHessian
from bemcontact.formulations.local_solver.right_inverse import LARGE, ROOM
from bemcontact.formulations.local_solver.statement import EPS, Statement
from bemcontact.formulations.local_solver.working_set import TEMPORARY, WorkingSet


def statement(seed, n=12, m=10, *, definite):
    """Random data with unit bounds; rows of length one."""
    rng = np.random.default_rng(seed)
    B, A = rng.standard_normal((n, n)), rng.standard_normal((m, n))
    A = A / np.linalg.norm(A, axis=1)[:, None]
    H = B @ B.T + np.eye(n) if definite else B + B.T
    return Statement(H=H, c=rng.standard_normal(n), A=A, lower=-np.ones(n + m), upper=np.ones(n + m))


def start(data, sides):
    """The two parts as phase two makes them."""
    working = WorkingSet(data, np.array(sides, dtype=np.int8))
    hessian = ReducedHessian(data, working.null_space)
    for direction in hessian.left_over.T:
        working.fix(direction, TEMPORARY)
    return working, hessian


def assert_defined(data, working, hessian):
    """W N = I with N the shortest; W Z = 0, ZᵀHZ = I; the pending direction conjugate, of no positive curvature."""
    n, scale = data.c.size, np.abs(data.H).max()
    N, W, Z, free = working.N, working.W, hessian.Z, ~working.held[: data.c.size]
    assert_allclose(working.free, free)
    assert_allclose(W @ N, np.eye(working.size), atol=1e-9)
    assert_allclose(N[free], np.linalg.pinv(W[:, free]), atol=1e-8 * max(1.0, np.abs(N).max(initial=0.0)))
    assert not N[~free].any()
    assert not Z[~free].any()
    real = working.ids[working.ids >= 0]
    assert_allclose(W[working.ids >= 0], data.A[real - n])
    assert working.number == working.size + np.count_nonzero(~free)
    assert_allclose(W @ Z, 0.0, atol=1e-10 * max(1.0, np.abs(Z).max(initial=0.0)))
    assert_allclose(Z.T @ data.H @ Z, np.eye(hessian.size), atol=1e-9)
    directions = hessian.size + (hessian.pending is not None)
    assert directions + working.number == n
    if hessian.pending is not None:
        d = hessian.pending
        assert_allclose(np.linalg.norm(d), 1.0)
        assert_allclose(W @ d, 0.0, atol=1e-10)
        assert_allclose(Z.T @ data.H @ d, 0.0, atol=1e-9 * scale)
        assert d @ data.H @ d <= 1e-12 * scale


def change_at_random(data, working, hessian, rng):
    """Drop or add one constraint, by the rules of the method: an addition if a direction is pending."""
    idle, n = np.flatnonzero(~working.held), data.c.size
    slopes = np.concatenate([np.eye(n), data.A])[idle]
    if hessian.pending is not None:
        hit = int(idle[np.argmax(np.abs(slopes @ hessian.pending))])
    elif working.number and (rng.random() < 0.5 or hessian.size < 2):
        places = np.concatenate([np.flatnonzero(working.held[:n]), n + np.arange(working.size)])
        hessian.enter(working.drop(int(rng.choice(places)))[1])
        return
    else:
        size = np.linalg.norm(slopes @ hessian.Z, axis=1)
        hit = int(rng.choice(idle[size > 0.2 * size.max()]))
    hessian.leave(working.add(hit, int(rng.choice([-1, 1]))))
    if hit < n:
        hessian.clear(hit)


@pytest.mark.parametrize("definite", [True, False])
@pytest.mark.parametrize("seed", range(5))
def test_two_hundred_updates_keep_what_defines_the_factors(seed, definite):
    data = statement(seed, definite=definite)
    rng = np.random.default_rng(seed)
    sides = np.zeros(22)
    sides[[0, 3, 5, 13, 15]] = -1
    working, hessian = start(data, sides)
    assert_defined(data, working, hessian)
    for _ in range(200):
        change_at_random(data, working, hessian, rng)
        assert_defined(data, working, hessian)


def test_rows_of_fixed_variables_need_not_be_stored():
    """More variables than `LARGE`, few of them free at the start: the storage grows, and rows change their places."""
    data, rng = statement(0, LARGE + 20, 30, definite=True), np.random.default_rng(0)
    sides = np.zeros(LARGE + 50)
    sides[: LARGE + 10], sides[-5:] = -1, 1
    working, hessian = start(data, sides)
    for variable in range(2 * ROOM):
        hessian.enter(working.drop(variable)[1])
    assert_defined(data, working, hessian)
    for step in range(300):
        change_at_random(data, working, hessian, rng)
        if step % 20 == 0:
            assert_defined(data, working, hessian)


@pytest.mark.parametrize(("n", "m"), [(12, 10), (LARGE + 20, 90)])
def test_exchanges_at_a_vertex_keep_the_inverse(n, m):
    """One change of N for both the constraint that leaves and the one that enters; N is asked for now and then."""
    data, rng = statement(1, n, m, definite=True), np.random.default_rng(1)
    sides = np.zeros(n + m)
    sides[:n] = -1
    working = WorkingSet(data, sides.astype(np.int8))
    for step in range(300):
        places = np.concatenate([np.flatnonzero(working.held[:n]), n + np.arange(working.size)])
        direction = working.drop(int(rng.choice(places)))[1]
        slopes = np.abs(np.concatenate([direction, data.A @ direction])) * ~working.held
        assert working.add(int(rng.choice(np.flatnonzero(slopes > 0.2 * slopes.max()))), 1) is not None
        if step % 7 == 0:
            free = working.free > 0
            assert_allclose(working.W @ working.N, np.eye(working.size), atol=1e-9)
            assert_allclose(
                working.N[free],
                np.linalg.inv(working.W[:, free]),
                atol=1e-8 * max(1.0, np.abs(working.N).max(initial=0.0)),
            )
            assert not working.N[~free].any()
    assert working.size > 0


@pytest.mark.parametrize("seed", range(5))
def test_multipliers_are_those_of_least_squares(seed):
    """λ minimizes |g - Wᵀλ| over the free variables; the fixed ones take what is left."""
    data = statement(seed, definite=True)
    sides = np.zeros(22)
    sides[[1, 4, 13, 15, 20]] = [-1, 1, 1, -1, 2]
    working, _ = start(data, sides)
    g = np.random.default_rng(seed).standard_normal(12)
    result = working.multipliers(g)
    expected = np.linalg.lstsq(working.W[:, working.free > 0].T, g[working.free > 0], rcond=None)[0]
    assert_allclose(result[12:], expected, atol=1e-12)
    assert_allclose(result[:12], g - working.W.T @ expected, atol=1e-12)
    assert_allclose(working.signs[[1, 4]], [-1.0, 1.0])
    assert sorted(working.signs[12:]) == [-1.0, 0.0, 1.0]


def test_inaccurate_factors_are_corrected_or_computed_again():
    """Of an error of 1e-6 in N the square is left in a direction, the cube in multipliers; one of 1e-5 is mended."""
    data = statement(0, definite=True)
    sides = np.zeros(22)
    sides[[12, 14, 17]] = -1
    g = np.random.default_rng(1).standard_normal(12)
    working, _ = start(data, sides)
    right = working.multipliers(g)
    working.N[:] *= 1.0 + 1e-6
    working.add(3, 1)
    assert not working.sharp
    _, direction = working.drop(12)
    assert_allclose(working.W @ direction, 0.0, atol=1e-11)
    for error in (5e-7, 1e-5):
        working, _ = start(data, sides)
        working.N[:] *= 1.0 + error
        assert_allclose(working.multipliers(g, refined=True), right, atol=1e-14)
    assert_allclose(working.W @ working.N, np.eye(3), atol=1e-14)


@pytest.mark.parametrize("seed", range(20))
def test_a_direction_that_becomes_free_keeps_what_is_held(seed):
    """Rows at small angles cost N digits, and the direction none."""
    rng = np.random.default_rng(seed)
    data = statement(seed, n=8, m=6, definite=True)
    near = data.A[:3] + 10.0 ** -rng.uniform(1.0, 4.0, (3, 1)) * data.A[3:]
    data.A[3:] = near / np.linalg.norm(near, axis=1)[:, None]
    working, _ = start(data, np.zeros(14))
    for _ in range(100):
        outside = np.flatnonzero(~working.held[8:])
        working.add(8 + int(rng.choice(outside)), -1)
        if working.size == 6 or (working.size > 1 and rng.random() < 0.5):
            working.multipliers(data.c)  # as pricing does before a drop
            _, direction = working.drop(8 + int(rng.integers(working.size)))
            assert np.abs(working.W @ direction).max() <= 8 * np.finfo(float).eps


def test_dependent_rows_stay_out_of_the_working_set():
    """Two variables fixed and a row in their span; then two rows of which one is twice the other."""
    fixed = Statement(
        H=np.eye(3),
        c=np.zeros(3),
        A=np.array([[0.6, 0.8, 0.0]]),
        lower=np.zeros(4),
        upper=np.array([1.0, 1.0, 1.0, 0.0]),
    )
    working = WorkingSet(fixed, np.array([-1, -1, 0, 2], dtype=np.int8))
    assert working.size == 0
    assert working.sides.tolist() == [-1, -1, 0, 0]
    assert working.held.tolist() == [True, True, False, False]
    twice = Statement(
        H=np.eye(2), c=np.zeros(2), A=np.array([[1.0, 0.0], [2.0, 0.0]]), lower=np.zeros(4), upper=np.ones(4)
    )
    assert WorkingSet(twice, np.array([0, 0, -1, -1], dtype=np.int8)).size == 1


def test_a_start_in_a_saddle_fixes_the_nonpositive_directions():
    """diag(1, -1, 0) without constraints: one positive direction is free, two are fixed for a while."""
    data = Statement(
        H=np.diag([1.0, -1.0, 0.0]), c=np.zeros(3), A=np.zeros((0, 3)), lower=np.zeros(3), upper=np.ones(3)
    )
    working, hessian = start(data, np.zeros(3))
    assert hessian.size == 1
    assert working.ids.tolist() == [TEMPORARY, TEMPORARY]
    assert working.temporary == 2


def test_the_newton_step_ends_where_the_gradient_on_the_working_set_vanishes():
    data = statement(3, definite=True)
    sides = np.zeros(22)
    sides[[2, 13, 18]] = -1
    working, hessian = start(data, sides)
    x = working.onto(np.zeros(12))
    x = x + hessian.newton(data.H @ x + data.c)
    assert_allclose(working.multipliers(data.H @ x + data.c)[:12][working.free > 0], 0.0, atol=1e-12)
    assert_allclose(x[2], -1.0)
    assert_allclose(data.A[[1, 6]] @ x, -1.0, atol=1e-12)


def test_the_pivoted_factorization_gives_both_spaces():
    """Rank 2 of three rows: bases orthonormal, the range orthogonal to the null space, the rows rebuilt."""
    rows = np.array([[1.0, 2.0, 0.0, 1.0], [0.0, 1.0, 1.0, 0.0], [1.0, 3.0, 1.0, 1.0]])
    Y, Z, T, kept = orthogonal(rows, 1e-9)
    assert (Y.shape, Z.shape, kept.size) == ((4, 2), (4, 2), 2)
    Q = np.hstack([Y, Z])
    assert_allclose(Q.T @ Q, np.eye(4), atol=1e-15)
    assert_allclose(Y @ np.triu(T), rows[kept].T, atol=1e-15)
    assert_allclose(rows @ Z, 0.0, atol=1e-15)
    alone, none, *_ = orthogonal(rows, 1e-9, complete=False)
    assert_allclose(alone, Y, atol=1e-15)
    assert none.shape == (4, 0)


@pytest.mark.parametrize("level", [1e-3, 1e-5, 1e-7])
@pytest.mark.parametrize("seed", range(4))
def test_a_point_on_nearly_parallel_rows_has_all_its_digits(seed, level):
    """Rows parallel up to the level, on which whole numbers meet: each component is that of the exact point."""
    rng, n = np.random.default_rng(seed), 4
    first, point = rng.integers(-2, 3, (2, n)).astype(float) + np.eye(2, n), rng.integers(-3, 4, n).astype(float)
    A = np.vstack([first, np.rint(first / level) + rng.integers(-1, 2, (2, n)) + 2 * np.eye(2, n, 2)])
    bounds = np.concatenate([np.full(n, np.inf), A @ point])
    data = Statement(H=np.eye(n), c=np.zeros(n), A=A, lower=-bounds, upper=bounds)
    working = WorkingSet(data, np.array([0] * n + [1] * n, dtype=np.int8))
    assert working.size == n
    assert_allclose(working.onto(working.onto(rng.standard_normal(n))), point, rtol=0.0, atol=1e-14)


@pytest.mark.parametrize("seed", range(10))
def test_remainders_are_those_of_fractions(seed):
    """Sizes from 1e-12 to 1e12 that cancel: the nearest number to the remainder in fractions."""
    rng = np.random.default_rng(seed)
    rows, x = rng.standard_normal((3, 7)) * 10.0 ** rng.integers(-6, 7, (3, 7)), 10.0 ** rng.uniform(-6, 6, 7)
    right = rows @ x
    exact = [
        Fraction(b) - sum(Fraction(a) * Fraction(v) for a, v in zip(row, x.tolist(), strict=True))
        for b, row in zip(right.tolist(), rows.tolist(), strict=True)
    ]
    assert exact_remainders(right, rows, x).tolist() == [float(value) for value in exact]
    terms = np.abs(right) + np.abs(rows) @ np.abs(x)
    off = [
        abs(Fraction(found) - value)
        for found, value in zip(fine_remainders(right, rows, x).tolist(), exact, strict=True)
    ]
    half_a_digit = EPS / 2 * np.abs(np.array(exact, float))
    assert (np.array(off, float) <= half_a_digit * (1 + 1e-9) + 100 * EPS**2 * terms).all()


@pytest.mark.parametrize("n", [5, 150])
def test_products_with_all_constraints_are_those_of_the_matrix(n):
    """[I; A]ᵀ y of sparse and full y, in programs small and large."""
    rng = np.random.default_rng(n)
    data = statement(n, n, n, definite=True)
    for part in (0.05, 1.0):
        y = rng.standard_normal(2 * n) * (rng.random(2 * n) < part)
        assert_allclose(data.transposed(y), np.vstack([np.eye(n), data.A]).T @ y, atol=1e-12)


@pytest.mark.parametrize("kind", ["variables", "directions"])
def test_the_reduced_hessian_is_definite_on_any_basis(kind):
    """ZᵀHZ = I, and Z spans the basis: unit vectors of some variables in any order and sign, or any directions."""
    rng = np.random.default_rng(3)
    data = statement(3, definite=True)
    basis = np.eye(12)[:, rng.permutation(12)[:7]]
    bases = [basis, -basis] if kind == "variables" else [np.linalg.qr(rng.standard_normal((12, 7)))[0]]
    for basis in bases:
        hessian = ReducedHessian(data, basis)
        assert_allclose(hessian.Z.T @ data.H @ hessian.Z, np.eye(7), atol=1e-12)
        assert_allclose(basis @ (basis.T @ hessian.Z), hessian.Z, atol=1e-12)


def test_the_bound_of_the_right_inverse_is_above_its_entries():
    """The largest entry is looked for only where a bound of it does not decide."""
    data = statement(5, 60, 40, definite=False)
    working, hessian = start(data, [0] * 100)
    rng = np.random.default_rng(5)
    for _ in range(60):
        change_at_random(data, working, hessian, rng)
        largest = np.abs(working.N).max(initial=0.0)
        assert not working.inverse.is_below(largest)
        assert working.inverse.is_below(1.001 * largest + 1e-300)


def test_a_short_row_raises_the_bound_of_the_right_inverse():
    """A row of length 1/1000 has a column of length 1000, also if it is orthogonal to the other rows."""
    A = np.array([[1.0, 0.0, 0.0], [0.0, 1e-3, 0.0]])
    data = Statement(H=np.eye(3), c=np.zeros(3), A=A, lower=-np.ones(5), upper=np.ones(5))
    working = WorkingSet(data, np.array([0, 0, 0, 1, 0], dtype=np.int8))
    assert working.inverse.is_below(2.0)
    working.add(4, 1)
    assert not working.inverse.is_below(999.0)
    assert working.inverse.is_below(1001.0)
