"""LU with one step of refinement: known solutions, overwritten matrices, singular ones."""

import numpy as np
import pytest
from scipy.linalg import hilbert

from bemcontact.contact.lu import LU


def test_solves_and_estimates_the_condition():
    """For the Hilbert matrix of order 6, ‖H‖₁ = 1 + 1/2 + ... + 1/6 = 2.45, and ‖H⁻¹‖₁ = 11865420, an integer."""
    H = hilbert(6)
    x = np.column_stack([np.ones(6), np.arange(6.0)])
    right = H @ x
    lu = LU.of(np.asfortranarray(H.copy()), overwrite=True)
    np.testing.assert_allclose(lu.solve(right, lambda y: right - H @ y), x, rtol=1e-8, atol=1e-8)
    assert 1 / lu.reciprocal_condition == pytest.approx(2.45 * 11865420, rel=1e-6)


def test_singular_matrix_has_the_reciprocal_condition_zero():
    assert LU.of(np.ones((3, 3))).reciprocal_condition == 0.0
