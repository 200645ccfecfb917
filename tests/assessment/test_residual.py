"""Residuals: what each one sees, and its scale."""

from dataclasses import replace

import numpy as np
import pytest
from contact_problems import in_units, random_contact

from bemcontact.assessment.residual import objectives, residuals
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.solution import ContactSolution, Status
from bemcontact.errors import ProblemError
from bemcontact.formulations import complementarity
from bemcontact.options import Weights


def contact(length: float = 1.0, stress: float = 1.0) -> CondensedContact:
    """Four points, one free motion, in units of length and stress that are so many times smaller."""
    rng = np.random.default_rng(0)
    A = rng.standard_normal((4, 4))
    return CondensedContact.from_compliance(
        (A @ A.T + np.eye(4)) * length / stress,
        rng.standard_normal(4) * length,
        np.array([1.0, 2.0, 2.0, 1.0]) * length,
        rigid_motions=np.ones(4),
        motion_load=-6.0 * stress * length,
    )


def solution(problem: CondensedContact, pressure: np.ndarray, lift: float) -> ContactSolution:
    """The displacement that belongs to a pressure and an amplitude, by (12)."""
    u_n = problem.free_displacement + problem.compliance @ pressure + lift
    return ContactSolution(
        formulation="test",
        solver="none",
        status=Status.SOLVED,
        pressure=pressure,
        displacement=u_n,
        rigid_amplitudes=np.array([lift]),
        iterations=0,
    )


def test_each_condition_has_its_residual():
    """The pressure (2, -1, 3, 0) carries 2 - 2 + 6 = 6; the lift is chosen so that the smallest gap is -0.5."""
    problem = contact()
    p = np.array([2.0, -1.0, 3.0, 0.0])
    lift = -0.5 - problem.gap(p, np.zeros(1)).min()
    gap = problem.gap(p, np.array([lift]))
    result = residuals(problem, solution(problem, p, lift))
    U, T = problem.scales
    assert result.penetration == pytest.approx(0.5 / U, rel=1e-12)
    assert result.tension == pytest.approx(1.0 / T, rel=1e-12)
    assert result.complementarity == pytest.approx(np.abs(np.minimum(p / T, gap / U)).max(), rel=1e-12)
    assert result.work == pytest.approx((problem.weights * p * gap).sum() / (2 * U * T), rel=1e-12)
    assert result.equilibrium <= 1e-13
    assert result.balance <= 1e-15
    assert result.force_balance is None


def test_load_that_is_not_carried_shows_twice():
    """Without pressure the mean pressure is off by load/Σw = 1; the rows of (12) contain equilibrium as well.

    Their weighted mean is the mean pressure, as ℓᵀK = 0 and ℓᵀr = load: the largest is no less.
    """
    problem = contact()
    result = residuals(problem, solution(problem, np.zeros(4), 0.0))
    assert result.balance == pytest.approx(1.0 / problem.scales.pressure, rel=1e-12)
    assert result.stiffness_rows >= (1 - 1e-12) / problem.scales.pressure


def test_displacement_of_the_solver_is_what_is_judged():
    """A wrong u_n with a right p: K du in the stiffness rows; without them du less its share of the free motion."""
    problem = contact()
    right = solution(problem, np.array([2.0, 1.0, 1.0, 0.0]), 1.0)
    step = np.array([0.1, 0.0, 0.0, 0.0])
    result = residuals(problem, replace(right, displacement=right.displacement + step))
    expected = np.abs(problem.stiffness_rows.K @ step).max() / problem.scales.pressure
    assert result.stiffness_rows == pytest.approx(expected, rel=1e-10)
    ell, R = problem.equilibrium[:, 0], problem.rigid_motions[:, 0]
    outside = step - R * (ell @ step) / (ell @ R)
    assert result.equilibrium == pytest.approx(abs(outside).max() / problem.scales.displacement, rel=1e-10)


