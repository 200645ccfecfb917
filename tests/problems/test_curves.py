"""Comparison of curves with closed forms, and the division of edges into elements."""

from itertools import combinations, pairwise
from math import cos, hypot, pi, radians, sin

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bemcontact.problems.curves import (
    CircularArc,
    Edge,
    EllipticArc,
    Segment,
    graded_ends,
    graded_lengths,
    moved_onto,
    unit_vector,
)

FRACTIONS = np.linspace(0, 1, 41)
CURVES = {
    "segment": Segment(start=(1.0, 2.0), end=(4.0, 6.0)),
    "arc": CircularArc(center=(1.0, -1.0), radii=(8.0, 8.0), start_angle=radians(-90), sweep=radians(70)),
    "clockwise arc": CircularArc(center=(0.0, 0.0), radii=(2.0, 2.0), start_angle=0.4, sweep=-5.0),
    "flat ellipse": EllipticArc(center=(0.0, 0.0), semi_axes=(3.0, 0.3), rotation=0.0, start_angle=0.0, sweep=pi / 2),
    "upright ellipse": EllipticArc(center=(2.0, 1.0), semi_axes=(0.5, 2.0), rotation=0.7, start_angle=3.0, sweep=-4.0),
    "full ellipse": EllipticArc(center=(0.0, 0.0), semi_axes=(3.0, 2.0), rotation=0.0, start_angle=0.0, sweep=2 * pi),
    "needle": EllipticArc(center=(0.0, 0.0), semi_axes=(1.0, 1e-3), rotation=0.0, start_angle=-1.0, sweep=5.0),
}
ELLIPSES = [name for name, curve in CURVES.items() if isinstance(curve, EllipticArc)]


def elliptic_length(curve, first, last):
    """∫ |d(a cos t, b sin t)| by adaptive quadrature with 30 digits, split where a needle bends."""
    a, b = curve.semi_axes
    first, last = sorted((first, last))
    cuts = [first, *(k * pi / 2 for k in range(-20, 21) if first < k * pi / 2 < last), last]
    with mpmath.workdps(30):
        return float(mpmath.quad(lambda t: mpmath.hypot(a * mpmath.sin(t), b * mpmath.cos(t)), cuts))


def edge_on(curve, elements=4, ratio=1.0, towards="start"):
    ends = curve.at(np.array([0.0, 1.0]))
    return Edge(
        name="edge",
        curve=curve,
        start=tuple(ends[0]),
        end=tuple(ends[1]),
        elements=elements,
        ratio=ratio,
        towards=towards,
    )


def test_lengths_of_line_and_arc_are_closed_forms():
    assert CURVES["segment"].length == 5
    assert CURVES["arc"].length == pytest.approx(8 * radians(70), rel=1e-15)
    assert CURVES["clockwise arc"].length == pytest.approx(10, rel=1e-15)


@pytest.mark.parametrize("name", ELLIPSES)
def test_length_of_an_ellipse_agrees_with_quadrature(name):
    curve = CURVES[name]
    expected = elliptic_length(curve, curve.start_angle, curve.start_angle + curve.sweep)
    assert curve.length == pytest.approx(expected, rel=1e-14)


def test_ellipse_with_equal_axes_is_a_circle():
    ellipse = EllipticArc(center=(1.0, 2.0), semi_axes=(3.0, 3.0), rotation=0.3, start_angle=0.2, sweep=1.9)
    circle = CircularArc(center=(1.0, 2.0), radii=(3.0, 3.0), start_angle=0.5, sweep=1.9)
    np.testing.assert_allclose(ellipse.at(FRACTIONS), circle.at(FRACTIONS), rtol=0, atol=4e-15)
    np.testing.assert_allclose(ellipse.tangent_angle(FRACTIONS), circle.tangent_angle(FRACTIONS), rtol=1e-14)


@pytest.mark.parametrize("name", ["arc", "clockwise arc"])
def test_points_of_an_arc_are_on_its_circle(name):
    curve = CURVES[name]
    radius = np.hypot(*(curve.at(FRACTIONS) - np.array(curve.center)).T)
    np.testing.assert_allclose(radius, curve.radii[0], rtol=1e-15)


@pytest.mark.parametrize("name", ELLIPSES)
def test_points_of_an_ellipse_satisfy_its_equation(name):
    curve = CURVES[name]
    c, s = cos(curve.rotation), sin(curve.rotation)
    x, y = (curve.at(FRACTIONS) - np.array(curve.center)).T
    along, across = (c * x + s * y) / curve.semi_axes[0], (c * y - s * x) / curve.semi_axes[1]
    np.testing.assert_allclose(along**2 + across**2, 1, rtol=0, atol=1e-12)


