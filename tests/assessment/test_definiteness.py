"""The equilibrium space of a compliance, and the form on it."""

import numpy as np
import pytest

from bemcontact.assessment.definiteness import Definiteness, least_eigenvalue


@pytest.mark.parametrize("motions", [0, 1, 3, 11])
def test_the_form_is_that_on_an_orthonormal_basis_of_the_equilibrium_space(motions):
    rng = np.random.default_rng(motions)
    n = 12
    D, M, ell = rng.uniform(0.1, 1.0, n), rng.uniform(-1.0, 1.0, (n, n)), rng.standard_normal((n, motions))
    M += n * np.eye(n)
    stiff = Definiteness.of(D, M, ell)
    Z, S = stiff.space, stiff.scales
    assert Z.shape == (n, n - motions)
    np.testing.assert_allclose(Z.T @ Z, np.eye(n - motions), atol=1e-14)
    np.testing.assert_allclose((S[:, None] * ell).T @ Z, 0.0, atol=1e-13)
    A = S[:, None] * (D[:, None] * M) * S
    np.testing.assert_allclose(stiff.form, Z.T @ (A + A.T) @ Z / 2, atol=1e-14)
    assert stiff.eigenvalue == pytest.approx(np.linalg.eigvalsh(stiff.form).min(), rel=1e-12)


@pytest.mark.parametrize("size", [1, 2, 40])
def test_the_smallest_eigenvalue_of_a_matrix_with_known_ones(size):
    rng = np.random.default_rng(size)
    turned, wanted = np.linalg.qr(rng.standard_normal((size, size)))[0], rng.uniform(-1.0, 1.0, size)
    assert least_eigenvalue(turned @ np.diag(wanted) @ turned.T) == pytest.approx(wanted.min(), abs=1e-14)


def test_a_matrix_with_an_entry_that_is_no_number_has_no_eigenvalue():
    with pytest.raises(ValueError, match="finite"):
        least_eigenvalue(np.array([[1.0, np.nan], [np.nan, 1.0]]))
