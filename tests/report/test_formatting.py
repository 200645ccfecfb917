"""Formatting: numbers, vectors, fields and surfaces as text."""

from mesh_studies import block

from bemcontact.problems import Circle, DeflectedContour, Field, Plane, Polyline, Spline, Units
from bemcontact.report import formatting


def test_numbers_and_vectors():
    assert formatting.number(183.3349) == "183.33"
    assert formatting.number(-0.0) == "0"
    assert formatting.number(2e-7) == "2e-07"
    assert formatting.vector((1.0, -1e-15)) == "(1, 0)"
    assert formatting.vector((0.0, 0.0), "mm") == "(0, 0) mm"
    assert formatting.vector((6e-16, 0.0), "mm", scale=1.0) == "(0, 0) mm"
    assert formatting.with_unit("3", "") == "3"
    assert formatting.with_unit("0", "mm") == "0"


def test_fields_are_stated_by_their_values_on_the_edge():
    bottom = block().edge("bottom")  # from x = 0 to 40
    assert formatting.field_on(Field(constant=2.5), bottom, "mm") == "2.5 mm"
    assert formatting.field_on(Field(constant=1, x=0.5), bottom) == "1 … 21"
    assert formatting.field_on(Field(constant=0), bottom, "mm") == "0"


def test_a_force_over_a_width_is_stated_with_its_place():
    """The top goes from x = 40 to 0, so that a distance of 10 from its start is x = 30."""
    problem = block()
    for stated, place in (({"at": 10.0}, "(30, 20)"), ({}, "(20, 20)")):
        pressed = problem.with_value("conditions.top", {"force": {"y": -5.0, "width": 2.0, **stated}})
        (words,) = formatting.prescribed(pressed, pressed.edge("top"))
        assert words == f"force (0, -5) N/mm over 2 mm around {place} mm"


def test_surfaces_in_words():
    plane = Plane(kind="plane", point=(0, 0), normal=(0, 5))
    assert formatting.surface_in_words(plane) == "plane through (0, 0), normal (0, 1)"
    circle = Circle(kind="circle", center=(1, 2), radius=3, body="inside")
    assert formatting.surface_in_words(circle) == "circle about (1, 2), radius 3, body inside"
    polyline = Polyline(kind="polyline", points=((0, 0), (1, 0), (2, 1)))
    assert formatting.surface_in_words(polyline) == "polyline of 3 points from (0, 0) to (2, 1)"
    spline = Spline(points=((0, 0), (1, 0), (2, 1)))
    assert formatting.surface_in_words(spline) == "spline of 3 points from (0, 0) to (2, 1)"
    contour = DeflectedContour(conditions={"top": {"pressure": 1}}, direction=(0, 2))  # pyright: ignore
    assert formatting.surface_in_words(contour) == "own contour, deflected; gap along (0, 1)"


def test_unit_labels():
    assert Units(length="mm", force="N").line_force == "N/mm"
    assert Units(length="mm").line_force == ""
    assert Units(length="in", force="lbf").foundation == "lbf/in³"


def test_a_sentence_begins_with_a_capital_letter_and_a_key_does_not():
    assert formatting.sentence_case("the body touches no surface") == "The body touches no surface"
    assert formatting.sentence_case("contact_zones.foot.surface: turn it") == "contact_zones.foot.surface: turn it"
    assert formatting.sentence_case("") == ""
