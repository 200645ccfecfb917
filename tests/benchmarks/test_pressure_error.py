"""Differences of pressures in the L2 norm, where they are known in closed form."""

import numpy as np
import pytest
from pressure_error import Pressure, by_elements, relative_error


def straight(x):
    return np.ones_like(x)


def on(start, end, value, parts=1):
    return Pressure(breaks=np.linspace(start, end, parts + 1), value=value)


def test_a_constant_that_is_off_by_a_tenth():
    assert relative_error(on(0, 2, lambda x: 1.1 + 0 * x), on(0, 2, straight), straight) == pytest.approx(0.1)


def test_contact_that_ends_too_late_counts():
    """1 on [0, 1.04] instead of [0, 1]: ∫ over the end 0.04, so √0.04."""
    assert relative_error(on(0, 1.04, straight), on(0, 1, straight), straight) == pytest.approx(0.2)


def test_the_norm_is_over_the_arc_length():
    """Off by one where x > 1, and the arc there three times as long: √(3 / (1 + 3))."""
    wrong, right = on(0, 2, lambda x: 1.0 + (x > 1), parts=2), on(0, 2, straight, parts=2)
    assert relative_error(wrong, right, lambda x: np.where(x > 1, 3.0, 1.0)) == pytest.approx(np.sqrt(0.75))


def test_a_root_at_the_end():
    """√(1 - x) is right, √(1 - x) + √(1 - x)/50 is not."""
    right = on(0, 1, lambda x: np.sqrt(np.maximum(1 - x, 0)))
    wrong = on(0, 1, lambda x: 1.02 * np.sqrt(np.maximum(1 - x, 0)))
    assert relative_error(wrong, right, straight) == pytest.approx(0.02)
    assert relative_error(on(0, 1, lambda x: 0 * x), right, straight) == pytest.approx(1.0)


def test_a_cut_pressure_is_zero_beyond_and_nowhere_negative():
    cut = on(0, 4, lambda x: 1 - x, parts=4).cut(2.5)
    assert cut.breaks == pytest.approx([0, 1, 2, 2.5])
    assert cut(np.array([0.5, 1.5, 2.6])) == pytest.approx([0.5, 0, 0])


@pytest.mark.parametrize("middle", [0.5, 0.3])
def test_a_quadratic_element_with_its_middle_node_anywhere(middle):
    """Both x and p are quadratic in ξ, so p = 1 + 2 x is exact; outside there is no pressure."""
    x = np.array([[0, middle, 1], [1, 1 + middle, 2]])
    pressure = by_elements(x, 1 + 2 * x)
    at = np.array([0.0, 0.2, 0.9, 1.1, 2.0])
    assert pressure(at) == pytest.approx(1 + 2 * at)
    assert pressure(np.array([-0.1, 2.1])) == pytest.approx(0)


def test_a_quadratic_element():
    x = np.array([[0, 0.5, 1]])
    at = np.linspace(0, 1, 7)
    assert by_elements(x, x**2)(at) == pytest.approx(at**2)
