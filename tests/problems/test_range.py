"""Numbers of any size at any place of a spec: a problem, or a sentence with the place; never a warning."""

import copy
import warnings
from collections.abc import Iterator
from contextlib import suppress
from math import isfinite
from typing import Any

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

import bemcontact
from bemcontact.checks.arguments import LARGEST_NUMBER
from bemcontact.problems.boundary import FARTHEST, Boundary
from bemcontact.problems.validation import LARGEST_STATED
from bemcontact.spec.yaml_1_2 import to_yaml

SPEC = """\
name: block with a bore
material: {young_modulus: 1000.0, poisson_ratio: 0.3}
boundary:
  outer:
    - {name: bottom, start: [0, 0], elements: 4, grading: {ratio: 2.0, towards: [20.0, 0.0]}}
    - {name: right, start: [40, 0], elements: 2, ends_at: [0.5]}
    - {name: top, start: [40, 20], elements: 4}
    - {name: left, start: [0, 20], elements: 2}
  holes:
    - - {name: bore, kind: arc, center: [20, 10], radius: 5, angles: [360, 0], elements: 8}
conditions:
  left: {displacement: {x: 0.001}}
  top: {pressure: {constant: 3, x: 0.1}}
loads:
  gravity: {density: 1.0, acceleration: [0, -1.0]}
  centrifugal: {density: 1.0, angular_velocity: 0.1, center: [0, 0]}
  temperature: {expansion: 0.001, change: {constant: 1.0, y: 0.1}}
contact_zones:
  foot: {edges: bottom, surface: {kind: circle, center: [20, -100], radius: 100, body: outside}}
tools: {anvil: {zones: foot, displacement: {y: 0.001, rotation: 0.001}, point: [20, 0]}}
reference: {it: {kind: hertz, load: 3.0, radius: 10.0}}
"""
DATA = yaml.safe_load(SPEC)
EXTREMES = [
    sign * value for value in (5e-324, 1e-300, 1e-200, 1e-29, 1e-12, 1e12, 1e29, 1e99, 1e200, 1e308) for sign in (1, -1)
] + [10**400]


