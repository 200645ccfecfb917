"""Problems made in Python: materials, changes of values, variants, and errors that list every issue."""

import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from messages import assert_each_states, assert_states

from bemcontact.errors import ProblemError
from bemcontact.problem import (
    Arc,
    Boundary,
    Condition,
    ContactZone,
    DeflectedContour,
    Field,
    Line,
    Material,
    Plane,
    Problem,
    Units,
)
from bemcontact.problem.problem import MeshDensity


def parts():
    """Parts of a quarter disk on a plane, as Python objects."""
    return {
        "name": "quarter disk",
        "material": Material(young_modulus=1000, poisson_ratio=0.3),
        "boundary": Boundary(
            outer=[
                Arc(name="arc", center=(0, 8), radius=8, angles=(-90, 0), elements=6),
                Line(name="top", elements=4),
                Line(name="axis", start=(0, 8), elements=5),
            ]
        ),
        "conditions": {"top": Condition(pressure=Field(constant=50))},
        "contact_zones": {"foot": ContactZone(edges=["arc"], surface=Plane(point=(0, 0), normal=(0, 1)))},
    }


def issues(**changes):
    with pytest.raises(ProblemError) as caught:
        Problem(**{**parts(), **changes})
    return [str(issue) for issue in caught.value.issues]


def test_problem_of_objects_equals_the_problem_of_its_data():
    problem = Problem(**parts())
    assert Problem(**problem.model_dump()) == problem
    assert Problem.model_validate_json(problem.model_dump_json()) == problem


def test_edges_are_found_by_name():
    problem = Problem(**parts())
    assert problem.edge("top").start == (8, 8)
    with pytest.raises(ProblemError, match="boundary: unknown edge 'tap'; did you mean 'top'"):
        problem.edge("tap")


def test_unit_of_stress_needs_units_of_force_and_length():
    assert Units(length="cm", force="kN").stress == "kN/cm²"
    assert Units(length="cm").stress == ""


def test_refinements_multiply():
    problem = Problem(**parts()).refined(2).refined(3)
    assert problem.refined(1) is problem
    assert problem.mesh == MeshDensity(refine=6)


@pytest.mark.parametrize(
    ("path", "value", "found"),
    [
        ("material.young_modulus", 2e6, lambda problem: problem.material.young_modulus),
        ("boundary.outer[1].elements", 9, lambda problem: problem.edge("top").elements),
        ("boundary.outer.axis.elements", 9, lambda problem: problem.edge("axis").elements),
        ("units.length", "mm", lambda problem: problem.units.length),
        ("conditions.axis", Condition(pressure=Field(x=1)), lambda problem: problem.conditions["axis"]),
    ],
)
def test_with_value_makes_a_new_problem(path, value, found):
    problem = Problem(**parts())
    assert found(problem.with_value(path, value)) == value
    assert problem == Problem(**parts())


def test_with_value_checks_the_new_problem():
    with pytest.raises(ProblemError, match=r"^material\.poisson_ratio: must be greater than -1 and less than 0\.5"):
        Problem(**parts()).with_value("material.poisson_ratio", 0.7)
    with pytest.raises(ProblemError, match="is not a key path"):
        Problem(**parts()).with_value("a..b", 1)


def test_names_are_checked_in_a_problem_with_invalid_parts():
    boundary = parts()["boundary"].model_dump()
    first, second = issues(boundary=boundary, material={"young_modulus": 1}, conditions={"tip": {"pressure": 1}})
    assert first.startswith("material.poisson_ratio: missing; give the Poisson ratio")
    assert_states(second, "conditions.tip: unknown … 'tip' … 'top'")


def test_geometry_is_checked_in_a_problem_with_invalid_parts():
    boundary = parts()["boundary"].model_dump()
    boundary["outer"][0]["elements"] = 1
    zone = {"edges": "arc", "surface": {"kind": "plane", "point": [0, 0], "normal": [0, -1]}}
    found = issues(boundary=boundary, material={"young_modulus": 1}, contact_zones={"foot": zone})
    assert [line.partition(": ")[0] for line in found] == [
        "material.poisson_ratio",
        "contact_zones.foot.surface",
        "boundary.outer[0].elements",
    ]


def test_value_under_a_misspelled_key_is_checked():
    data = parts()
    data["materiel"] = {"young_modulus": 0, "poison_ratio": 0.7}
    del data["material"]
    with pytest.raises(ProblemError) as caught:
        Problem(**data)
    facts = [
        "materiel: unknown … 'materiel' … 'material'",
        "materiel.young_modulus: … greater than 0, found 0",
        "materiel.poison_ratio: unknown … 'poison_ratio' … 'poisson_ratio'",
        "materiel.poison_ratio: … greater than -1 and less than 0.5, found 0.7",
    ]
    assert_each_states(map(str, caught.value.issues), facts)


