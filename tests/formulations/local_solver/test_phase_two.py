"""What phase two takes for zero: rounding of the point and of the multipliers never counts as more."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from bemcontact.formulations.local_solver.minimize import minimize_qp
from bemcontact.formulations.local_solver.phase_two import Descent, Ending, ReducedHessian
from bemcontact.formulations.local_solver.progress import SearchState
from bemcontact.formulations.local_solver.result import QPOptions, QPStatus
from bemcontact.formulations.local_solver.statement import EPS, read_statement
from bemcontact.formulations.local_solver.working_set import WorkingSet

INF = np.inf


@settings(max_examples=200)
@given(st.integers(0, 10**9))
@example(2)
@example(4)
def test_the_rounding_of_a_strong_multiplier_closes_no_way_down(seed):
    """0 with E z = 0, c = (Eᵀy, 0) and aᵀv >= 0: no minimizer, since the form falls along v = a."""
    rng = np.random.default_rng(seed)
    k, n = int(rng.integers(1, 4)), int(rng.integers(2, 5))
    E, a = rng.standard_normal((k, k)), rng.standard_normal(n)
    basis = np.linalg.qr(np.column_stack([a, rng.standard_normal((n, n - 1))]))[0]
    B, M = rng.standard_normal((n, n)), rng.standard_normal((n - 1, n - 1))
    form = B + B.T
    form[1:, 1:], form[0, 0] = M @ M.T + 0.1 * np.eye(n - 1), -rng.uniform(0.1, 2.0)
    H = rng.standard_normal((k + n, k + n))
    H[k:, k:] = 0.5 * basis @ form @ basis.T
    A, c = np.zeros((k + 1, k + n)), np.zeros(k + n)
    A[:k, :k], A[k, k:], c[:k] = E, a, E.T @ rng.standard_normal(k)
    result = minimize_qp(H + H.T, c, A, np.zeros(k + 1), np.append(np.zeros(k), INF))
    assert result.status is QPStatus.UNBOUNDED


@settings(max_examples=200)
@given(st.integers(0, 10**9))
@example(416)
@example(428)
@example(713)
def test_multipliers_at_a_vertex_are_right_within_what_counts_as_zero(seed):
    """At 0, held by whole rows W with c = Wᵀy: y, and nothing else, stands out from its rounding."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(2, 13))
    lower = np.tril(rng.integers(-3, 4, (n, n)) * (rng.random((n, n)) < 0.3), -1)
    triangle = lower + np.diag(rng.integers(1, 4, n) * rng.choice([-1, 1], n))
    W = triangle[rng.permutation(n)][:, rng.permutation(n)].astype(float)
    y = (rng.integers(1, 4, n) * (rng.random(n) < 0.4)).astype(float)
    statement = read_statement(np.zeros((n, n)), W.T @ y, W, np.zeros(n), np.full(n, INF), None, None)
    progress = SearchState(statement=statement, options=QPOptions(), unit=1.0, x=np.zeros(n))
    sides = np.append(np.zeros(n), -np.ones(n)).astype(np.int8)
    descent = Descent(progress, WorkingSet(statement, sides))
    assert descent.run().ending is Ending.STATIONARY
    found, zeros = (descent.working.of_all(values)[n:] for values in (descent.multipliers, descent.zeros))
    assert np.all(np.abs(found - y) <= zeros)
    assert (found > 10.0 * zeros).tolist() == (y > 0.0).tolist()


def test_a_direction_refused_by_rounding_leaves_no_minimizer():
    """Along (0, -1) the form -9 v² falls without end; H has entries of rounding, and the first row hardly stops it."""
    H = [[-3e-34, -6.3e-17], [-6.3e-17, -18.0]]
    result = minimize_qp(
        H, [-0.27, 0.0], [[-6.0, -4.0], [-0.27, 0.0]], np.zeros(2), np.full(2, INF), working_set=[0, 0, -1, -1]
    )
    assert result.status in (QPStatus.UNBOUNDED, QPStatus.UNDECIDED)


