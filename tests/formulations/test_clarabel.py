"""Clarabel on equilibrated data: optimum, multipliers and status of small programs of each cone, in any unit."""

import os
import signal
import threading
from contextlib import suppress

import cvxpy as cp
import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from bemcontact.errors import ProblemError, SolverError
from bemcontact.formulations import clarabel
from bemcontact.formulations.clarabel import ATTEMPTS, ClarabelSettings, minimize_convex

UNITS = [1.0, 1e-9, 1e6]


@pytest.mark.parametrize("unit", UNITS)
def test_quadratic_program(unit):
    """Of (x - 3)² + (y - 1)² with x + y <= 2 and x = y + 1 the least is at x = 1.5, y = 0.5, by hand."""
    x, y = cp.Variable(), cp.Variable()
    bound = x + y <= 2 * unit
    problem = cp.Problem(cp.Minimize(cp.square(x - 3 * unit) + cp.square(y - unit)), [bound, x == y + unit])
    minimize_convex(problem)
    assert problem.status == "optimal"
    assert x.value == pytest.approx(1.5 * unit, rel=1e-9)
    assert y.value == pytest.approx(0.5 * unit, rel=1e-9)
    assert problem.value == pytest.approx(2.5 * unit**2, rel=1e-9)
    # x = (b + 1)/2, y = (b - 1)/2: d/db [(x - 3)² + (y - 1)²] = (x - 3) + (y - 1) = -2 at b = 2, against the bound
    assert bound.dual_value == pytest.approx(2 * unit, rel=1e-8)


@pytest.mark.parametrize("unit", UNITS)
def test_second_order_cone(unit):
    """The point of a disc of radius 2 about (3, 4) that is nearest to the origin, at 5 - 2."""
    x = cp.Variable(2)
    problem = cp.Problem(cp.Minimize(cp.norm(x)), [cp.norm(x - unit * np.array([3.0, 4.0])) <= 2 * unit])
    minimize_convex(problem)
    assert problem.value == pytest.approx(3 * unit, rel=1e-8)
    np.testing.assert_allclose(x.value, unit * np.array([1.8, 2.4]), rtol=1e-6)


@pytest.mark.parametrize("unit", UNITS)
def test_semidefinite_cone(unit):
    """The least t with t I - A positive semidefinite is the largest eigenvalue of A."""
    A = unit * np.array([[2.0, 1.0, 0.0], [1.0, 2.0, 1.0], [0.0, 1.0, 2.0]])
    t = cp.Variable()
    minimize_convex(cp.Problem(cp.Minimize(t), [t * np.eye(3) - A >> 0]))
    assert t.value == pytest.approx((2 + np.sqrt(2)) * unit, rel=1e-8)


def test_exponential_and_power_cones():
    """Of eˣ - 2x the least is 2 - 2 ln 2 at ln 2, of x^0.3 y^0.7 with x + y = 1 the largest at x = 0.3.

    Both are flat there: 1e-11 of the value is 3e-6 of the place.
    """
    x = cp.Variable()
    minimize_convex(problem := cp.Problem(cp.Minimize(cp.exp(x) - 2 * x)))
    assert x.value == pytest.approx(np.log(2), abs=1e-5)
    assert problem.value == pytest.approx(2 - 2 * np.log(2), rel=1e-9)
    share, mean = cp.Variable(2), cp.Variable()
    for cone in (cp.PowCone3D(share[0], share[1], mean, 0.3), cp.PowConeND(share, mean, np.array([0.3, 0.7]))):
        minimize_convex(cp.Problem(cp.Maximize(mean), [cp.sum(share) == 1, cone]))
        np.testing.assert_allclose(share.value, [0.3, 0.7], atol=1e-5)


@pytest.mark.parametrize("unit", UNITS)
def test_status(unit):
    x = cp.Variable()
    minimize_convex(none := cp.Problem(cp.Minimize(x), [x >= 2 * unit, x <= unit]))
    assert none.status == "infeasible"
    assert x.value is None
    minimize_convex(endless := cp.Problem(cp.Minimize(x / unit), [x <= unit]))
    assert endless.status == "unbounded"


def test_iteration_limit_is_a_status():
    x = cp.Variable(3)
    minimize_convex(problem := cp.Problem(cp.Minimize(cp.norm(x - 1)), [cp.norm(x) <= 1]), max_iterations=2)
    assert problem.status == "user_limit"


def test_integers_are_refused():
    with pytest.raises(SolverError, match=r"Clarabel cannot solve this model: .* state it without integers"):
        minimize_convex(cp.Problem(cp.Minimize(cp.Variable(integer=True))))


def degenerate_program(seed: int, n: int, rank: int, decades: int) -> tuple[cp.Problem, cp.Variable, float]:
    """A program with a known minimum: a point, slacks and multipliers are drawn, and make costs and limits (KKT).

    The Hessian is semidefinite to round-off, some constraints are weak, and units span decades. Its least value is
    ½xᵀHx + cᵀx at the point. Its rank is at least one: without costs there is nothing beside which round-off is small.
    """
    rng = np.random.default_rng(seed)
    factor = rng.standard_normal((rank, n))
    H = factor.T @ factor + 1e-17 * np.diag(rng.standard_normal(n))
    A, x = rng.standard_normal((n, n)), rng.standard_normal(n)
    kind = rng.integers(0, 3, n)  # touched with a multiplier, touched without, not touched
    multipliers, slacks = np.where(kind == 0, rng.random(n), 0.0), np.where(kind == 2, rng.random(n), 0.0)
    unit = 10.0 ** rng.uniform(-decades, decades, n)
    variable = cp.Variable(n)
    given, cost = cp.multiply(unit, variable), -H @ x - A.T @ multipliers
    limits = [A @ given <= A @ x + slacks, cp.abs(given) <= 100.0]
    goal = cp.quad_form(given, cp.psd_wrap(H)) / 2 + cost @ given
    return cp.Problem(cp.Minimize(goal), limits), given, float(x @ H @ x / 2 + cost @ x)


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 10**6), n=st.integers(2, 25), rank=st.integers(1, 25), decades=st.integers(0, 3))
def test_degenerate_programs_have_the_minimum_they_were_made_with(seed, n, rank, decades):
    problem, given, least = degenerate_program(seed, n, min(rank, n), decades)
    minimize_convex(problem)
    size = 1.0 + abs(least) + 100.0 * np.abs(given.value).max()
    assert problem.status == "optimal"
    assert problem.value == pytest.approx(least, abs=1e-8 * size)


