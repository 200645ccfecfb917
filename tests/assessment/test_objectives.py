"""F1, F2 and F3 of one point, against the formulas written out for two points and against each other."""

import numpy as np
import pytest
from contact_problems import random_contact

from bemcontact.assessment.residual import objectives
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.solution import ContactSolution, Status
from bemcontact.errors import ProblemError
from bemcontact.formulations import complementarity
from bemcontact.options import Weights


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
    other = CondensedContact.from_compliance(
        contact.compliance * length / stress, contact.offset * length, contact.weights * length
    )
    one = objectives(contact, at(contact, p, u), Weights.TRIBUTARY, (1.0,))
    two = objectives(other, at(other, p * stress, u * length), Weights.TRIBUTARY, (1.0,))
    assert two.qp1 == pytest.approx(one.qp1, rel=1e-12)
    assert two.qp2[0].value == pytest.approx(one.qp2[0].value, rel=1e-9)
    assert two.qp3 == pytest.approx(one.qp3, rel=1e-12)


def test_weights_that_are_not_there_are_refused():
    contact = random_contact(5, 6, 0)
    with pytest.raises(ProblemError, match="carries no consistent weights"):
        objectives(contact, complementarity.solve(contact), Weights.CONSISTENT, ())
