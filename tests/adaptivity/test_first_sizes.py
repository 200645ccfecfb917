"""First sizes against the geometry: turning angle, thickness, relative curvature, corners."""

from math import pi, radians, sqrt

import numpy as np
import pytest
import several_bodies
from several_bodies import elastic

from bemcontact.adaptivity import mesh_sizes
from bemcontact.adaptivity.first_sizes import sized_outline, surface_sizes
from bemcontact.adaptivity.mesh_sizes import first_mesh
from bemcontact.adaptivity.sizes import GROWTH, SizeField
from bemcontact.problems import Problem
from bemcontact.problems.nearest_places import surface_corners

PLANE = {"kind": "plane", "point": [0, 0], "normal": [0, 1]}


def block(width: float, height: float, surface: dict | None = None) -> Problem:
    """A block that stands on a surface."""
    corners = [("bottom", 0, 0), ("right", width, 0), ("top", width, height), ("left", 0, height)]
    return Problem.model_validate(
        {
            "name": "block",
            "material": {"young_modulus": 1000, "poisson_ratio": 0.3},
            "boundary": {"outer": [{"name": name, "start": [x, y]} for name, x, y in corners]},
            "conditions": {"top": {"pressure": 1}},
            "contact_zones": {"floor": {"edges": "bottom", "surface": surface or PLANE}},
        }
    )


def ring(inner: float, outer: float) -> Problem:
    """A ring in a housing."""
    return Problem.model_validate(
        {
            "name": "ring",
            "material": {"young_modulus": 1000, "poisson_ratio": 0.3},
            "boundary": {
                "outer": [{"name": "rim", "kind": "arc", "center": [0, 0], "radius": outer, "angles": [0, 360]}],
                "holes": [[{"name": "bore", "kind": "arc", "center": [0, 0], "radius": inner, "angles": [360, 0]}]],
            },
            "conditions": {"bore": {"pressure": 1}},
            "contact_zones": {
                "housing": {
                    "edges": "rim",
                    "surface": {"kind": "circle", "center": [0, 0], "radius": outer * 1.001, "body": "inside"},
                }
            },
        }
    )


def test_no_element_of_an_arc_turns_by_more_than_thirty_degrees():
    """A ring as thick as a disk: 12 elements at least on each circle, and no more than the part of the rounding off."""
    problem = first_mesh(ring(1.0, 30.0))
    for name in ("rim", "bore"):
        turns = 2 * pi * np.diff(problem.edge(name).breakpoints(1))
        assert turns.max() <= radians(30) * (1 + 1e-9)


def test_the_thickness_of_a_strip_is_its_height():
    """Straight across: each sample of the long sides has one opposite to it; the short sides are farther."""
    shape = sized_outline(block(40, 2))
    long = (shape.positions[0] > 5) & (shape.positions[0] < 35)
    assert shape.thickness[0][long] == pytest.approx(2.0, rel=1e-12)


@pytest.mark.parametrize(("inner", "outer"), [(9.0, 10.0), (5.0, 10.0)])
def test_the_thickness_of_a_ring_is_the_difference_of_its_radii(inner: float, outer: float):
    """Up to the samples: the nearest one opposite is at most half a step φ away, which adds R r φ²/(2 t) to t."""
    shape = sized_outline(ring(inner, outer))
    t = outer - inner
    for own, other in zip(shape.thickness, shape.thickness[::-1], strict=True):
        step = 2 * pi / len(other)
        assert own.min() >= t * (1 - 1e-12)
        assert own.max() <= t + inner * outer * (step / 2) ** 2 / (2 * t) * (1 + 1e-6)


@pytest.mark.parametrize("radius", [2.0, 20.0])
def test_half_of_the_radius_of_relative_curvature_where_a_surface_comes_near(radius: float):
    """A flat face and a circle that touches it at 11: the radius of relative curvature is that of the circle."""
    circle = {"kind": "circle", "center": [11, -radius], "radius": radius, "body": "outside"}
    problem = block(40, 20, circle)
    limits, marks = surface_sizes(problem, sized_outline(problem))
    (limit,) = limits[0]
    assert limit.low == limit.high == pytest.approx(11, abs=1e-3)
    assert limit.size == pytest.approx(radius / 2, rel=1e-3)
    assert marks == {}


def test_curvatures_of_body_and_surface_add():
    """An arc of radius 5 in a socket of radius 6: 1/5 - 1/6 = 1/30, half of the radius is 15."""
    y = 5 - sqrt(25 - 9)
    problem = Problem.model_validate(
        {
            "name": "foot in a socket",
            "material": {"young_modulus": 1000, "poisson_ratio": 0.3},
            "boundary": {
                "outer": [
                    {"name": "foot", "kind": "arc", "center": [0, 5], "start": [-3, y], "end": [3, y]},
                    {"name": "right", "end": [3, 8]},
                    {"name": "top", "end": [-3, 8]},
                    {"name": "left"},
                ]
            },
            "conditions": {"top": {"pressure": 1}},
            "contact_zones": {
                "socket": {
                    "edges": "foot",
                    "surface": {"kind": "circle", "center": [0, 6], "radius": 6, "body": "inside"},
                }
            },
        }
    )
    limits, _ = surface_sizes(problem, sized_outline(problem))
    (limit,) = limits[0]
    assert limit.low == pytest.approx(problem.edge("foot").length / 2, abs=1e-3)
    assert limit.size == pytest.approx(15, rel=1e-2)