HOPELESS = ClarabelSettings("", {"max_iter": 1})


def test_another_attempt_answers_and_is_named(monkeypatch):
    """The first attempt gives up at once; the next one has the minimum, and says that it was not the first."""
    monkeypatch.setattr(clarabel, "ATTEMPTS", (HOPELESS, *ATTEMPTS[1:]))
    problem, _, least = degenerate_program(1, 6, 3, 0)
    answer = minimize_convex(problem)
    assert problem.value == pytest.approx(least, abs=1e-7)
    assert ATTEMPTS[1].words in answer.note
    assert not answer.failed


def test_costs_far_below_one_are_not_taken_for_zero(monkeypatch):
    """Beside one, in which Clarabel measures, every feasible point would be a minimum of them."""
    problem, _, least = degenerate_program(1, 6, 3, 0)
    light = cp.Problem(cp.Minimize(1e-13 * problem.objective.expr), problem.constraints)
    minimize_convex(light)
    assert problem.objective.value == pytest.approx(least, abs=1e-6)
    monkeypatch.setattr(clarabel, "ATTEMPTS", (HOPELESS, *(attempt for attempt in ATTEMPTS if attempt.rescaled)))
    with pytest.raises(SolverError, match="Clarabel found no solution"):
        minimize_convex(light)


def test_a_parameter_without_a_value_is_named():
    x, limit = cp.Variable(), cp.Parameter(name="limit")
    with pytest.raises(ProblemError, match="parameter 'limit' has no value"):
        minimize_convex(cp.Problem(cp.Minimize(x), [x >= limit]))


def test_no_attempt_is_an_error_unless_the_point_is_wanted(monkeypatch):
    monkeypatch.setattr(clarabel, "ATTEMPTS", (HOPELESS,))
    problem, given, _ = degenerate_program(1, 6, 3, 0)
    with pytest.raises(SolverError, match="Clarabel found no solution"):
        minimize_convex(problem)
    answer = minimize_convex(problem, leave_point=True)
    assert answer.failed
    assert "not reached: residual" in answer.note
    assert given.value is not None


@pytest.mark.parametrize("attempt", ATTEMPTS, ids=lambda attempt: attempt.words or "first")
def test_each_attempt_by_itself_solves_plain_programs(attempt, monkeypatch):
    monkeypatch.setattr(clarabel, "ATTEMPTS", (attempt,))
    for seed in range(3):
        problem, _, least = degenerate_program(seed, 6, 3, 0)
        answer = minimize_convex(problem)
        assert not answer.failed
        assert problem.value == pytest.approx(least, abs=1e-6)


@pytest.mark.parametrize("gap", 10.0 ** np.arange(2, 13))
def test_what_is_hardly_feasible_is_not_called_infeasible_or_unbounded(gap):
    """X >= -1 costs `gap` apiece, and y saves 1 up to 1: the least is -gap - 1; a ray of round-off would cross it."""
    x, y = cp.Variable(), cp.Variable()
    minimize_convex(problem := cp.Problem(cp.Minimize(gap * x - y), [x >= -1, y <= 1]), equilibrate=False)
    assert problem.status.startswith("optimal")
    assert problem.value == pytest.approx(-gap - 1, rel=1e-7)


def test_an_interrupt_is_raised_when_a_solve_has_ended():
    """Clarabel prints what its callback raises, and goes on."""
    data = np.random.default_rng(0).standard_normal((300, 300))
    x = cp.Variable(300)
    problem = cp.Problem(cp.Minimize(cp.sum_squares(data @ x - 1)), [x >= 0])
    before = signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell ignores it in the background
    try:
        threading.Timer(0.1, os.kill, (os.getpid(), signal.SIGINT)).start()
        with pytest.raises(KeyboardInterrupt):
            sum(minimize_convex(problem) is not problem for _ in range(100))
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    finally:
        signal.signal(signal.SIGINT, before)


@pytest.mark.slow
@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 10**6), decades=st.integers(6, 11))
@example(0, 9)
@example(7, 9)
@example(50, 9)
@example(135, 8)
def test_what_is_hardly_infeasible_is_proved_or_refused_in_a_sentence(seed, decades):
    """Of positive numbers x <= 1 - d a mean cannot be one: this is proved while d is more than a part in 1e8."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(2, 9))
    a, B, c = rng.random(n) + 0.1, rng.standard_normal((n, n)), rng.standard_normal(n)
    x = cp.Variable(n)
    goal = cp.quad_form(x, cp.psd_wrap(B @ B.T)) + c @ x
    problem = cp.Problem(cp.Minimize(goal), [x >= 0, x <= 1 - 10.0**-decades, a @ x == a.sum()])
    outcome = "refused"
    with suppress(SolverError):
        minimize_convex(problem)
        outcome = problem.status
    assert outcome == "infeasible" or (decades > 8 and outcome.startswith(("refused", "optimal")))
