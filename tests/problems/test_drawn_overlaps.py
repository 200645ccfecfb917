"""Bodies that are drawn over each other: what is refused, and what only looks like it."""

import math

import numpy as np
import pytest
from messages import assert_states
from several_bodies import HELD, block, circle, elastic, polygon, problem, rigid

from bemcontact import Problem
from bemcontact.errors import ProblemError
from bemcontact.problems.boundary import Boundary
from bemcontact.problems.drawn_overlaps import depth_in, drawn_body

BASE = {"base": elastic(block((-9, 9), (-2, -1)), HELD)}


def with_others(**bodies) -> Problem:
    """A disk of radius 1 on a base, and other bodies that no contact names."""
    both = {"disk": elastic({"outer": [circle("rim", 1)]}), **BASE}
    return problem({**both, **bodies}, accuracy=0.01, seat=["disk", "base"])


def refused(**bodies) -> str:
    with pytest.raises(ProblemError) as caught:
        with_others(**bodies)
    return str(caught.value)


@pytest.mark.parametrize(
    ("placed", "facts"),
    [
        ({}, "bodies.other.copy_of: …'other' lies exactly on 'disk'; give shift or rotate"),
        ({"rotate": 360.0}, "its shift and rotate leave it where"),
        ({"rotate": 77.0}, "its shift and rotate leave it where"),  # a circle about its center
        ({"rotate": 90.0, "about": [1, 0], "shift": [-1, 1]}, "its shift and rotate leave it where"),
    ],
)
def test_a_copy_at_the_place_of_its_original_is_refused(placed, facts):
    text = refused(other={"copy_of": "disk", **placed})
    assert_states(text, facts)
    assert len(text.splitlines()) == 1


def test_an_equal_body_at_the_same_place_is_refused():
    assert_states(refused(other=elastic({"outer": [circle("rim", 1, start=30)]})), "bodies.other: …move one of them")


def test_a_square_that_turns_into_itself_is_refused_and_not_by_half_of_that():
    square = elastic(block((3, 4), (0, 1)))
    text = refused(one=square, two={"copy_of": "one", "rotate": 90.0, "about": [3.5, 0.5]})
    assert_states(text, "'two' lies exactly on 'one'")
    text = refused(one=square, two={"copy_of": "one", "rotate": 45.0, "about": [3.5, 0.5]})
    assert_states(text, "bodies.two: …'two' and 'one' overlap: as drawn, …is 0.15 deep in")


@pytest.mark.parametrize(
    ("outline", "depth"),
    [
        (block((0.8, 3), (-0.5, 0.5)), 0.2),  # over a side of the disk
        (block((-3, 3), (-1e-3, 1e-3)), 1.0),  # a thin bar across it, none of whose corners is inside
        (polygon(a=(0.7, 0), b=(3, -0.1), c=(3, 0.1)), 0.3),  # the tip of a wedge
    ],
)
def test_bodies_that_overlap_and_do_not_touch_are_refused(outline, depth):
    assert_states(refused(other=elastic(outline)), f"bodies.other: …is {depth:.2g} deep in …nothing joins them")


@pytest.mark.parametrize(
    "outline",
    [
        block((1, 3), (-0.5, 0.5)),  # touches the disk
        block((1 - 5e-5, 3), (-0.5, 0.5)),  # so it does up to rounded coordinates
        {"outer": [circle("outside", 3)], "holes": [[circle("bore", 1, start=20, hole=True)]]},  # around it, flush
        {"outer": [{"name": "a", "start": [0, 1], "end": [1, 3]}, {"name": "b", "end": [-1, 3]}, {"name": "c"}]},
    ],
)
def test_bodies_that_touch_are_not_refused(outline):
    disk = {"disk": elastic({"outer": [circle("rim", 1)]}), "base": elastic(block((-9, 9), (-5, -4)), HELD)}
    pair = ({"kind": "arc", "name": "rim", "center": [0, 9], "radius": 1, "angles": [0, 360]},)
    bodies = {**disk, "other": elastic(outline), "far": elastic({"outer": [*pair]})}
    assert problem(bodies, accuracy=0.01, seat=["far", "base"]).several


def test_a_shared_edge_of_two_divisions_is_no_overlap():
    """An arc and the arc that fits it, one of them in two edges, on bodies side by side."""
    inner = [{"name": "rim", "kind": "arc", "center": [5, 5], "radius": 1, "angles": [0, 180]}, {"name": "flat"}]
    outer = [
        {"name": "left", "kind": "arc", "center": [5, 5], "radius": 1, "angles": [180, 100]},
        {"name": "right", "kind": "arc", "center": [5, 5], "radius": 1, "angles": [100, 0]},
        {"name": "foot", "end": [7, 5]},
        {"name": "out", "kind": "arc", "center": [5, 5], "radius": 2, "angles": [0, 180]},
        {"name": "other foot"},
    ]
    assert with_others(inner=elastic({"outer": inner}), outer=elastic({"outer": outer})).several


def test_rigid_bodies_may_overlap_each_other():
    """A shape may be made of two of them: they never move into each other by forces."""
    one, two = rigid(block((-1, 1), (-3, -2))), rigid(block((0, 2), (-3.5, -2)))
    bodies = {"up": elastic(block((-1, 2), (-2, -1))), "one": one, "two": two}
    assert problem(bodies, accuracy=0.01, a=["up", "one"], b=["up", "two"]).several


@pytest.mark.parametrize("turn", [0.0, 33.0])
def test_the_depth_is_that_of_the_deepest_place(turn):
    """A bar of width 2 h across an edge of another body is h deep in it at the middle."""
    h, c, s = 1e-2, math.cos(math.radians(turn)), math.sin(math.radians(turn))
    corners = np.array([[-3, -h], [3, -h], [3, h], [-3, h]]) @ [[c, s], [-s, c]]
    bar = drawn_body("bar", Boundary.model_validate(polygon(**dict(zip("abcd", corners.tolist(), strict=True)))))
    disk = drawn_body("disk", Boundary.model_validate({"outer": [circle("rim", 1)]}))
    assert depth_in(disk, bar, 1e-6).most == pytest.approx(h, rel=0.2)
    assert depth_in(bar, disk, 1e-6).most == pytest.approx(1, abs=1.1 * h)
    assert depth_in(disk, bar, 1e-6).least < -0.9