def test_corners_of_a_polyline_are_ends_of_elements():
    kinked = {"kind": "polyline", "points": [[-10, 0], [12, 0], [31, -0.1], [60, -1]]}
    problem = block(40, 20, kinked)
    surface = problem.contact_zones["floor"].surface
    corners = [corner.fraction for corner in surface_corners(problem.edge("bottom"), surface)]
    assert corners == pytest.approx([12 / 40, 31 / 40], rel=1e-9)
    ends = first_mesh(problem).edge("bottom").breakpoints(1)
    for fraction in corners:
        assert np.abs(ends - fraction).min() < 1e-9


def test_a_least_gap_has_elements_of_the_size_of_the_radius_beside_it():
    """A rod of radius 0.5 under a face of 40: the size is half of the radius, and 1/100 of the edge at least, 0.4.

    It grows by `GROWTH` from there, so that an element is h (e^G - 1) / G long at most; see the tests of sizes.
    """
    circle = {"kind": "circle", "center": [11.3, -0.5], "radius": 0.5, "body": "outside"}
    problem = first_mesh(block(40, 20, circle))
    ends = 40 * problem.edge("bottom").breakpoints(1)
    at = int(np.searchsorted(ends, 11.3))
    assert ends[at] - ends[at - 1] <= 0.4 * (np.exp(GROWTH) - 1) / GROWTH


def test_a_corner_halves_the_size():
    """A square of 8: half of an edge, and half of that at corners."""
    problem = block(8, 8)
    shape = sized_outline(problem)
    limits = np.array(shape.limits[0])
    at = SizeField(loop=shape.loops[0], limits=limits, layers=()).at(shape.loops[0].joints)
    assert (at <= 2.0).all()


@pytest.mark.parametrize("names", [("layer", "under"), ("over", "layer")])
def test_a_wall_that_is_touched_on_both_sides_has_elements_of_a_third_of_it(names: tuple[str, str]):
    """On the first side of one contact and on the second of the other, and so on the other bodies that follow it."""
    bodies = {
        "over": elastic(several_bodies.block((-5, 5), (1, 11)), {"top": {"pressure": 1.0}}),
        "layer": elastic(several_bodies.block((-5, 5), (0, 1))),
        "under": elastic(several_bodies.block((-5, 5), (-10, 0)), {"bottom": {"displacement": {"x": 0, "y": 0}}}),
    }
    below, above = ["layer/bottom", "under/top"], ["over/bottom", "layer/top"]
    one, both = (
        several_bodies.problem(bodies, 0.01, low=below),
        several_bodies.problem(bodies, 0.01, low=below, high=above),
    )
    assert _longest(one, f"{names[0]}/bottom") > 1 / 2
    for name in (f"{names[0]}/bottom", f"{names[1]}/top"):
        assert _longest(both, name) <= 1.01 / 3  # thickness is measured between samples


def _longest(stated: Problem, edge: str) -> float:
    """Longest element of an edge on the first mesh [L]."""
    found = next(item for item in first_mesh(stated).edges if item.name == edge)
    return float(np.diff(found.breakpoints(1)).max() * found.length)


def test_the_first_elements_are_found_once_for_all_loads_and_anew_for_another_gap(monkeypatch: pytest.MonkeyPatch):
    """What is kept is what is computed: with nothing kept the elements are the same."""
    near = {"kind": "circle", "center": [4, -3], "radius": 3, "body": "outside"}
    stated = [
        block(10, 5, near),
        block(10, 5, near).with_value("conditions.top.pressure", 7),
        block(10, 5, {**near, "center": [4, -1], "radius": 1}),
    ]
    kept = [_ends(item) for item in stated]
    found = []
    original = mesh_sizes.Loop.element_ends
    monkeypatch.setattr(mesh_sizes.Loop, "element_ends", lambda *given: found.append(given) or original(*given))
    assert [_ends(item) for item in stated] == kept
    assert not found
    for function in (mesh_sizes._first_limits, mesh_sizes._first_ends):
        function.cache_clear()
    assert [_ends(item) for item in stated] == kept
    assert len(found) == 2
    assert kept[0] == kept[1] != kept[2]


def _ends(stated: Problem) -> list[list[float]]:
    """Element ends of all edges on the first mesh."""
    return [item.breakpoints(1).tolist() for item in first_mesh(stated).edges]
