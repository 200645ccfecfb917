"""Edges through points, against curves in closed form: length, points, directions, and a contact on one."""

import math

import numpy as np
import pytest
import scipy.integrate

import bemcontact
from bemcontact.errors import ProblemError
from bemcontact.problems import Boundary, SplineEdge
from bemcontact.problems.spline_curve import SplineCurve

FRACTIONS = np.linspace(0, 1, 41)


def on_circle(count, radius=2.0):
    angles = np.linspace(0, 2 * math.pi, count + 1)
    points = [(radius * math.cos(angle), radius * math.sin(angle)) for angle in angles[:-1]]
    return (*points, points[0])


def test_a_spline_through_points_of_a_line_is_the_line():
    curve = SplineCurve(points=((0, 0), (1, 1), (3, 3), (4, 4)))
    assert curve.length == pytest.approx(4 * math.sqrt(2), rel=1e-14)
    np.testing.assert_allclose(curve.at(FRACTIONS), 4 * FRACTIONS[:, None] * [1, 1], atol=1e-13)
    np.testing.assert_allclose(curve.tangent_angle(FRACTIONS), math.pi / 4, atol=1e-13)


def test_a_parabola_with_its_directions_at_both_ends_has_its_length():
    """Fourth order in the distance of the points: half of it leaves a sixteenth of the error."""

    def curve(count):
        x = np.linspace(-1, 1, count + 1)
        return SplineCurve(
            points=tuple(zip(x.tolist(), (x**2).tolist(), strict=True)), start_direction=(1, -2), end_direction=(1, 2)
        )

    length = scipy.integrate.quad(lambda x: math.hypot(1, 2 * x), -1, 1)[0]
    errors = [abs(curve(count).length - length) for count in (8, 16, 32)]
    assert errors[0] / errors[1] > 12
    assert errors[1] / errors[2] > 12
    assert errors[2] < 1e-6
    assert np.tan(curve(8).tangent_angle(np.array([0.0, 1.0]))) == pytest.approx([-2, 2], rel=1e-12)


def test_a_closed_spline_through_points_of_a_circle_is_smooth_and_nearly_the_circle():
    curve = SplineCurve(points=on_circle(24))
    assert curve.closed
    turned = curve.tangent_angle(np.array([0.0, 1.0]))
    assert turned[1] - turned[0] == pytest.approx(2 * math.pi, rel=1e-12)
    np.testing.assert_allclose(np.hypot(*curve.at(FRACTIONS).T), 2.0, rtol=2e-5)  # (turn)⁴/384 of a cubic spline
    assert curve.length == pytest.approx(4 * math.pi, rel=2e-5)


def test_fractions_are_those_of_the_arc_length_and_of_the_nearest_places():
    curve = SplineCurve(points=((0, 0), (2, 1), (3, -1), (6, 0), (6.5, 3)), start_direction=(0, 1))
    steps = np.linalg.norm(np.diff(curve.at(np.linspace(0, 1, 4001)), axis=0), axis=1)
    np.testing.assert_allclose(steps, curve.length / 4000, rtol=1e-4)
    np.testing.assert_allclose(curve.nearest(curve.at(FRACTIONS)), FRACTIONS, atol=1e-9)
    angle = curve.tangent_angle(FRACTIONS)
    beside = curve.at(FRACTIONS) + 0.05 * np.column_stack([-np.sin(angle), np.cos(angle)])
    np.testing.assert_allclose(curve.nearest(beside)[1:-1], FRACTIONS[1:-1], atol=1e-9)
    assert curve.fraction_at((2, 1)) == pytest.approx(curve.nearest(np.array([[2.0, 1.0]]))[0])


def roller(rim):
    """A quarter of a roller of radius 10 on a plane."""
    return bemcontact.problem(
        {
            "name": "roller",
            "material": {"young_modulus": 210e3, "poisson_ratio": 0.3},
            "boundary": {"outer": [rim, {"name": "top"}, {"name": "axis", "start": [0, 10], "end": [0, 0]}]},
            "conditions": {"axis": {"symmetry": "x"}, "top": {"pressure": 20}},
            "contact_zones": {"rim": {"edges": "rim", "surface": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}}},
        }
    )


def test_a_roller_with_a_rim_through_points_presses_as_the_round_one():
    """With a point every 2.25 degrees its curvature is off by less than 0.1 %, and so is the peak from that of Hertz.

    The other 0.4 % are for the theory of Hertz at this width, and for the error bar.
    """
    angles = np.linspace(-math.pi / 2, 0, 41)
    points = [[10 * math.cos(a) if a > -1.57 else 0.0, 10 + 10 * math.sin(a)] for a in angles]
    points[-1] = [10.0, 10.0]
    spline = roller(
        {"name": "rim", "kind": "spline", "points": points, "start_direction": [1, 0], "end_direction": [0, 1]}
    )
    result = bemcontact.solve(spline)
    assert result.holds
    half_width = math.sqrt(4 * 400 * 10 / (math.pi * 210e3 / 0.91))
    assert result.peak.pressure == pytest.approx(2 * 400 / (math.pi * half_width), rel=5e-3)
    assert bemcontact.problem(spline.to_dict()) == spline


def test_copies_and_mirror_images_have_the_same_curve():
    half = [
        {"name": "low", "start": [0, 0], "end": [4, 0]},
        {"name": "side", "kind": "spline", "points": [[4, 0], [5, 2], [3, 4], [0, 5]], "end_direction": [-1, 0]},
    ]
    boundary = Boundary(outer=half, mirror={"x": 0})
    own, image = (next(edge for edge in boundary.edges if edge.name == name) for name in ("side", "side mirrored"))
    np.testing.assert_allclose(image.points(FRACTIONS[::-1]), own.points(FRACTIONS) * [-1, 1], atol=1e-12)
    assert image.directions(np.zeros(1))[0] == pytest.approx([-1, 0])
    material = {"young_modulus": 1000, "poisson_ratio": 0.3}
    stated = {
        "name": "two",
        "bodies": {
            "one": {"material": material, "boundary": {"outer": half, "mirror": {"x": 0}}},
            "other": {"copy_of": "one", "rotate": 180, "shift": [0, -1e-3], "conditions": {"side": {"fixed": True}}},
        },
        "contacts": {"c": {"between": ["one/low", "other/low mirrored"]}},
    }
    problem = bemcontact.problem(stated)
    turned = problem.edge("other/side").points(FRACTIONS)
    np.testing.assert_allclose(turned, -own.points(FRACTIONS) - [0, 1e-3], atol=1e-12)


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"points": [[0, 0], [1, 1]]}, "points: expected at least 3 in the list"),
        ({"points": [[0, 0], [1, 1], [1, 1], [2, 0]]}, "points[2]: the point occurs twice"),
        ({"points": [[0, 0], [1, 1], [0, 0]]}, "a closed spline needs at least three different points"),
        (
            {"points": [[0, 0], [1, 1], [2, 0]], "end_direction": [0, 0]},
            "end_direction: a direction must not be",
        ),
    ],
)
def test_what_is_no_spline_is_refused(keys, words):
    with pytest.raises(ProblemError) as refused:
        SplineEdge(name="a", **keys)
    assert words in str(refused.value)