@pytest.mark.parametrize("name", ELLIPSES)
def test_equal_fractions_of_an_ellipse_are_equal_arc_lengths(name):
    curve = CURVES[name]
    c, s = cos(curve.rotation), sin(curve.rotation)
    x, y = (curve.at(np.linspace(0, 1, 8)) - np.array(curve.center)).T
    t = np.arctan2((c * y - s * x) / curve.semi_axes[1], (c * x + s * y) / curve.semi_axes[0])
    t = np.unwrap(t, discont=pi)
    if np.sign(t[-1] - t[0]) != np.sign(curve.sweep):
        pytest.fail("the eccentric angle runs the wrong way")
    lengths = [elliptic_length(curve, *pair) for pair in pairwise(t)]
    np.testing.assert_allclose(lengths, curve.length / 7, rtol=1e-11)


@pytest.mark.parametrize("name", CURVES)
def test_tangent_is_the_derivative_by_arc_length(name):
    curve = CURVES[name]
    step = 1e-6
    slope = (curve.at(FRACTIONS[1:-1] + step) - curve.at(FRACTIONS[1:-1] - step)) / (2 * step * curve.length)
    angle = curve.tangent_angle(FRACTIONS[1:-1])
    # Central differences: the error is step² κ² / 6 of a curve that bends with curvature κ (length 1), plus round-off.
    tolerance = 0.3 if name == "needle" else 1e-7
    np.testing.assert_allclose(slope, np.column_stack([np.cos(angle), np.sin(angle)]), rtol=0, atol=tolerance)
    assert np.all(np.diff(curve.tangent_angle(FRACTIONS)) * getattr(curve, "sweep", 0) >= 0)


@pytest.mark.parametrize("name", CURVES)
def test_polyline_approximates_the_curve_and_has_its_ends(name):
    curve = CURVES[name]
    edge = edge_on(curve)
    line = edge.polyline()
    assert tuple(line[0]) == edge.start
    assert tuple(line[-1]) == edge.end
    side = np.diff(line, axis=0)
    offset = curve.at(FRACTIONS)[:, None] - line[:-1]
    along = np.clip(np.einsum("ksi,si->ks", offset, side) / np.sum(side**2, axis=1), 0, 1)
    stray = np.hypot(*np.moveaxis(offset - along[:, :, None] * side, 2, 0)).min(axis=1)
    # The sagitta of one degree, 1 - cos 0.5°, times the radius; an ellipse is a circle stretched at most that far.
    radius = max(getattr(curve, "radii", getattr(curve, "semi_axes", (0.0,))))
    assert stray.max() <= (1 - cos(radians(0.5))) * radius + 1e-14


@pytest.mark.parametrize("name", CURVES)
def test_ends_of_an_edge_are_exactly_the_given_points(name):
    edge = edge_on(CURVES[name])
    points = edge.points(np.array([0.0, 0.5, 1.0]))
    assert tuple(points[0]) == edge.start
    assert tuple(points[2]) == edge.end


def test_directions_are_unit_vectors_with_the_body_on_the_left():
    directions = edge_on(CURVES["arc"]).directions(np.array([0.0]))
    np.testing.assert_allclose(directions, [[1, 0]], atol=1e-15)


@given(st.integers(1, 40), st.floats(1, 1e3), st.sampled_from(["start", "end", "both"]))
def test_graded_lengths_fill_the_edge_with_the_given_ratio(elements, ratio, towards):
    lengths = graded_lengths(elements, ratio, towards)
    assert lengths.sum() == pytest.approx(1, rel=1e-14)
    places = (elements + 1) // 2 if towards == "both" else elements
    assert lengths.max() / lengths.min() == pytest.approx(ratio if places > 1 else 1, rel=1e-12)
    if towards == "start":
        assert np.all(np.diff(lengths) >= 0)
    if towards == "both":
        np.testing.assert_array_equal(lengths, lengths[::-1])
    if towards == "end":
        np.testing.assert_array_equal(lengths, graded_lengths(elements, ratio, "start")[::-1])
    if towards != "both" and elements > 2:
        quotients = lengths[1:] / lengths[:-1]
        np.testing.assert_allclose(quotients, quotients[0], rtol=1e-12)


@given(st.integers(1, 20), st.integers(1, 7), st.floats(1, 100), st.sampled_from(["start", "end", "both"]))
def test_refined_breakpoints_contain_the_coarse_ones(elements, refine, ratio, towards):
    edge = edge_on(CURVES["segment"], elements, ratio, towards)
    coarse, fine = edge.breakpoints(), edge.breakpoints(refine)
    assert len(fine) == elements * refine + 1
    np.testing.assert_array_equal(fine[::refine], coarse)
    assert fine[0] == 0
    assert fine[-1] == 1
    parts = np.diff(fine).reshape(elements, refine)
    np.testing.assert_allclose(parts, np.diff(coarse)[:, None] / refine * np.ones(refine), rtol=1e-11)


def test_turning_is_the_largest_angle_of_an_element():
    assert edge_on(CURVES["segment"]).turning() == 0
    assert edge_on(CURVES["arc"], 7).turning() == pytest.approx(radians(10), rel=1e-12)
    assert edge_on(CURVES["arc"], 7).turning(5) == pytest.approx(radians(2), rel=1e-12)
    one = edge_on(CURVES["flat ellipse"], 1)
    assert one.turning() == pytest.approx(pi / 2, rel=1e-14)


