"""Edges: valid forms, and mixtures that are refused."""

import pytest

from bemcontact.errors import ProblemError
from bemcontact.problems import Arc, EllipseArc, Grading, Line


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"angles": [0, 90]}, "an arc with angles needs radius too"),
        ({"tangent": "start", "angles": [0, 90]}, "an arc with tangent has no center and no angles"),
        ({"angles": (0, 90)}, "an arc with angles needs radius too"),
        ({"radius": 1, "angles": (0, 90), "start": (1, 0)}, "not both"),
        ({"radius": 1, "angles": (0, 90), "clockwise": True}, "not both"),
        ({"radius": 1, "angles": (90, 90)}, "must differ by more than 0 and at most 360 degrees; found [90.0, 90.0]"),
        ({"radius": 1, "angles": (0, 400)}, "at most 360 degrees"),
        ({"radius": 0, "angles": (0, 90)}, "radius: must be greater than 0, found 0"),
    ],
)
def test_mixed_forms_of_an_arc_are_refused(keys, words):
    with pytest.raises(ProblemError) as caught:
        Arc(name="arc", elements=2, center=(0, 0), **keys)
    assert words in str(caught.value)


@pytest.mark.parametrize(
    ("axes", "angles", "words"),
    [((1, 0), (0, 90), r"semi_axes\[1\]: must be greater than 0"), ((2, 1), (0, 361), "at most 360 degrees")],
)
def test_ellipse_has_positive_axes_and_at_most_one_turn(axes, angles, words):
    with pytest.raises(ProblemError, match=words):
        EllipseArc(name="ellipse", elements=2, center=(0, 0), semi_axes=axes, angles=angles)


def test_ends_of_a_rotated_ellipse_at_right_angles_are_exact():
    ellipse = EllipseArc(name="ellipse", elements=2, center=(1, 2), semi_axes=(3, 0.5), angles=(0, 90), rotation=90)
    assert ellipse.own_ends() == ((1.0, 5.0), (0.5, 2.0))


@pytest.mark.parametrize("ratio", [0.99, 2e6])
def test_grading_ratio_is_in_its_range(ratio):
    with pytest.raises(ProblemError, match="ratio: must be at"):
        Grading(ratio=ratio, towards="end")


def test_edges_are_frozen():
    line = Line(name="line", elements=2)
    with pytest.raises(ProblemError, match="a Line does not change"):
        line.elements = 3
