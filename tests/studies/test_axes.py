"""Axes of a study: how they are written, and what is refused."""

import re
from typing import Any

import numpy as np
import pytest

from bemcontact.errors import ProblemError
from bemcontact.problems.units import Units
from bemcontact.studies.axes import axes_of, written_axes, written_axis


@pytest.mark.parametrize(
    ("text", "keys", "values"),
    [
        ("a.b=1:2:3", "a.b", [1.0, 1.5, 2.0]),
        ("a=0:0.3:4", "a", [0.0, 0.1, 0.2, 0.3]),  # the decimals that a person expects
        ("a=3,1e2,-4", "a", [3, 100.0, -4]),
        ("a=[1, 2],[3, 4]", "a", [[1, 2], [3, 4]]),
        ("a={x: 1, y: 2},{x: 3}", "a", [{"x": 1, "y": 2}, {"x": 3}]),
        ("a={y: -1},{y: -2}", "a", [{"y": -1}, {"y": -2}]),  # two colons, and no range
        ("its size: a.x,b.y=1,2", "its size: a.x,b.y", [1, 2]),
        ("mesh of: variant=fine,1:2:3", "mesh of: variant", ["fine", "1:2:3"]),
        ("a='x, y',z", "a", ["x, y", "z"]),
        ("variant=paper,stated mesh", "variant", ["paper", "stated mesh"]),
        ("case=1:2:3", "case", ["1:2:3"]),  # a name may have colons
        ("a.x,b.y=1,2", "a.x,b.y", [1, 2]),
        ("a=1 GPa:-2e1 GPa:2", "a", ["1.0 GPa", "-20.0 GPa"]),
        ("a=7 N/mm:8 N/mm:3", "a", ["7.0 N/mm", "7.5 N/mm", "8.0 N/mm"]),
    ],
)
def test_written_axes_are_read(text: str, keys: str, values: list[Any]):
    assert written_axis(text) == (keys, values)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("a", "no '='"),
        ("a=", "a value is missing behind '='"),
        ("a=1,2,", "a value is missing behind '=' or at a comma"),
        ("variant=fine,,coarse", "a value is missing"),
        ("a=1:2", "expected a:b:n"),
        ("a=1:2:x", "two numbers and how many"),
        ("a=1:2:1", "at least 2 values; found 1:2:1; write one value by itself"),
        ("a=1:1:4", "two different"),
        ("a=1:inf:4", "finite"),
        ("a=[1", "bracket"),
        ("a={-1,-2}", "expected a:b:n for n values from a to b, or v1,v2,v3; found {-1,-2}"),
        ("a=1..2", "expected a:b:n"),
        ("a=1 GPa:2 MPa:2", "both ends of a range need one unit; found GPa and MPa"),
    ],
)
def test_badly_written_axes_are_refused(text: str, says: str):
    with pytest.raises(ProblemError, match=re.escape(says)):
        written_axis(text)


def test_values_with_units_are_numbers_in_the_units_of_the_problem():
    """So that a page has them on an axis of numbers, and equal ones are found."""
    in_mm, key = Units(length="mm", force="N"), "material.young_modulus"
    (axis,) = axes_of({key: ["70 GPa", 80e3, "9e10 Pa"]}, in_mm)
    assert axis.values == pytest.approx((70e3, 80e3, 90e3), rel=1e-15)
    for values, says in (
        (["70 GPa", 70000], "occurs twice"), (["70 mm", 1], "expected a stress such as 210 GPa; found 70 mm"),
    ):  # fmt: skip
        with pytest.raises(ProblemError, match=says):
            axes_of({key: values}, in_mm)
    with pytest.raises(ProblemError, match=r"give units\.length as one of"):
        axes_of({key: ["70 GPa"]}, Units())


def test_a_key_given_twice_is_refused():
    with pytest.raises(ProblemError, match="a is given twice"):
        written_axes(["a=1,2", "a=3,4"])


def test_arrays_and_tuples_become_lists_of_numbers():
    (axis,) = axes_of({("a", "b"): np.array([1.0, 2.0])}, Units())
    assert (axis.keys, axis.values, axis.written) == (("a", "b"), (1.0, 2.0), "a,b")
    assert axes_of({"a": [(1, 2), (3, 4)]}, Units())[0].values == ([1, 2], [3, 4])


@pytest.mark.parametrize(
    ("keys", "name"),
    [
        ("material.young_modulus", "material.young_modulus"),
        ("boundary.outer.rim.radius,boundary.outer.rim.center[1],boundary.outer.axis.start[1]", "rim.radius + 2 more"),
        ("a.top.force[0].y,a.left.force[0].y", "top.force[0].y + 1 more"),
        ("a.rim.center[0],a.rim.center[1]", "center[0] + 1 more"),  # a number says nothing without its list
        ("load_cases.wind,load_cases.snow", "wind + 1 more"),
        ("a.b,a.b.c", "b + 1 more"),
        ("radius: a.b,c.d", "radius"),
        (" the load : load_cases.a:b", "the load"),  # of colons, only that before the key ends a name
        ("load_cases.a:b", "load_cases.a:b"),
        (("a.x: b", "c.y: d"), "a.x: b + 1 more"),
    ],
)
def test_the_name_of_an_axis_is_that_of_the_user_or_what_is_particular_in_the_first_key(keys: Any, name: str):
    (axis,) = axes_of({keys: [1]}, Units())
    assert axis.name == name


def test_axes_of_one_name_have_all_their_keys_in_it():
    axes = axes_of({"a.x,a.y": [1], "b.x,b.y": [1], "c.z": [1]}, Units())
    assert [axis.name for axis in axes] == ["a.x,a.y", "b.x,b.y", "c.z"]


@pytest.mark.parametrize(
    ("vary", "says"),
    [
        ({"size: a": [1], "size: b": [1]}, "two axes have the name 'size'"),
        ({"b: a": [1], "b": [1]}, "two axes have the name 'b'"),
        ({"peak: a": [1]}, "'peak' is another column of the table"),
        ({"mesh_error: a": [1]}, "'mesh_error' is another column of the table"),
        ({"case: a": [1]}, "'case' is another column of the table"),  # load cases may be added to the axes
        ({}, "nothing to vary"),
        ({(): [1]}, "has no key"),
        ([], "vary must be a Mapping"),
        ({"a": []}, "no values"),
        ({"a": "12"}, "a list of values"),
        ({"a": 3.0}, "a list of values"),
        ({"a": [1, 1.0]}, "occurs twice"),
        ({"a": [[1, 2], [1.0, 2.0]]}, "occurs twice"),
        ({"a": [0.0, -0.0]}, "occurs twice"),
        ({"a": [float("nan")]}, "can be varied"),
        ({"a": [object()]}, "can be varied"),
        ({"a,a": [1]}, "varied twice"),
        ({"a": [1], "b,a": [1]}, "varied twice"),
        ({"variant": [1]}, "a name is needed"),
        ({"variant,a": ["x"]}, "varied alone"),
        ({"a": range(2000), "b": range(2000)}, "4000000 members"),
    ],
)
def test_axes_that_make_no_study_are_refused(vary: Any, says: str):
    with pytest.raises(ProblemError, match=re.escape(says)):
        axes_of(vary, Units())
