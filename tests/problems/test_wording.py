"""Errors about values of the wrong kind say what to write, and what they say to write is right."""

from itertools import permutations
from math import isfinite
from typing import Any

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from bemcontact import Problem, ProblemError
from bemcontact.errors import KeyPath
from bemcontact.problems.key_path import existing_path, parsed_path, with_entry
from bemcontact.problems.wording import number_hint, unknown_word
from bemcontact.spec.yaml_1_2 import READERS, TAG, Loader

FULL: Any = yaml.safe_load(
    """
name: block on a table
units: {length: mm, force: N}
material: {young_modulus: 210000, poisson_ratio: 0.3}
boundary:
  outer:
    - {name: bottom, start: [0, 0], elements: 4, ends_at: [0.5], grading: {ratio: 2, towards: end}}
    - {name: right side, start: [40, 0], elements: 2}
    - {name: top, start: [40, 20], elements: 4}
    - {name: left, start: [0, 20], elements: 2}
  holes: [[{name: rim, kind: arc, center: [20, 10], radius: 5, angles: [360, 0], elements: 16}]]
conditions:
  top: {traction: {y: -3}}
  left: {displacement: {x: 0}}
loads:
  gravity: {density: 7.85e-9, acceleration: [0, -9810]}
  centrifugal: {density: 7.85e-9, angular_velocity: 300}
  temperature: {expansion: 1.2e-5, change: 50}
contact_zones:
  foot: {edges: [bottom], surface: {kind: plane, point: [0, 0], normal: [0, 1]}}
  side: {edges: right side, surface: {kind: plane, point: [40, 0], normal: [-1, 0]}}
tools:
  table: {zones: [foot], force: {y: 100}, displacement: {x: 0}}
load_cases:
  more: {conditions: {top: {pressure: 1}}, tools: {table: {force: {y: 1}}}}
combinations:
  both: {more: 2}
mesh: {refine: 1}
reference:
  mean: {kind: uniform, pressure: 3, zone: foot}
variants:
  soft: {set: {material.young_modulus: 70000}}
"""
)


def refusals(data: Any, path: KeyPath, *, below: bool = True) -> list[str]:
    """Messages about the value at a path of a problem, and about those below it."""
    try:
        Problem(**data)
    except ProblemError as error:
        places = [(issue.path[: len(path)] if below else issue.path, issue.message) for issue in error.issues]
        return [message for place, message in places if place == path]
    return []


PARTS = [
    *("units", "material", "boundary", "boundary.outer", "boundary.outer[0]", "boundary.outer[0].ends_at"),
    *("boundary.outer[0].grading", "boundary.holes", "boundary.holes[0]", "boundary.holes[0][0]"),
    *("conditions", "conditions.top", "conditions.top.traction", "conditions.left.displacement"),
    *("loads", "loads.gravity", "loads.centrifugal", "loads.temperature", "contact_zones", "contact_zones.foot"),
    *("contact_zones.foot.edges", "contact_zones.foot.surface", "tools", "tools.table", "tools.table.zones"),
    *("tools.table.force", "tools.table.displacement", "load_cases", "load_cases.more", "load_cases.more.conditions"),
    *("load_cases.more.tools", "load_cases.more.tools.table", "combinations", "combinations.both", "mesh"),
    *("reference", "reference.mean", "variants", "variants.soft", "variants.soft.set"),
]
"""Key paths of all mappings and lists that a problem may have."""


@pytest.mark.parametrize("place", PARTS)
@pytest.mark.parametrize("wrong", [["a"], ["a", "b"], [1, 2], {"a": None, "b": None}, "a", "a, b", True])
def test_what_an_error_says_to_write_is_of_the_right_kind(place: str, wrong: object):
    path = existing_path(FULL, parsed_path(place))
    kind = type(_value(path))
    for message in refusals(with_entry(FULL, path, wrong), path, below=False):
        if not message.startswith(("expected a list", "expected a mapping")):
            continue
        assert "such as " in message
        example = message.partition("such as ")[2].partition("; found")[0].partition(", found")[0]
        assert "{…}" not in example
        written = yaml.safe_load(example.replace(", …", ""))
        assert isinstance(written, kind)
        assert not [text for text in refusals(with_entry(FULL, path, written), path) if text.startswith("expected a")]


