"""Rigid surfaces: the gap is the signed distance along the normal for all shapes."""

from itertools import pairwise
from math import cos, hypot, sin, sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bemcontact.errors import ProblemError
from bemcontact.problems import Circle, DeflectedContour, Plane, Polyline, Spline

COORDINATE = st.floats(-10, 10)
POINT = st.tuples(COORDINATE, COORDINATE)
ANGLE = st.floats(0, 6.28)
RIDGE = Polyline(points=((-3, -1), (-1, 0), (1, 0), (2, -2)))
"""From left to right: the body is above, the rigid corners are convex."""
VALLEY = Polyline(points=((-3, 2), (-1, 0), (1, 0), (2, 3)))
"""From left to right: the body is above, the rigid corners are concave."""
SURFACES = [
    Plane(point=(1, 2), normal=(0.3, -4)),
    Circle(center=(1, -1), radius=2, body="outside"),
    Circle(center=(1, -1), radius=2, body="inside"),
    RIDGE,
    VALLEY,
]


def closest(surface, point):
    gap, normals = surface.closest(np.array([point], float))
    return gap[0], normals[0]


def distance_to_polyline(line, point):
    """Smallest distance to the segments, the outer two infinite, by a separate formula for each."""
    corners = np.array(line.points, float)
    corners[0] += 1e3 * (corners[0] - corners[1])
    corners[-1] += 1e3 * (corners[-1] - corners[-2])
    distances = []
    for a, b in pairwise(corners):
        t = min(max((np.array(point) - a) @ (b - a) / ((b - a) @ (b - a)), 0), 1)
        distances.append(hypot(*(np.array(point) - a - t * (b - a))))
    return min(distances)


@given(st.sampled_from(SURFACES), POINT)
def test_normals_are_unit_vectors_and_the_foot_is_on_the_surface(surface, point):
    gap, normal = closest(surface, point)
    foot = np.array(point) - gap * normal
    assert np.hypot(*normal) == pytest.approx(1, rel=1e-14)
    assert closest(surface, foot)[0] == pytest.approx(0, abs=1e-13)
    assert (np.array(point) - foot) @ normal == pytest.approx(gap, abs=1e-13)


@given(st.sampled_from([SURFACES[0], SURFACES[1], RIDGE]), POINT, st.floats(0, 5))
def test_moving_off_a_convex_surface_opens_the_gap_by_the_distance(surface, point, way):
    gap, normal = closest(surface, point)
    if gap < 0:
        point, gap = np.array(point) - gap * normal, 0
        normal = closest(surface, point)[1]
    assert closest(surface, np.array(point) + way * normal)[0] == pytest.approx(gap + way, abs=1e-12)


@given(ANGLE, st.floats(0.1, 5), st.floats(-1, 1))
def test_moving_inside_a_rigid_hole_changes_the_gap_by_the_distance(angle, radius, share):
    hole = Circle(center=(1, -1), radius=2, body="inside")
    start = np.array([1 + radius * cos(angle), -1 + radius * sin(angle)])
    gap, normal = closest(hole, start)
    assert closest(hole, start + share * radius * normal)[0] == pytest.approx(gap + share * radius, abs=1e-13)


@given(POINT, ANGLE, COORDINATE, st.floats(0.01, 100))
def test_gap_of_a_plane_changes_by_the_distance_in_both_directions(point, angle, way, length):
    plane = Plane(point=(1, 2), normal=(length * cos(angle), length * sin(angle)))
    gap, normal = closest(plane, point)
    assert closest(plane, np.array(point) + way * normal)[0] == pytest.approx(gap + way, abs=1e-13)
    np.testing.assert_allclose(normal, [cos(angle), sin(angle)], atol=1e-15)


@given(POINT, st.sampled_from([RIDGE, VALLEY]))
def test_gap_of_a_polyline_is_the_least_distance(point, line):
    assert abs(closest(line, point)[0]) == pytest.approx(distance_to_polyline(line, point), abs=1e-12)


@given(POINT)
def test_reversed_polyline_has_the_body_on_the_other_side(point):
    gap, normal = closest(RIDGE, point)
    other_gap, other_normal = closest(Polyline(points=RIDGE.points[::-1]), point)
    assert other_gap == pytest.approx(-gap, abs=1e-14)
    if abs(gap) > 1e-6:
        np.testing.assert_allclose(abs(normal @ other_normal), 1, rtol=1e-9)


