"""Messages on keys in the wrong place."""

import pytest

from bemcontact.errors import ProblemError
from bemcontact.problems import Condition, Problem
from bemcontact.problems.examples import homes


@pytest.mark.parametrize(("key", "place"), [("state", "material"), ("gravity", "loads"), ("adapt", "mesh")])
def test_a_key_in_the_wrong_place_is_told_where_it_belongs(key: str, place: str):
    """The places are those of the documented schema."""
    with pytest.raises(ProblemError, match=f"'{key}' belongs under {place}"):
        Problem(**{"name": "a", key: 1})


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