def test_edge_that_occurs_twice_in_a_zone_is_refused():
    zone = ContactZone(edges=["arc", "arc"], surface=Plane(point=(0, 0), normal=(0, 1)))
    (issue,) = issues(contact_zones={"foot": zone})
    assert_states(issue, "contact_zones.foot.edges[1]: … 'arc' … twice")


@pytest.mark.parametrize(
    ("surface", "remedy"),
    [
        ({"kind": "plane", "point": [0, 0], "normal": [0, -2]}, "reverse the normal: [0, 2]"),
        ({"kind": "circle", "center": [0, -9], "radius": 9, "body": "inside"}, "is the body outside the circle?"),
        ({"kind": "circle", "center": [0, 20], "radius": 20, "body": "outside"}, "is the body inside the circle?"),
        ({"kind": "polyline", "points": [[1, 0], [-1, 0]]}, "list its points in the opposite order"),
        ({"kind": "spline", "points": [[1, 0], [0, 0], [-1, 0]]}, "list its points in the opposite order"),
    ],
)
def test_surface_that_faces_away_is_refused_with_a_remedy(surface, remedy):
    zone = {"edges": ["arc"], "surface": surface}
    [issue] = issues(contact_zones={"foot": zone})
    assert_states(issue, f"contact_zones.foot.surface: … normal … into … {remedy}")


@pytest.mark.parametrize("data", [None, 3, [], "block"])
def test_data_without_keys_is_refused(data):
    with pytest.raises(ProblemError, match="expected a mapping with the keys name, description"):
        Problem.model_validate(data)


def on_its_contour(**changes):
    surface = {"kind": "deflected_contour", "conditions": {"top": {"pressure": 20}}, "direction": [0, 1], **changes}
    return {"foot": {"edges": ["arc"], "surface": surface}}


def test_problem_with_a_contour_survives_serialization():
    problem = Problem(**{**parts(), "contact_zones": on_its_contour()})
    assert Problem(**problem.model_dump()) == problem
    changed = problem.with_value("contact_zones.foot.surface.conditions.top.pressure", 30)
    surface = changed.contact_zones["foot"].surface
    assert isinstance(surface, DeflectedContour)
    assert surface.conditions["top"].pressure == Field(constant=30)


def test_contour_may_load_edges_of_its_zone():
    assert Problem(**{**parts(), "contact_zones": on_its_contour(conditions={"arc": {"pressure": 1}})})


def test_contour_is_checked_against_the_body():
    (unknown,) = issues(contact_zones=on_its_contour(conditions={"tap": {"pressure": 1}}))
    assert_states(unknown, "contact_zones.foot.surface.conditions.tap: unknown … 'tap' … 'top'")
    (away,) = issues(contact_zones=on_its_contour(direction=[0, -3]))
    assert_states(away, "contact_zones.foot.surface: … normal … at 'arc' … reverse the direction: [0, 3]")


@given(st.floats(1e-6, 1e9), st.floats(-0.99, 0.49))
@example(1.0, -0.5)
def test_plane_stress_is_plane_strain_with_another_ratio_and_modulus(young_modulus, poisson_ratio):
    sheet = Material(young_modulus=young_modulus, poisson_ratio=poisson_ratio, state="plane_stress")
    thick = Material(young_modulus=young_modulus, poisson_ratio=poisson_ratio)
    assert sheet.shear_modulus == thick.shear_modulus
    assert thick.effective_poisson_ratio == poisson_ratio
    # Strain per uniaxial stress, 1/E of the sheet, is (1 - ν'²)/E' of the equivalent thick body with E' = 2G(1 + ν').
    # That is (1 - ν')/(2G), which stays finite where ν = -1/2 makes ν' = -1.
    equivalent = (1 - sheet.effective_poisson_ratio) / (2 * sheet.shear_modulus)
    assert equivalent == pytest.approx(1 / young_modulus, rel=1e-12)


@pytest.mark.parametrize("poisson_ratio", [-1, 0.6, 1, -2])
def test_ratio_beyond_positive_energy_is_refused(poisson_ratio):
    for state in ("plane_strain", "plane_stress"):
        with pytest.raises(ProblemError, match=f"greater than -1 and less than 0.5, found {poisson_ratio:g}"):
            Material(young_modulus=1, poisson_ratio=poisson_ratio, state=state)