def test_newton_steps_on_one_gradient_follow_the_working_set():
    """The step leads to the minimizer on what is free, by its equations, also when the gradient is as before."""
    rng = np.random.default_rng(0)
    n = 5
    B, gradient = rng.standard_normal((n, n)), rng.standard_normal(n)
    H = B @ B.T + np.eye(n)
    statement = read_statement(H, gradient, None, None, None, -np.ones(n), np.ones(n))
    working = WorkingSet(statement, np.zeros(n, dtype=np.int8))
    hessian, free = ReducedHessian(statement, working.null_space), [*range(n)]
    for variable in (3, 0, 2):
        expected = np.zeros(n)
        expected[free] = -np.linalg.solve(H[np.ix_(free, free)], gradient[free])
        np.testing.assert_allclose(hessian.newton(gradient), expected, atol=1e-12)
        normal = working.add(variable, -1)
        assert normal is not None
        hessian.leave(normal, variable)
        hessian.clear(variable)
        free.remove(variable)
        expected[:] = 0.0
        expected[free] = -np.linalg.solve(H[np.ix_(free, free)], gradient[free])
        np.testing.assert_allclose(hessian.newton(gradient), expected, atol=1e-12)


def test_tolerances_of_constraints_grow_far_away_alone():
    """A row's tolerance is the stated one times its bound, or ten units in the last place of its terms."""
    statement = read_statement(np.eye(2), np.zeros(2), [[1.0, -1.0]], [-5.0], [7.0], None, None)
    progress = SearchState(statement=statement, options=QPOptions(), unit=1.0, x=np.zeros(2))
    for x, row in ((0.0, 5e-9), (1e9, 20.0 * EPS * 1e9), (1.0, 5e-9), (1e9, 20.0 * EPS * 1e9)):
        progress.place(np.full(2, x))
        np.testing.assert_allclose(progress.slack, [max(1e-9, 10.0 * EPS * x)] * 2 + [row])
        np.testing.assert_allclose(progress.highest[2] - 7.0, row, rtol=1e-5)
    progress.place(np.zeros(2))
    progress.tighten()
    np.testing.assert_allclose(progress.slack, [1e-11, 1e-11, 5e-11])


@pytest.mark.parametrize("seed", range(10))
def test_a_basis_that_is_no_longer_conjugate_is_made_anew(seed, monkeypatch):
    """Three times the basis makes each Newton step nine times as long, and so the reduced gradient eight times."""
    made = []

    def damaged(self, statement, null_space, make=ReducedHessian.__init__):
        make(self, statement, null_space)
        made.append(self)
        if len(made) == 1:
            self.Z[:] *= 3.0

    monkeypatch.setattr(ReducedHessian, "__init__", damaged)
    rng = np.random.default_rng(seed)
    B, c = rng.standard_normal((6, 6)), rng.standard_normal(6)
    H = B @ B.T + np.eye(6)
    result = minimize_qp(H, c, options=QPOptions(by_numba=False))
    assert len(made) > 1
    assert result.status is QPStatus.LOCAL_MINIMIZER
    assert result.iterations <= 4  # two before, at most two after
    np.testing.assert_allclose(H @ result.x, -c, atol=1e-9 * abs(c).max())


def test_multipliers_that_are_small_beside_other_terms_are_released_without_refinement(monkeypatch):
    """Σ h_i (x_i - t_i)²/2 over x >= 0 has its minimum at t, whatever the sizes of h and t.

    The first variable has the terms 1e6, the others 1e-7 to 1e-6. Beside rounding of the first their multipliers are
    nothing, but each has terms of its own. So refinements are left to the ends of phase two, of which there are two at
    most: from far away it runs again.
    """
    h, t = np.array([1.0, *[1e-9] * 20]), np.array([1e6, *np.linspace(1e2, 1e3, 20)])
    refine, refinements = Descent._refine, []
    monkeypatch.setattr(Descent, "_refine", lambda descent: (refinements.append(1), refine(descent)))
    result = minimize_qp(np.diag(h), -h * t, bl=np.zeros(21), options=QPOptions(scale=False, by_numba=False))
    assert result.status is QPStatus.LOCAL_MINIMIZER
    assert result.x == pytest.approx(t, rel=1e-9)
    assert len(refinements) <= 2
