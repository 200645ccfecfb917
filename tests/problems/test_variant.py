"""Variants of a problem: all values at once, and what is refused before a variant is used."""

import pytest

from bemcontact.errors import ProblemError
from bemcontact.problems import Problem


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
