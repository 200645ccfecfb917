"""Conditions: fields as polynomials, and statements that contradict each other."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bemcontact.errors import ProblemError
from bemcontact.problem import AxisFields, Condition, Field

NUMBER = st.floats(-100, 100)


@given(NUMBER, NUMBER)
def test_field_is_the_polynomial_that_its_keys_spell(x, y):
    field = Field(constant=1, x=2, y=3, xx=4, xy=5, yy=6)
    value = field.at(np.array([[x, y]]))[0]
    assert value == pytest.approx(1 + 2 * x + 3 * y + 4 * x**2 + 5 * x * y + 6 * y**2, rel=1e-12, abs=1e-9)


def test_number_is_a_constant_field():
    condition = Condition.model_validate({"pressure": 50.625})
    assert condition.pressure == Field(constant=50.625)
    np.testing.assert_array_equal(condition.pressure.at(np.zeros((3, 2))), 50.625)


def test_axes_that_are_given_are_listed():
    assert AxisFields().given == ()
    assert AxisFields(y=Field(constant=0)).given == ("y",)


def test_displacement_along_one_axis_goes_with_traction_along_the_other():
    condition = Condition(displacement=AxisFields(x=Field(constant=0)), traction=AxisFields(y=Field(constant=1)))
    assert (condition.displacement.given, condition.traction.given) == (("x",), ("y",))


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({}, "states nothing"),
        ({"displacement": {}}, "states nothing"),
        ({"pressure": 1, "traction": {"x": 1}}, "leaves no room for traction"),
        ({"pressure": 1, "displacement": {"x": 1}}, "leaves no room for displacement"),
        ({"displacement": {"y": 0}, "traction": {"y": 1}}, "both displacement and traction are given along y"),
        ({"traction": {"z": 1}}, "traction.z: unknown key 'z'"),
        ({"pressure": {}}, "pressure: an empty mapping states nothing"),
        ({"pressure": True}, "pressure: expected a number, or a mapping"),
        ({"pressure": {"xxx": 1}}, "pressure.xxx: unknown key 'xxx'; did you mean 'xx'?"),
    ],
)
def test_contradictions_and_emptiness_are_refused(keys, words):
    with pytest.raises(ProblemError) as caught:
        Condition(**keys)
    assert words in str(caught.value)
