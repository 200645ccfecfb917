"""Clarabel on equilibrated data: optimum, multipliers and status of small programs of each cone, in any unit."""

import cvxpy as cp
import numpy as np
import pytest

from bemcontact.errors import SolverError
from bemcontact.formulations.clarabel import minimize

UNITS = [1.0, 1e-9, 1e6]


@pytest.mark.parametrize("unit", UNITS)
def test_quadratic_program(unit):
    """Of (x - 3)² + (y - 1)² with x + y <= 2 and x = y + 1 the least is at x = 1.5, y = 0.5, by hand."""
    x, y = cp.Variable(), cp.Variable()
    bound = x + y <= 2 * unit
    problem = cp.Problem(cp.Minimize(cp.square(x - 3 * unit) + cp.square(y - unit)), [bound, x == y + unit])
    minimize(problem)
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
    minimize(problem)
    assert problem.value == pytest.approx(3 * unit, rel=1e-8)
    np.testing.assert_allclose(x.value, unit * np.array([1.8, 2.4]), rtol=1e-6)


@pytest.mark.parametrize("unit", UNITS)
def test_semidefinite_cone(unit):
    """The least t with t I - A positive semidefinite is the largest eigenvalue of A."""
    A = unit * np.array([[2.0, 1.0, 0.0], [1.0, 2.0, 1.0], [0.0, 1.0, 2.0]])
    t = cp.Variable()
    minimize(cp.Problem(cp.Minimize(t), [t * np.eye(3) - A >> 0]))
    assert t.value == pytest.approx((2 + np.sqrt(2)) * unit, rel=1e-8)


def test_exponential_and_power_cones():
    """Of eˣ - 2x the least is 2 - 2 ln 2 at ln 2, of x^0.3 y^0.7 with x + y = 1 the largest at x = 0.3.

    Both are flat there: 1e-11 of the value is 3e-6 of the place.
    """
    x = cp.Variable()
    minimize(problem := cp.Problem(cp.Minimize(cp.exp(x) - 2 * x)))
    assert x.value == pytest.approx(np.log(2), abs=1e-5)
    assert problem.value == pytest.approx(2 - 2 * np.log(2), rel=1e-9)
    share, mean = cp.Variable(2), cp.Variable()
    for cone in (cp.PowCone3D(share[0], share[1], mean, 0.3), cp.PowConeND(share, mean, np.array([0.3, 0.7]))):
        minimize(cp.Problem(cp.Maximize(mean), [cp.sum(share) == 1, cone]))
        np.testing.assert_allclose(share.value, [0.3, 0.7], atol=1e-5)


@pytest.mark.parametrize("unit", UNITS)
def test_status(unit):
    x = cp.Variable()
    minimize(none := cp.Problem(cp.Minimize(x), [x >= 2 * unit, x <= unit]))
    assert none.status == "infeasible"
    assert x.value is None
    minimize(endless := cp.Problem(cp.Minimize(x / unit), [x <= unit]))
    assert endless.status == "unbounded"


def test_iteration_limit_is_a_status():
    x = cp.Variable(3)
    minimize(problem := cp.Problem(cp.Minimize(cp.norm(x - 1)), [cp.norm(x) <= 1]), max_iterations=2)
    assert problem.status == "user_limit"


def test_integers_are_refused():
    with pytest.raises(SolverError, match=r"Clarabel cannot solve this model: .* state it without integers"):
        minimize(cp.Problem(cp.Minimize(cp.Variable(integer=True))))
