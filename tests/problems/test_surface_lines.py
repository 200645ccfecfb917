"""Lines as rigid surfaces: none that meets itself, and the faces that hold points of a body."""

from fractions import Fraction
from itertools import combinations, pairwise

import numpy as np
import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st
from scipy.interpolate import CubicSpline

from bemcontact.errors import ProblemError
from bemcontact.problems import Polyline, Spline

GRID = st.tuples(st.integers(0, 4), st.integers(0, 4))


def side(a, b, c):
    """Sign of the turn from a to b to c, exact."""
    turn = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    return (turn > 0) - (turn < 0)


def within(a, b, c):
    """Whether c, on the line through a and b, is between them."""
    return all(min(a[i], b[i]) <= c[i] <= max(a[i], b[i]) for i in (0, 1))


def meet(one, other):
    """Whether two segments have a common point, in exact arithmetic."""
    (a, b), (c, d) = one, other
    sides = side(a, b, c), side(a, b, d), side(c, d, a), side(c, d, b)
    if sides[0] * sides[1] < 0 and sides[2] * sides[3] < 0:
        return True
    ends = ((a, b, c), (a, b, d), (c, d, a), (c, d, b))
    return any(sign == 0 and within(*points) for sign, points in zip(sides, ends, strict=True))


def meets_itself(points):
    """Whether a line meets itself, or one of its straight ends, 100 times as long, meets the line."""
    segments = list(pairwise(points))
    apart = [(one, other) for (i, one), (j, other) in combinations(enumerate(segments), 2) if j > i + 1]
    if any(meet(*pair) for pair in apart):
        return True
    for (end, before), rest in (((points[0], points[1]), segments[1:]), ((points[-1], points[-2]), segments[:-1])):
        far = tuple(Fraction(end[i] + 100 * (end[i] - before[i])) for i in (0, 1))
        if any(meet((end, far), segment) for segment in rest):
            return True
    return False


@given(st.lists(GRID, min_size=3, max_size=7))
@example([(0, 0), (4, 0), (4, 4), (2, -1)])
@example([(0, 0), (4, 0), (4, 4), (0, 4), (0, 0)])
@example([(2, 0), (4, 0), (4, 4), (0, 4), (0, 0), (1, 0)])
@example([(0, 0), (2, 0), (2, 2), (0, 2), (0, 1), (2, 1), (4, 1)])
@example([(0, 4), (1, 0), (3, 0), (4, 4)])
@example([(1, 4), (0, 0), (4, 0), (3, 4)])
def test_a_polyline_is_refused_exactly_if_it_meets_itself(points):
    """Exact arithmetic decides; the straight ends may cross each other, for the surface ends where they meet."""
    assume(all(a != b for a, b in pairwise(points)))
    corners = zip(points, points[1:], points[2:], strict=False)
    assume(not any(side(a, b, c) == 0 and not within(a, c, b) for a, b, c in corners))
    try:
        Polyline(points=tuple((float(x), float(y)) for x, y in points))
        refused = ""
    except ProblemError as error:
        refused = str(error)
    assert bool(refused) == meets_itself(points)
    assert not refused or "itself at (" in refused


@pytest.mark.parametrize("size", [1e-6, 1.0, 1e6])
def test_a_polyline_that_meets_itself_is_refused_with_the_place(size):
    with pytest.raises(ProblemError) as caught:
        Polyline(points=tuple((size * x, size * y) for x, y in ((0, 0), (4, 4), (4, 0), (0, 3))))
    x, y = 4 * 3 / 7 * size, 4 * 3 / 7 * size  # where y = x meets y = 3 - 3/4 x
    assert f"at ({x:.6g}, {y:.6g})" in str(caught.value)


@pytest.mark.parametrize("turns", [0.9, 1.1])
def test_a_spline_with_a_loop_is_refused(turns):
    """A loop like that of a folium: chords cross only if it goes far enough round."""
    angle = np.linspace(0, 2 * np.pi * turns, 15)
    points = tuple((float(a / 4 - np.sin(a)), float(-np.cos(a))) for a in angle - np.pi * turns)
    if turns < 1:
        Spline(points=((-4.0, 0.0), (-1.0, 1.0), (1.0, -1.0), (4.0, 0.0)))
    with pytest.raises(ProblemError, match="crosses or touches itself at"):
        Spline(points=((-6.0, 1.0), *points, (6.0, 1.0)))


def crossings(line):
    """How far apart, in segments, two segments of a line (k, 2) are that cross properly; all pairs."""
    p, r = line[:-1], np.diff(line, axis=0)
    cross = lambda a, b: a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]  # noqa: E731
    to_start, to_end = p[None] - p[:, None], (p + r)[None] - p[:, None]
    over = cross(r[:, None], to_start) * cross(r[:, None], to_end) < 0
    i, j = np.nonzero(over & over.T)
    return np.abs(i - j)


@given(st.lists(GRID, min_size=4, max_size=6))
def test_a_spline_is_refused_if_it_crosses_itself(points):
    """Seen by 64 chords between two points; a loop shorter than a quarter of such a piece may be missed."""
    steps = np.diff(points, axis=0)
    assume(all(np.hypot(*step) > 0 for step in steps))
    assume(all(a @ b > -0.99 * np.hypot(*a) * np.hypot(*b) for a, b in pairwise(steps)))
    knots = np.append(0.0, np.hypot(*steps.T).cumsum())
    fine = np.unique(np.concatenate([np.linspace(a, b, 65) for a, b in pairwise(knots)]))
    loops = crossings(CubicSpline(knots, np.array(points, float), bc_type="natural")(fine))
    try:
        Spline(points=tuple((float(x), float(y)) for x, y in points))
        refused = ""
    except ProblemError as error:
        refused = str(error)
    assert refused or not (loops > 16).any()


@pytest.mark.parametrize("line", [Polyline, Spline])
def test_places_beyond_the_ends(line):
    """The foot of a place is beyond an end if the place is, on a straight line along x."""
    surface = line(points=((-1.0, 0.0), (0.0, 0.0), (2.0, 0.0)))
    x = np.array([-3.0, -1.0 - 1e-6, -1.0, 0.0, 1.0, 2.0, 2.0 + 1e-6, 5.0])
    assert surface.beyond_ends(np.column_stack([x, np.full(8, 0.5)])).tolist() == [True, True, *[False] * 4, True, True]


@given(st.integers(0, 628), st.floats(-6.5, 0), st.floats(0.05, 1.5), st.sampled_from([1e-9, 1.0, 3e7]))
@example(30, -6.5, 0.5, 1.0)
def test_a_point_opposite_to_the_end_of_a_segment_has_its_normal(hundredths, power, slope, size):
    """Not that of the direction from the corner, which is round-off over the gap; on either side of a convex corner."""
    c, s = np.cos(hundredths / 100), np.sin(hundredths / 100)
    turned = size * np.array([(c, s), (-s, c)])
    line = Polyline(points=tuple(map(tuple, (np.array([(-2, 0), (0, 0), (1, -slope)]) @ turned).tolist())))
    for left in line.sides.lefts:
        for shift in np.linspace(-1e-15, 1e-15, 5):
            point = np.array(line.points[1]) + size * 10**power * left + shift * turned[0]
            gap, normals = line.closest(point[None])
            assert normals[0] == pytest.approx(left, abs=1e-13)
            assert gap[0] == pytest.approx(size * 10**power, rel=1e-6)