def numbers(data: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Paths of all numbers."""
    if isinstance(data, int | float):
        yield path
    for key, value in data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ():
        yield from numbers(value, (*path, key))


PATHS = [*numbers(DATA)]


@settings(max_examples=30)
@given(st.lists(st.tuples(st.sampled_from(PATHS), st.sampled_from(EXTREMES)), min_size=1, max_size=3))
def test_any_number_gives_a_problem_or_a_sentence_with_its_place(changes):
    data = copy.deepcopy(DATA)
    for path, value in changes:
        below = data
        for key in path[:-1]:
            below = below[key]
        below[path[-1]] = value
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            bemcontact.loads(to_yaml(data), "a.yaml")
        except bemcontact.SpecError as error:
            for line in str(error).splitlines():
                assert line.startswith("a.yaml:"), line
                assert line.split(":")[1].isdecimal(), line
        with suppress(bemcontact.ProblemError):
            bemcontact.Problem(**data)


@pytest.mark.parametrize("value", [0.9 / LARGEST_STATED, 1e-300, 5e-324])
@pytest.mark.parametrize("key", ["material.young_modulus", "conditions.top.pressure", "loads.gravity.density"])
def test_numbers_whose_powers_underflow_are_refused(key, value):
    problem = bemcontact.loads(SPEC)
    with pytest.raises(bemcontact.ProblemError, match="too small to compute with"):
        problem.with_value(key, value)
    assert problem.with_value(key, 1.1 / LARGEST_STATED)


@pytest.mark.parametrize("size", [1e-31, 1e-200, 5e-310])
def test_a_body_too_small_to_compute_with_is_refused(size):
    corners = [[0, 0], [4 * size, 0], [4 * size, 2 * size], [0, 2 * size]]
    edges: Any = [{"name": f"e{i}", "start": corner, "elements": 2} for i, corner in enumerate(corners)]
    with pytest.raises(bemcontact.ProblemError, match="too small to compute with; choose another unit of length"):
        Boundary(outer=edges)


def test_points_that_coincide_and_edges_that_are_too_short_are_said_to_be():
    corners = [[0, 0], [4e9, 0], [4e9, 2e8], [1e-9, 2e8], [0, 2e8]]
    edges: Any = [{"name": f"e{i}", "start": corner} for i, corner in enumerate(corners)]
    with pytest.raises(bemcontact.ProblemError, match="'e3' has the length 1e-09, which is too short beside a body"):
        Boundary(outer=edges)
    with pytest.raises(bemcontact.ProblemError, match="all points of the boundary coincide"):
        Boundary(outer=[{**edge, "start": [1, 1]} for edge in edges])


@pytest.mark.parametrize("ratio", [0.5000000001, -1.00000000001, -1.0])
def test_a_number_out_of_range_does_not_look_like_the_limit(ratio):
    with pytest.raises(bemcontact.ProblemError) as caught:
        bemcontact.loads(SPEC).with_value("material.poisson_ratio", ratio)
    assert str(caught.value).endswith(f"less than 0.5, found {repr(ratio).removesuffix('.0')}")


@pytest.mark.parametrize("factor", [1e300, -1e31, 1e-300])
def test_a_factor_of_a_load_case_has_no_unit(factor):
    cases = {"load_cases": {"a": {"conditions": {"top": {"pressure": 1}}}}}
    data = {**DATA, **cases, "combinations": {"b": {"a": factor}}}
    with pytest.raises(bemcontact.ProblemError, match="a factor is 0, or between 1e-30 and"):
        bemcontact.Problem(**data)


@pytest.mark.parametrize("far", [10 * FARTHEST * 44.7, 1e25])
def test_bodies_and_surfaces_far_from_the_origin_or_very_wide_are_refused(far):
    for path in (("boundary", "holes", 0, 0, "radius"), ("contact_zones", "foot", "surface", "radius")):
        data = copy.deepcopy(DATA)
        below = data
        for key in path[:-1]:
            below = below[key]
        below["radius"] = far
        with pytest.raises(bemcontact.ProblemError, match=r"leave too few digits|which is too short beside a body"):
            bemcontact.Problem(**data)


@settings(max_examples=8)
@given(st.floats(0, 360), st.integers(1, 7), st.floats(0.1, 1.0))
def test_a_hole_that_touches_the_outline_is_refused_wherever_its_arcs_begin(angle, parts, size):
    """The circle touches the bottom in one point; its polygon need not have a corner there."""
    angles = [angle - 360 * i / parts for i in range(parts + 1)]
    hole = [
        {"name": f"h{i}", "kind": "arc", "center": [20, 10 * size], "radius": 10 * size, "elements": 16,
         "angles": [angles[i], angles[i + 1]]}
        for i in range(parts)
    ]  # fmt: skip
    data = {**copy.deepcopy(DATA), "boundary": {"outer": DATA["boundary"]["outer"], "holes": [hole]}}
    with pytest.raises(bemcontact.ProblemError, match="crosses or touches 'bottom'"):
        bemcontact.Problem(**data)


@settings(max_examples=8)
@given(st.floats(1e-3, 0.2))
def test_a_hole_near_the_outline_is_not_refused(ligament):
    data = copy.deepcopy(DATA)
    data["boundary"]["holes"][0][0].update(radius=5, center=[20, 5 + ligament])
    bemcontact.Problem(**data)


def test_a_fillet_that_is_tangent_to_its_line_is_not_refused():
    right = "{name: right, start: [40, 0], elements: 2, ends_at: [0.5]}"
    fillet = "{name: round, kind: arc, center: [30, 10], radius: 10, angles: [0, 90], elements: 4}"
    text = SPEC.replace(right, f"{{name: right, start: [40, 0], elements: 2}}\n    - {fillet}")
    bemcontact.loads(text.replace("top, start: [40, 20]", "top, start: [30, 20]"))


def test_products_of_three_stated_numbers_fit_into_arrays():
    """Two limits have this reason: moments p L² are computed from three numbers, and squares of them are finite."""
    assert LARGEST_STATED**3 < LARGEST_NUMBER
    assert isfinite(LARGEST_NUMBER**2)
