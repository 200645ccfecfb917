"""Conditions and loads: fields as polynomials, and contradictions that are refused."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bemcontact.errors import ProblemError
from bemcontact.problems import AxisFields, Centrifugal, Condition, Field, Gravity, Loads, Springs, Temperature
from bemcontact.problems.conditions import Along

NUMBER = st.floats(-100, 100)


@given(NUMBER, NUMBER)
def test_field_is_the_polynomial_of_its_keys(x, y):
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
        ({}, "the condition is empty"),
        ({"displacement": {}}, "the condition is empty"),
        ({"pressure": 1, "traction": {"x": 1}}, "traction cannot be given too"),
        ({"pressure": 1, "displacement": {"x": 1}}, "displacement cannot be given too"),
        ({"displacement": {"y": 0}, "traction": {"y": 1}}, "both displacement and traction are given along y"),
        ({"traction": {"z": 1}}, "traction.z: unknown key 'z'"),
        ({"pressure": {}}, "pressure: the mapping is empty"),
        ({"pressure": True}, "pressure: expected a number, or a mapping"),
        ({"pressure": {"xxx": 1}}, "pressure.xxx: unknown key 'xxx'; did you mean 'xx'?"),
        ({"fixed": False}, "fixed: false says nothing"),
        ({"fixed": True, "displacement": {"y": 1}}, "fixed is displacement 0 along y"),
        ({"symmetry": "z"}, "symmetry: expected 'x' or 'y', found the text 'z'"),
        ({"symmetry": "x", "displacement": {"x": 1}}, "symmetry is displacement 0 along x"),
        ({"fixed": True, "pressure": 1}, "displacement cannot be given too"),
        ({"force": {"y": 1, "at": 2}}, "force[0]: a force at a place needs a width"),
        ({"force": {"y": 1, "width": 1, "at": [2, 0]}}, "found a list of 2; give the distance along the edge from its"),
        ({"force": {"width": 2}}, "force[0]: the force is zero"),
        ({"force": -400}, "force: a force has a direction; write {y: -400}, or x"),
        ({"force": {"y": 1, "position": 10}}, "write at: 10, the distance of its middle from the start of the edge"),
        ({"traction": {"along": [[0, 1], [2, 1]]}}, "the axis comes first: {y: {along: [[0, 10], [5, 20]]}}"),
        ({"pressure": {"table": [[0, 1], [2, 1]]}}, "is along: [[0, 10], [5, 20]]"),
        ({"force": {"y": 1}, "displacement": {"y": 0}}, "both displacement and force are given along y"),
        ({"force": [{"y": 1}, {"y": 1, "width": -2}]}, "force[1].width: must be greater than 0"),
        ({"pressure": {"along": [[0, 1]]}}, "a table has two or more pairs"),
        ({"pressure": {"along": [[-1, 1], [2, 1]]}}, "a table has two or more pairs"),
        ({"pressure": {"along": [[3, 1], [2, 1]]}}, "must ascend; 2 stands after 3"),
        ({"pressure": {"along": [[1, 1], [1, 2], [1, 3]]}}, "more than two values at the distance 1"),
        ({"displacement": {"x": {"along": [[0, 1], [2, 1]]}}}, "along is for loads"),
        ({"spring": {}}, "spring: the springs have no stiffness"),
        ({"spring": 50}, "spring: a spring has a direction; write {normal: 50}"),
        ({"spring": {"normal": -1}}, "spring.normal: must be greater than 0"),
        ({"spring": {"k": 1}}, "write normal: 50 for springs across the edge"),
        ({"spring": {"x": 1}, "displacement": {"x": 0}}, "both displacement and spring are given along x"),
        ({"spring": {"normal": 1}, "displacement": {"x": 0}}, "spring.normal needs an edge without"),
        ({"spring": {"tangent": 1}, "fixed": True}, "spring.tangent needs an edge without"),
    ],
)
def test_contradictory_and_empty_conditions_are_refused(keys, words):
    with pytest.raises(ProblemError) as caught:
        Condition(**keys)
    assert words in str(caught.value)


def test_springs_pull_along_their_directions():
    """On a face with the normal (0.6, 0.8): stiffness across it, along it, and along the axes, added."""
    n, t = np.array([0.6, 0.8]), np.array([-0.8, 0.6])
    across, along, axes = (
        Springs(**keys).matrices(n[None])[0] for keys in ({"normal": 3}, {"tangent": 2}, {"x": 5, "y": 7})
    )
    np.testing.assert_allclose(np.column_stack([across @ n, across @ t]), np.column_stack([3 * n, 0 * t]), atol=1e-15)
    np.testing.assert_allclose(np.column_stack([along @ n, along @ t]), np.column_stack([0 * n, 2 * t]), atol=1e-15)
    np.testing.assert_array_equal(axes, np.diag([5, 7]))
    every = Springs(normal=3, tangent=2, x=5, y=7).matrices(n)
    np.testing.assert_allclose(every, across + along + axes, rtol=1e-15)


def test_springs_go_with_loads_and_with_displacement_along_the_other_axis():
    assert Condition(spring={"y": 1}, displacement={"x": 0}).holds
    assert Condition(spring={"normal": 1}, pressure=2).presses
    assert not Condition(spring={"normal": 1}).presses
    assert not Condition(pressure=2).holds


def test_fixed_and_symmetry_are_displacements():
    held = Condition(displacement={"x": 0, "y": 0})
    assert Condition(fixed=True) == held
    assert Condition(**held.to_dict()) == held
    assert Condition(symmetry="y") == Condition(displacement={"y": 0})
    assert Condition(symmetry="y", displacement={"x": 1}) == Condition(displacement={"x": 1, "y": 0})
    assert Condition(symmetry="x", traction={"y": 1}).traction.y == Field(constant=1)


def test_a_table_is_linear_between_its_pairs_and_jumps_where_two_have_one_distance():
    """On which side of a jump a place is, the place within the same piece tells; beyond the table the value is 0."""
    field = Field(constant=1, along=[[1, 2], [3, 6], [3, -1], [4, 0]])
    at, within = np.array([0.5, 1.0, 1.0, 2.0, 3.0, 3.0, 3.5, 4.5]), np.array([0.4, 0.9, 1.1, 2.0, 2.9, 3.1, 3.5, 4.5])
    np.testing.assert_allclose(
        field.at(np.zeros((8, 2)), Along(at, within, 5.0)), 1 + np.array([0, 0, 2, 4, 6, -1, -0.5, 0]), rtol=1e-15
    )


@given(st.floats(0.1, 2), st.floats(1, 4), st.integers(-9, 9), st.integers(-9, 9))
def test_a_force_is_the_integral_of_its_traction(width, at, x, y):
    force = Condition(force={"x": x, "y": y + 200, "width": width, "at": at}).force[0]
    first, last = force.part(5.0)
    middle = np.array([first + last, 2 * first - 0.1, 2 * last + 0.1]) / 2
    traction = force.traction(Along(middle, middle, 5.0))
    np.testing.assert_allclose(traction[0] * (last - first), [x, y + 200], rtol=1e-12)
    assert not traction[1:].any()


def test_loads_are_absent_unless_given():
    assert Loads() == Loads(gravity=None, centrifugal=None, temperature=None)
    assert Centrifugal(density=1, angular_velocity=2).center == (0, 0)


def test_density_is_positive():
    with pytest.raises(ProblemError, match=r"gravity\.density: must be greater than 0, found 0"):
        Loads(gravity={"density": 0, "acceleration": [0, -9.81]})
    with pytest.raises(ProblemError, match="acceleration: expected two numbers"):
        Gravity(density=1, acceleration=-9.81)


def test_temperature_is_linear_in_the_coordinates():
    change = Field(constant=20, x=1, y=-1)
    assert Temperature(expansion=1e-5, change=change).change == change
    with pytest.raises(ProblemError, match="may have constant, x and y only; leave out xx, yy"):
        Temperature(expansion=1e-5, change=Field(xx=1, yy=1))
