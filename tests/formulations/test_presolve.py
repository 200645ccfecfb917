"""Programs without the variables that one equation fixes: closed forms, and the optimality conditions of the whole."""

import cvxpy as cp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bemcontact.formulations.clarabel import minimize_convex
from bemcontact.formulations.presolve import FixedVariables


def data_of(problem: cp.Problem) -> dict:
    return problem.get_problem_data(cp.CLARABEL, solver_opts={})[0]


@pytest.mark.slow
@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), units=st.sampled_from((1e-6, 1.0, 1e6)), linear=st.booleans())
def test_optimum_and_all_multipliers_keep_the_optimality_conditions(seed, units, linear):
    """Recomputed by hand: P x + c + Σ Aᵀz = 0 for the multipliers of all constraints, which have the right signs."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(2, 8))
    root, slope, rows = rng.standard_normal((n, n)), rng.standard_normal(n), rng.standard_normal((3, n))
    P = np.zeros((n, n)) if linear else root @ root.T
    fixed, inside = rng.standard_normal(n), rng.random(n) < 0.6
    x, on = cp.Variable(n), cp.Parameter(n, value=inside.astype(float))
    pinned = cp.multiply(on, x / units - fixed) == 0
    most, box = rows @ (x / units) <= rows @ fixed + 1, cp.abs(x / units - fixed) <= 2
    objective = cp.quad_form(x / units, cp.psd_wrap(P)) / 2 + slope @ (x / units)
    problem = cp.Problem(cp.Minimize(objective), [pinned, most, box])
    minimize_convex(problem)
    assert len(FixedVariables(data_of(problem)).columns) == inside.sum()
    x0 = x.value / units
    np.testing.assert_allclose(x0[inside], fixed[inside], rtol=1e-12)
    assert (rows @ (x0 - fixed) <= 1 + 1e-8).all()
    force = P @ x0 + slope + rows.T @ most.dual_value
    np.testing.assert_allclose((force + pinned.dual_value)[inside], 0, atol=1e-6)
    assert (most.dual_value >= -1e-9).all()
    outside = ~inside & (np.abs(x0 - fixed) < 2 - 1e-6)
    np.testing.assert_allclose(force[outside], 0, atol=1e-6)


@pytest.mark.parametrize("values", [(1.0, 2.0), (-1.0, -1.0)], ids=["two values", "outside of a bound"])
def test_values_that_exclude_each_other_are_proved_infeasible(values):
    x = cp.Variable(3)
    problem = cp.Problem(cp.Minimize(cp.sum_squares(x)), [x[0] == values[0], x[0] == values[1], x >= 0])
    minimize_convex(problem)
    assert problem.status == "infeasible"


def test_a_descent_beside_a_fixed_variable_is_unbounded():
    x = cp.Variable(2)
    problem = cp.Problem(cp.Minimize(5 * x[0] - x[1]), [x[0] == 3, x >= 0])
    minimize_convex(problem)
    assert problem.status == "unbounded"


def test_a_program_keeps_a_variable_if_all_are_fixed():
    """The multiplier is the derivative of the least value by the right side: -2 x at x = (1, 2)."""
    x = cp.Variable(2)
    equation = x == np.array([1.0, 2.0])
    problem = cp.Problem(cp.Minimize(cp.sum_squares(x)), [equation])
    minimize_convex(problem)
    np.testing.assert_allclose(x.value, [1, 2], rtol=1e-9)
    np.testing.assert_allclose(equation.dual_value, [-2, -4], rtol=1e-7)


@pytest.mark.parametrize("kind", ["cone", "semidefinite", "exponential"])
def test_other_cones_have_the_answer_of_substitution(kind):
    """A variable that is fixed at 2, and the same program with the number in its place."""
    x, y = cp.Variable(2), cp.Variable()
    first = {
        "cone": lambda v: cp.norm(cp.hstack([v, y - 1])),
        "semidefinite": lambda v: cp.lambda_max(cp.bmat([[v, y], [y, 1.0]])) + cp.square(y - 1),
        "exponential": lambda v: cp.exp(y) - v * 1.0 + cp.square(v - y),
    }[kind]
    with_variable = cp.Problem(cp.Minimize(first(x[0]) + cp.square(x[1])), [x[0] == 2, x[1] >= 1])
    minimize_convex(with_variable)
    value, at = with_variable.value, float(y.value)
    substituted = cp.Problem(cp.Minimize(first(2.0) + 1.0))
    minimize_convex(substituted)
    assert value == pytest.approx(substituted.value, rel=1e-8)
    assert at == pytest.approx(float(y.value), abs=1e-4)
