"""The elliptic integral of the second kind, in multiple precision."""

import mpmath
import numpy as np
import pytest

from bemcontact.problems.elliptic import second_kind


@pytest.mark.parametrize("ratio", [1.0, 0.999999, 0.5, 0.1, 1e-4, 1e-8, 1e-12])
def test_second_kind_has_all_digits(ratio: float):
    """Also beside the ends of a needle, a quarter turn from zero, where the integrand changes within the ratio."""
    beside = np.pi / 2 + ratio * np.array([-10.0, -1.0, 0.0, 1.0, 3.0])
    angles = np.concatenate([[1e-9, np.pi, -1.5 * np.pi, 40.0], np.linspace(-6.9, 6.7, 20), beside])
    with mpmath.workdps(40):
        expected = [float(mpmath.ellipe(mpmath.mpf(angle), 1 - mpmath.mpf(ratio) ** 2)) for angle in angles.tolist()]
    np.testing.assert_allclose(second_kind(angles, ratio), expected, rtol=2e-15)


def test_second_kind_is_odd_and_starts_at_zero():
    angles = np.array([0.0, 0.3, 2.0, 5.0])
    np.testing.assert_array_equal(second_kind(-angles, 0.2), -second_kind(angles, 0.2))
    assert second_kind(np.zeros(1), 0.2) == 0.0