def test_incompressible_material_needs_plane_stress():
    assert Material(young_modulus=1, poisson_ratio=0.5, state="plane_stress").effective_poisson_ratio == 0.5 / 1.5
    with pytest.raises(ProblemError, match=r"take 0\.499, or state: plane_stress"):
        Material(young_modulus=1, poisson_ratio=0.5)


def test_all_issues_of_a_material_are_reported_together():
    with pytest.raises(ProblemError) as caught:
        Material(young_modulus=-1, poisson_ratio="0.3")
    facts = [
        "young_modulus: … greater than 0, found -1",
        "poisson_ratio: … a number, found … '0.3'; leave the quotes out",
    ]
    assert_each_states(map(str, caught.value.issues), facts)


def block(variants, **more):
    corners = {"bottom": [0, 0], "right": [4, 0], "top": [4, 2], "left": [0, 2]}
    return Problem(
        name="block",
        material={"young_modulus": 1000, "poisson_ratio": 0.3},
        boundary={"outer": [{"name": key, "start": start, "elements": 2} for key, start in corners.items()]},
        conditions={"left": {"displacement": {"x": 0}}, "top": {"pressure": 3}},
        contact_zones={"foot": {"edges": "bottom", "surface": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}}},
        variants=variants,
        **more,
    )  # pyright: ignore


def variant_issues(variants):
    with pytest.raises(ProblemError) as caught:
        block(variants)
    return [str(issue) for issue in caught.value.issues]


FINE = {"description": "more elements", "set": {"boundary.outer.bottom.elements": 8, "boundary.outer[2].elements": 6}}


def test_a_variant_is_the_problem_with_its_values():
    problem = block({"fine": FINE, "soft": {"set": {"material.young_modulus": 10}}})
    fine = problem.variant("fine")
    assert [edge.elements for edge in fine.boundary.edges] == [8, 2, 6, 2]
    assert (fine.name, fine.variants) == ("block, fine", {})
    by_hand = block({}).with_value("boundary.outer.bottom.elements", 8).with_value("boundary.outer.top.elements", 6)
    assert fine == by_hand.with_value("name", "block, fine")
    assert problem.variant("soft").material.young_modulus == 10
    assert problem.edge("bottom").elements == 2


def test_variants_are_part_of_the_data_and_stay_when_values_change():
    problem = block({"fine": FINE})
    assert Problem(**problem.model_dump()) == problem
    assert problem.refined(2).variant("fine").mesh.refine == 2


def test_values_are_set_all_at_once():
    """Neither the zone on the top nor the pressure on the bottom could be set alone: one edge would have both."""
    turned = {
        "contact_zones.foot": {"edges": "top", "surface": {"kind": "plane", "point": [0, 2], "normal": [0, -1]}},
        "conditions": {"left": {"displacement": {"x": 0}}, "bottom": {"pressure": 3}},
    }
    assert block({"turned": {"set": turned}}).variant("turned").contact_zones["foot"].edges == ("top",)


def test_an_unknown_variant_is_refused():
    with pytest.raises(ProblemError, match=r"^variants: unknown variant 'fime'; did you mean 'fine'\?"):
        block({"fine": FINE}).variant("fime")
    with pytest.raises(ProblemError, match="unknown variant 'fine'; there are none"):
        block({}).variant("fine")


@pytest.mark.parametrize(
    ("values", "words"),
    [
        (
            {"material.poisson_ratio": 0.7},
            "set.material.poisson_ratio: with this variant, material.poisson_ratio: must",
        ),
        (
            {"material.poison_ratio": 0.2},
            "set.material.poison_ratio: with this variant, material.poison_ratio: unknown",
        ),
        ({"boundary.outer.tap.elements": 3}, "set.boundary.outer.tap.elements: boundary.outer: unknown entry 'tap'"),
        ({"a..b": 3}, "set.a..b: 'a..b' is not a key path"),
        ({"variants.other.set": {}}, "set.variants.other.set: a variant cannot change variants"),
        ({"contact_zones.foot.edges": "top"}, ": with this variant, conditions.top: edge 'top' is in the contact zone"),
        ({}, "set: the variant sets no value"),
        (None, "set: "),
    ],
)
def test_a_broken_variant_is_found_at_once(values, words):
    (found,) = variant_issues({"fine": FINE, "broken": {"set": values}})
    assert words in found
    assert found.startswith("variants.broken")


def test_misspelled_keys_are_named():
    assert "did you mean 'set'" in variant_issues({"fine": {"sets": {"mesh.refine": 2}}})[0]
