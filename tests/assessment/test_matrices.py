"""Numbers of the condensed matrices: two points by hand, and what a change of units may not change."""

import dataclasses

import numpy as np
import pytest
from contact_problems import random_contact

from bemcontact.assessment.matrices import condition, weighted_compliance
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.options import Weights


def test_two_points_by_hand():
    """M = [[2, 1], [0, 1]] over its norm 3: sym = [[2, ½], [½, 1]]/3, eigenvalues (3 ± √2)/6; |M - Mᵀ| / |M + Mᵀ|."""
    result = weighted_compliance(
        CondensedContact.from_compliance([[2.0, 1.0], [0.0, 1.0]], [-1.0, 0.0]), Weights.TRIBUTARY
    )
    assert result.smallest_eigenvalue == pytest.approx((3 - np.sqrt(2)) / 6)
    assert result.largest_eigenvalue == pytest.approx((3 + np.sqrt(2)) / 6)
    assert result.asymmetry == pytest.approx(np.sqrt(2) / np.sqrt(16 + 4 + 2))
    assert result.convex
    assert result.negative_weights == 0


def test_equilibrium_leaves_one_direction():
    """R = (1, 1), J = I: the equilibrium space is (1, -1)/√2, on which [[1, 2], [2, 1]] is -1, over the norm."""
    contact = CondensedContact.from_compliance(
        [[1.0, 2.0], [2.0, 1.0]], [0.0, 0.0], rigid_motions=[1.0, 1.0], motion_load=-1.0
    )
    result = weighted_compliance(contact, Weights.TRIBUTARY)
    norm = np.abs(contact.compliance).sum(axis=1).max()
    assert result.smallest_eigenvalue == pytest.approx(-1 / norm)
    assert result.smallest_eigenvalue == result.largest_eigenvalue
    assert not result.convex
    assert not result.saddle


def test_equilibrium_that_leaves_nothing():
    contact = CondensedContact.from_compliance([[1.0]], [0.0], rigid_motions=[1.0], motion_load=-1.0)
    result = weighted_compliance(contact, Weights.TRIBUTARY)
    assert result.smallest_eigenvalue is None
    assert result.convex


def test_consistent_weights_that_do_not_share_equilibrium_are_a_saddle():
    """J with rows that do not sum to the tributary weights makes pᵀJR a something that ℓᵀp does not fix."""
    contact = dataclasses.replace(random_contact(1, 5, 1), consistent_weights=np.eye(5) - 0.1 * np.eye(5, k=1))
    result = weighted_compliance(contact, Weights.CONSISTENT)
    assert result.saddle
    assert result.negative_weights == 4
    assert not weighted_compliance(contact, Weights.TRIBUTARY).saddle


def test_condition_of_a_diagonal():
    """diag(1, 100): the condition is 100, in any units."""
    for factor in (1.0, 1e-9):
        assert condition(CondensedContact.from_compliance(factor * np.diag([1.0, 100.0]), [1.0, 1.0])) == pytest.approx(
            100
        )