def _value(path: KeyPath) -> object:
    value = FULL
    for step in path:
        value = value[step]
    return value


def test_the_full_problem_is_read():
    assert refusals(FULL, ()) == []


@pytest.mark.parametrize(
    ("separator", "form"),
    [
        *((separator, "{}") for separator in (", ", ",", "; ", " and ", " ", " + ", " & ", "/")),
        *((", ", form) for form in ("({})", "{{{}}}", "- {}", "'{}'")),
    ],
)
@pytest.mark.parametrize(("key", "place"), [("edges", "contact_zones.foot.edges"), ("zones", "tools.table.zones")])
@pytest.mark.parametrize("as_entry", [False, True])
def test_a_text_with_several_names_is_told_the_list_to_write(
    separator: str, form: str, key: str, place: str, as_entry: bool
):
    names = ["bottom", "right side"] if key == "edges" and separator != " " else ["bottom", "left"]
    names = names if key == "edges" else ["foot", "side"]
    path = parsed_path(place)
    for some in permutations(names):
        text = form.format(separator.join(some))
        (message,) = refusals(with_entry(FULL, path, [text] if as_entry else text), path)[:1]
        assert message.endswith(f"write {key}: [{', '.join(some)}]")
        assert not any("unknown" in text for text in refusals(with_entry(FULL, path, [*some]), path))


def test_a_name_that_has_a_comma_is_a_name():
    assert "did you mean" in unknown_word("edge", "top, lift", ["top, left"])


@pytest.mark.parametrize(
    ("text", "hint"),
    [
        ("30%", "write 0.3"),
        ("0.5 %", "write 0.005"),
        ("3/10", "formulas"),
        ("2*(3+4)", "formulas"),
        ("1e-3", "quotes"),
        ("210 000", "write 210000 without blanks"),
        ("210 000 MPa", "write 210000 without blanks"),
        ("210,000 MPa", "write 210000 without a comma"),
        ("0,5 mm", "the decimal sign is a point"),
        ("5 kg", "write the number alone"),
    ],
)
def test_a_number_in_another_form_is_told_how_to_write_it(text: str, hint: str):
    assert hint in number_hint(text)


def _read(text: str) -> float | None:
    """The number that a text without quotes is in YAML."""
    tag = Loader(text).get_single_node().tag
    return READERS[tag](text) if tag in (f"{TAG}int", f"{TAG}float") else None


@pytest.mark.slow
@settings(max_examples=200)
@given(st.one_of(
    st.from_regex(r"[-+]?[0-9]{1,9}(_[0-9]{1,9}){0,2}(\.[0-9]{1,6})?(e-?[0-9]{1,3})?", fullmatch=True),
    st.text(st.characters(categories=["Nd"]), min_size=1, max_size=9),
    st.sampled_from(["nan", "-inf", "Infinity", "NaN", "+nan"]),
))  # fmt: skip
def test_only_a_number_that_yaml_reads_is_told_to_have_quotes(text: str):
    """Every other text that Python reads as a number is told the number, or that it is not finite."""
    hint = number_hint(text)
    if _read(text) is not None:
        assert hint == "; leave the quotes out"
    elif isfinite(float(text)):
        assert hint.startswith("; write ")
        assert _read(hint.removeprefix("; write ")) == pytest.approx(float(text), rel=1e-14)
    else:
        assert hint == f"; {text} is not a finite number"


@pytest.mark.parametrize("text", ["abc", "1.2.3", "-", "", "top-left", "e", "%"])
def test_a_text_without_a_number_gets_no_hint(text: str):
    assert number_hint(text) == ""