@given(POINT, ANGLE)
def test_polyline_of_one_segment_is_a_plane(point, angle):
    line = Polyline(points=((1, 2), (1 + cos(angle), 2 + sin(angle))))
    plane = Plane(point=(1, 2), normal=(-sin(angle), cos(angle)))
    assert closest(line, point)[0] == pytest.approx(closest(plane, point)[0], abs=1e-13)


def test_normal_beyond_a_convex_corner_is_radial():
    gap, normal = closest(RIDGE, (1.25, 0.5))
    assert gap == pytest.approx(sqrt(0.25**2 + 0.5**2), rel=1e-15)
    np.testing.assert_allclose(normal, np.array([0.25, 0.5]) / gap, rtol=1e-15)


def test_normal_at_a_corner_is_between_those_of_its_segments():
    gap, normal = closest(RIDGE, (1, 0))
    assert gap == 0
    assert normal[1] > 0
    assert np.hypot(*normal) == pytest.approx(1, rel=1e-15)


def test_normal_at_the_center_of_a_circle_is_a_unit_vector():
    gap, normal = closest(Circle(center=(1, 1), radius=3, body="inside"), (1, 1))
    assert gap == 3
    assert np.hypot(*normal) == 1


@pytest.mark.parametrize(
    ("surface", "keys", "words"),
    [
        (Plane, {"point": (0, 0), "normal": (0, 0)}, "has no direction"),
        (Circle, {"center": (0, 0), "radius": -1, "body": "inside"}, "radius: must be greater than 0, found -1"),
        (
            Circle,
            {"center": (0, 0), "radius": 1, "body": "above"},
            "expected 'outside' or 'inside', found the text 'abo",
        ),
        (Polyline, {"points": [(0, 0)]}, "points: expected at least 2 in the list, found a list of 1"),
        (Polyline, {"points": [(0, 0), (0, 0)]}, "points 0 and 1 are the same"),
        (Polyline, {"points": [(0, 0), (2, 0), (1, 0)]}, "folds back on itself at point 1"),
    ],
)
def test_invalid_surfaces_are_refused(surface, keys, words):
    with pytest.raises(ProblemError) as caught:
        surface(**keys)
    assert words in str(caught.value)


PULL = {"top": {"traction": {"y": -50}}}


def test_gap_of_a_contour_is_the_displacement_of_the_same_material_point():
    contour = DeflectedContour(conditions=PULL, direction=(0, 2))  # pyright: ignore
    gap, normals = contour.behind(np.array([[7.0, -3.0], [0.0, 0.5]]))
    assert contour.unit_direction == (0, 1)
    assert gap == pytest.approx([3, -0.5])
    assert normals == pytest.approx(np.array([[0, 1], [0, 1]]))


@pytest.mark.parametrize(
    ("parts", "words"),
    [
        ({"conditions": PULL, "direction": (0, 0)}, "has no direction"),
        ({"direction": (0, 1)}, "no loads of its own"),
        ({"conditions": PULL}, "direction: missing"),
        ({"conditions": {"top": {}}, "direction": (0, 1)}, "conditions.top"),
    ],
)
def test_invalid_contours_are_refused(parts, words):
    with pytest.raises(ProblemError, match=words):
        DeflectedContour(**parts)