@pytest.mark.parametrize(
    ("angle", "expected"), [(0, (1, 0)), (90, (0, 1)), (-90, (0, -1)), (540, (-1, 0)), (-360, (1, 0))]
)
def test_unit_vectors_at_right_angles_are_exact(angle, expected):
    assert unit_vector(angle) == expected


@given(st.floats(-720, 720))
def test_unit_vectors_have_length_one(angle):
    assert hypot(*unit_vector(angle)) == pytest.approx(1, rel=1e-15)


@pytest.mark.parametrize("name", CURVES)
@pytest.mark.parametrize("fraction", [0.0, 1e-6, 0.3, 0.7, 1.0])
def test_fraction_at_a_point_of_a_curve_is_recovered(name, fraction):
    curve = CURVES[name]
    (point,) = curve.at(np.array([fraction]))
    assert curve.fraction_at(tuple(point)) == pytest.approx(fraction, abs=1e-14)


PLACES = st.lists(st.integers(1, 99), min_size=1, max_size=4, unique=True).map(lambda places: sorted(places))


@given(PLACES, st.integers(5, 20), st.floats(1, 50), st.sampled_from(["start", "end", "both", "middle"]))
def test_elements_end_exactly_at_given_places(places, elements, ratio, towards):
    fractions = [place / 100 for place in places]
    ends = graded_ends(elements, ratio, towards, fractions)
    assert len(ends) == elements + 1
    assert (ends[0], ends[-1]) == (0.0, 1.0)
    assert np.all(np.diff(ends) > 0)
    assert set(fractions) <= set(ends.tolist())


def test_ends_between_places_keep_their_proportions():
    """Of four equal elements the first end goes to 0.3; from 0.3 to 1 are three equal ones."""
    np.testing.assert_allclose(
        graded_ends(4, 1.0, "start", [0.3]), [0, 0.3, 0.3 + 0.7 / 3, 0.3 + 1.4 / 3, 1], rtol=1e-15
    )


@given(st.lists(st.floats(0.01, 0.99), min_size=1, max_size=3, unique=True), st.integers(4, 7))
def test_the_nearest_ends_move(places, elements):
    """Comparison with all choices, by the sum of squared distances."""
    places, ends = sorted(places), np.linspace(0, 1, elements + 1)
    moved = moved_onto(ends, places)
    chosen = [int(np.flatnonzero(moved == place)[0]) for place in places]
    least = min(
        sum((ends[i] - place) ** 2 for i, place in zip(way, places, strict=True))
        for way in combinations(range(1, elements), len(places))
    )
    assert sum((ends[i] - place) ** 2 for i, place in zip(chosen, places, strict=True)) == pytest.approx(
        least, abs=1e-15
    )


def test_as_many_places_as_inner_ends_are_all_ends():
    places = [0.001, 0.01, 0.1, 0.9]
    assert graded_ends(5, 1.0, "start", places).tolist() == [0, *places, 1]


def test_elements_shrink_towards_the_middle():
    lengths = graded_lengths(5, 4.0, "middle")
    np.testing.assert_allclose(lengths / lengths[2], [4, 2, 1, 2, 4], rtol=1e-14)  # ratio 4 in two steps


@given(st.floats(0.05, 0.95), st.integers(2, 30), st.floats(1, 100))
def test_elements_shrink_towards_a_place_by_one_factor(place, elements, ratio):
    ends = graded_ends(elements, ratio, place)
    at = int(np.flatnonzero(ends == place)[0])
    lengths = np.diff(ends)
    longer = max(at, elements - at)
    growth = ratio ** (1 / max(longer - 1, 1))
    np.testing.assert_allclose(lengths[:at][:-1] / lengths[:at][1:], growth, rtol=1e-8)
    np.testing.assert_allclose(lengths[at:][1:] / lengths[at:][:-1], growth, rtol=1e-8)


def test_grading_towards_the_middle_place_is_symmetric():
    ends = graded_ends(8, 20.0, 0.5)
    np.testing.assert_allclose(ends, 1 - ends[::-1], atol=1e-15)
    lengths = np.diff(ends)
    assert lengths.max() / lengths.min() == pytest.approx(20, rel=1e-12)
    assert set(np.argsort(lengths)[:2].tolist()) == {3, 4}


def test_refinement_cuts_the_elements_between_the_places():
    edge = Edge(
        name="edge", curve=Segment(start=(0, 0), end=(2, 0)), start=(0, 0), end=(2, 0), elements=3, ends_at=(0.1, 0.4)
    )
    np.testing.assert_allclose(edge.breakpoints(2), [0, 0.05, 0.1, 0.25, 0.4, 0.7, 1], rtol=1e-15)


@pytest.mark.parametrize("towards", ["start", "both", 0.25])
def test_ends_that_are_all_given_are_exactly_these(towards: str | float):
    """No grading is left to be seen, whatever it is."""
    places = [0.1, 0.25, 0.7]
    assert graded_ends(4, 50.0, towards, places).tolist() == [0.0, *places, 1.0]
