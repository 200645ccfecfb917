"""The largest value along an edge: parabolas in closed form, growth towards infinite values, maxima of their own."""

from collections.abc import Callable

import numpy as np
import pytest

from bemcontact.analysis.edge_peak import largest_along

END = np.array([True, *[False] * 10])


@pytest.mark.parametrize("top", [0.0, 0.3, 4.0, 7.37, 10.0])
@pytest.mark.parametrize("sign", [1, -1])
def test_parabolas(top: float, sign: int):
    """The top is found where it is, in an element, between two or at an end."""
    found = largest_along(lambda at: sign * (5 - (at - top) ** 2 / 100), np.zeros(11, bool))
    assert found == pytest.approx((top, 5 * sign), abs=1e-4)


@pytest.mark.parametrize(
    "values",
    [lambda at: at**-0.5, lambda at: 1 + at**-0.5, lambda at: at**-0.5 * (1 + 0.3 * np.sin(40 * at) * (at < 2.9))],
)
def test_growth_alone_has_no_largest(values: Callable):
    """Values that grow towards an infinite one, also with roughness in the elements beside it."""
    assert largest_along(values, END) is None
    assert largest_along(lambda at: values(10 - at), END[::-1]) is None


def test_maximum_besides_an_infinite_value():
    """x^-1/2 + 0.5 exp(-(x - 7)²) has a maximum near x = 7; between two infinite values too."""
    one = largest_along(lambda at: at**-0.5 + 0.5 * np.exp(-((at - 7) ** 2)), END)
    at = np.linspace(6, 8, 200_001)
    values = at**-0.5 + 0.5 * np.exp(-((at - 7) ** 2))
    assert one == pytest.approx((at[values.argmax()], values.max()), abs=1e-4)
    both = largest_along(lambda at: at**-0.5 + (10.0 - at) ** -0.5 + 2 * np.exp(-((at - 5) ** 2)), END | END[::-1])
    assert both == pytest.approx((5, 2 + 2 / np.sqrt(5)), abs=1e-4)


def test_constant_values_beside_an_infinite_one():
    """What does not grow towards a place that may be infinite is the largest value."""
    found = largest_along(lambda at: np.full(len(at), 3.0), END)
    assert found is not None
    assert found[1] == 3