@pytest.mark.parametrize("size", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("shift", [(0.0, 0.0), (1e-15, 0.0), (0.0, -1e-15), (-1e-15, 1e-15)])
def test_normal_on_a_corner_is_the_bisector_in_spite_of_round_off(size: float, shift: tuple[float, float]):
    """The normals of (1, 1) and (5, -1) are along (-1, 1) and (1, 5); the sum of unit vectors bisects their angle."""
    line = Polyline(points=tuple((size * x, size * y) for x, y in ((-30, -40), (10, 0), (60, -10))))
    gap, normals = line.closest(size * (np.array([[10.0, 0.0]]) + shift))
    bisector = np.array([-1.0, 1.0]) / np.sqrt(2) + np.array([1.0, 5.0]) / np.sqrt(26)
    assert normals == pytest.approx(bisector[None] / np.hypot(*bisector), abs=1e-12)
    assert abs(gap[0]) <= 1e-13 * size


CIRCLE = [(np.pi + 0.3 + a, 2.0) for a in np.linspace(0, 1.5, 31)]
ARCH = Spline(points=tuple((r * cos(a), r * sin(a)) for a, r in CIRCLE))
WAVE = Spline(points=tuple((x, 0.3 * sin(2 * x)) for x in np.linspace(-3, 3, 13)))


@given(st.sampled_from([WAVE, ARCH]), POINT)
def test_gap_of_a_spline_is_the_least_distance(surface, point):
    """Comparison with 20 000 points of curve and straight ends, one of which is within half a step of the nearest."""
    t = np.linspace(0, surface.curve.x[-1], 20_000)
    ends = [surface.curve(t[i]) + np.linspace(0, 30, 20_000)[:, None] * sign * unit(surface.curve(t[i], 1))
            for i, sign in ((0, -1), (-1, 1))]  # fmt: skip
    distance = np.hypot(*(np.concatenate([surface.curve(t), *ends]) - point).T).min()
    assert abs(closest(surface, point)[0]) == pytest.approx(distance, abs=30 / 20_000)


@given(st.sampled_from([WAVE, ARCH]), st.floats(0, 1), st.floats(-0.05, 0.05))
def test_spline_gap_is_the_step_along_the_normal(surface, part, way):
    """After a step shorter than the radius of curvature (at least 0.8), the starting point is the nearest one."""
    t = part * surface.curve.x[-1]
    tangent = unit(surface.curve(t, 1))
    normal = np.array([-tangent[1], tangent[0]])
    gap, found = closest(surface, surface.curve(t) + way * normal)
    assert gap == pytest.approx(way, abs=1e-12)
    assert found == pytest.approx(normal, abs=1e-9)


def unit(vector):
    return vector / np.hypot(*vector)


def test_spline_interpolates_its_points_and_has_straight_ends():
    gaps, _ = WAVE.closest(np.array(WAVE.points))
    assert abs(gaps).max() <= 1e-14
    for end, sign in ((0, -1), (-1, 1)):
        tangent = unit(WAVE.curve(WAVE.curve.x[end], 1))
        normal = np.array([-tangent[1], tangent[0]])
        gap, found = closest(WAVE, np.array(WAVE.points[end]) + sign * 7 * tangent + 2 * normal)
        assert gap == pytest.approx(2, rel=1e-13)
        assert found == pytest.approx(normal, abs=1e-13)


@given(POINT, ANGLE)
def test_spline_of_two_points_is_a_plane(point, angle):
    spline = Spline(points=((1, 2), (1 + cos(angle), 2 + sin(angle))))
    gap, normal = closest(spline, point)
    plane_gap, plane_normal = closest(Plane(point=(1, 2), normal=(-sin(angle), cos(angle))), point)
    assert gap == pytest.approx(plane_gap, abs=1e-12)
    assert normal == pytest.approx(plane_normal, abs=1e-12)


def test_spline_through_a_circle_has_order_four_inside():
    """Half the chord gives a sixteenth of the error, except at the ends, where the second derivative is 0."""

    def error(count):
        angles = np.linspace(0, np.pi, count)
        spline = Spline(points=tuple((-2 * cos(a), 2 * sin(a)) for a in angles))
        inner = np.linspace(0.35 * np.pi, 0.65 * np.pi, 401)
        return abs(spline.closest(3 * np.column_stack([-np.cos(inner), np.sin(inner)])).gap - 1).max()

    assert np.log2(error(17) / error(33)) == pytest.approx(4, abs=0.3)


@pytest.mark.parametrize("size", [1e-9, 1e6])
def test_spline_in_other_units(size):
    """A kilometer instead of a millimeter: equal normals, gaps times the factor."""
    points = np.random.default_rng(0).uniform(-2, 2, (50, 2))
    scaled = Spline(points=tuple((size * x, size * y) for x, y in WAVE.points))
    one, other = WAVE.closest(points), scaled.closest(size * points)
    np.testing.assert_allclose(other.gap, size * one.gap, atol=1e-12 * size)
    np.testing.assert_allclose(other.normals, one.normals, atol=1e-9)


@pytest.mark.parametrize(
    ("points", "words"),
    [
        ([(0, 0)], "points: expected at least 2 in the list, found a list of 1"),
        ([(0, 0), (1, 0), (1, 0)], "points 1 and 2 are the same"),
        ([(0, 0), (2, 0), (1, 0)], "folds back on itself at point 1"),
    ],
)
def test_invalid_points_of_a_spline_are_refused(points, words):
    with pytest.raises(ProblemError, match=words):
        Spline(points=points)
