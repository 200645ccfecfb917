"""Messages on keys in the wrong place."""

import pytest

import bemcontact
from bemcontact.errors import ProblemError
from bemcontact.problems import Condition, Problem
from bemcontact.problems.examples import homes


@pytest.mark.parametrize(("key", "place"), [("state", "material"), ("gravity", "loads"), ("adapt", "mesh")])
def test_a_key_in_the_wrong_place_is_told_where_it_belongs(key: str, place: str):
    """The places are those of the documented schema."""
    with pytest.raises(ProblemError, match=f"'{key}' belongs under {place}"):
        Problem(**{"name": "a", key: 1})


@pytest.mark.parametrize(
    ("edge", "words"),
    [
        (
            {"kind": "spline", "points": [[0, 0], [1, 1], [2, 0]], "tangent": "end"},
            "unknown key 'tangent' for kind: spline; ",
        ),
        ({"kind": "line", "start": [0, 0], "clockwise": True}, "unknown key 'clockwise' for kind: line; "),
        ({"kind": "arc", "center": [0, 0], "diameter": 3}, "write radius, half of the diameter"),
        ({"start": [0, 0], "fillet": 3}, "unknown key 'start'; a fillet has no place of its own"),
        ({"start": [0, 0], "chamfer": 3}, "unknown key 'chamfer'; a chamfer is a line of its own"),
    ],
)
def test_a_key_of_another_kind_of_edge_is_not_said_to_belong_where_it_stands(edge, words):
    with pytest.raises(ProblemError) as refused:
        Problem(**{"name": "a", "boundary": {"outer": [{"name": "edge", **edge}]}})
    of_edge = [issue.message for issue in refused.value.issues if issue.path[:2] == ("boundary", "outer")]
    assert any(words in message for message in of_edge)
    assert not any("belongs under boundary.outer" in message for message in of_edge)


def test_every_key_of_the_schema_is_found_where_its_mapping_has_it():
    """The schema that editors use is made by another library from the same classes."""
    schema = Problem.model_json_schema()
    for name, value in schema["properties"].items():
        assert "" in homes(Problem, name)
        reference = value.get("$ref", "").rpartition("/")[2]
        for key in schema["$defs"].get(reference, {}).get("properties", {}):
            assert name in homes(Problem, key)


@pytest.mark.parametrize(
    ("word", "words"),
    [
        ("load", "is force: {x: …"), ("roller", r"displacement: \{y: 0\}"), ("clamped", "write fixed: true"),
        ("hinge", "no point can bear a force"), ("free", "leave it out"), ("springs", r"write spring: \{normal: 50\}"),
    ],
)  # fmt: skip
def test_words_of_others_for_a_condition_are_led_to_its_keys(word: str, words: str):
    with pytest.raises(ProblemError, match=words):
        Condition(**{word: {"y": -100}})


@pytest.mark.parametrize(
    ("word", "words"),
    [
        ("thickness", "forces are per thickness"), ("E", "belongs to material"), ("friction", "frictionless"),
        ("supports", "in conditions, by edge name"), ("forces", "loads on edges are in conditions"),
        ("rollers", "kind: circle"), ("foundation", "are a condition of it"),
    ],
)  # fmt: skip
def test_words_of_others_at_the_top_are_led_to_their_places(word: str, words: str):
    with pytest.raises(ProblemError, match=words):
        Problem(**{word: 1})


@pytest.mark.parametrize(
    ("data", "words"),
    [
        ({"contact": {}}, "contact between bodies in contacts"),
        ({"zones": {}}, "rigid surfaces is in contact_zones"),
        ({"outline": {}}, "the outline is boundary: {outer: "),
        ({"title": "a"}, "write name"),
        ({"plane": "stress"}, "it belongs to material: {state: plane_stress"),
        ({"mesh": {"size": 1}}, "a mesh is found for the accuracy"),
        ({"material": {"G": 8e4}}, "E = 2 G (1 + ν)"),
        ({"material": {"mu": 0.1}}, "contact is without friction"),
        ({"contact_zones": {"foot": {"friction": 0.1}}}, "contact is without friction"),
        ({"contact_zones": {"foot": {"target": {}}}}, "write surface: {kind: plane"),
        ({"conditions": {"left": {"ux": 0}}}, "what holds an edge is displacement: {x: 0}"),
        ({"conditions": {"left": {"x": 0, "y": 0}}}, "what holds an edge is displacement: {x: 0}"),
        ({"conditions": {"left": {"moment": 5}}}, "a moment is a traction that changes along the edge"),
        ({"boundary": {"outer": [{"name": "a", "from": [0, 0]}]}}, "unknown key 'from'; write start"),
        ({"contacts": {"c": {"master": "a", "slave": "b"}}}, "both sides are between: [BODY/EDGE, BODY/EDGE]"),
        ({"material": {"thermal_expansion": 1e-5}}, "belongs to the load: loads.temperature.expansion"),
        (
            {"loads": {"top": {"pressure": 20}}},
            "there are: gravity, centrifugal, temperature; loads on edges are in conditions",
        ),
    ],
)
def test_words_that_are_guessed_lead_to_the_keys(data, words):
    with pytest.raises(ProblemError) as refused:
        bemcontact.problem({"name": "a", **data})
    assert any(words in issue.message for issue in refused.value.issues)


def test_a_unit_under_a_misspelled_key_is_no_second_error():
    """Under the key that is meant the unit is read."""
    with pytest.raises(ProblemError) as refused:
        bemcontact.problem({"name": "a", "material": {"young_modulos": "210 GPa", "poisson_ratio": 0.3}})
    (message,) = (issue.message for issue in refused.value.issues if issue.path[0] == "material")
    assert message == "unknown key 'young_modulos'; did you mean 'young_modulus'?"