@pytest.mark.parametrize(("length", "stress"), [(1e-3, 1e6), (1e3, 1e-6), (25.4, 6.894757)])
def test_units_do_not_matter(length, stress):
    p = np.array([2.0, -1.0, 3.0, 0.1])
    one = residuals(contact(), solution(contact(), p, 0.3))
    other = contact(length, stress)
    two = residuals(other, solution(other, p * stress, 0.3 * length))
    for name in ("penetration", "tension", "complementarity", "work", "equilibrium", "stiffness_rows", "balance"):
        assert getattr(two, name) == pytest.approx(getattr(one, name), rel=1e-11, abs=1e-13)


def test_force_balance_is_passed_through():
    problem = contact()
    assert residuals(problem, solution(problem, np.zeros(4), 0.0), force_balance=1e-7).force_balance == 1e-7


def at(contact: CondensedContact, pressure: np.ndarray, displacement: np.ndarray) -> ContactSolution:
    return ContactSolution(
        formulation="qp1",
        solver="none",
        status=Status.SOLVED,
        pressure=pressure,
        displacement=displacement,
        rigid_amplitudes=np.zeros(contact.free_motions),
        iterations=0,
    )


def test_all_vanish_at_the_contact_state():
    """There p ≥ 0, δ ≥ 0, p·δ = 0 and the equations hold, so that work and penalty are zero."""
    contact = random_contact(3, 9, 2)
    result = objectives(contact, complementarity.solve(contact), Weights.TRIBUTARY, (1e-3, 1.0))
    assert abs(result.qp1) < 1e-13
    assert abs(result.qp3) < 1e-13
    assert [item.penalty for item in result.qp2] == [1e-3, 1.0]
    assert all(abs(item.value) < 1e-13 for item in result.qp2)


def test_the_three_at_a_point_off_the_equations():
    """One point, compliance 2, weight 3, gap -1 without pressure, so that U = 1 and T = ½; p = ½ and u = 3.

    The gap is 2 by u and -1 + 2p = 0 by p; (12) is u/2 = p, wrong by 1, which is 2 T. Weights are over the largest.
    """
    contact = CondensedContact.from_compliance([[2.0]], [-1.0], [3.0])  # interference 1: U = 1, T = ½
    point = at(contact, np.array([0.5]), np.array([3.0]))
    result = objectives(contact, point, Weights.TRIBUTARY, (0.25,))
    U, T = contact.scales
    assert (U, T) == (1.0, 0.5)
    assert result.qp1 == pytest.approx(0.5 * (-1 + 3) / (U * T))
    residual = (3.0 / 2.0 - 0.5) / T  # K u - p with K = 1/2
    (qp2,) = result.qp2
    assert (qp2.penalty, qp2.value) == (0.25, pytest.approx(result.qp1 + residual**2 / 0.25))
    assert result.qp3 == pytest.approx(0.5 * (-1 + 2 * 0.5) / (U * T))


def test_a_change_of_units_changes_nothing():
    contact = random_contact(5, 6, 0)
    rng = np.random.default_rng(1)
    p, u = rng.uniform(0, 1, 6), rng.uniform(0, 1, 6)
    length, stress = 1e3, 1e-6
    other = in_units(contact, length, stress)
    one = objectives(contact, at(contact, p, u), Weights.TRIBUTARY, (1.0,))
    two = objectives(other, at(other, p * stress, u * length), Weights.TRIBUTARY, (1.0,))
    assert two.qp1 == pytest.approx(one.qp1, rel=1e-12)
    assert two.qp2[0].value == pytest.approx(one.qp2[0].value, rel=1e-9)
    assert two.qp3 == pytest.approx(one.qp3, rel=1e-12)


def test_weights_that_are_not_there_are_refused():
    contact = random_contact(5, 6, 0)
    with pytest.raises(ProblemError, match="carries no consistent weights"):
        objectives(contact, complementarity.solve(contact), Weights.CONSISTENT, ())
