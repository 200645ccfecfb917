"""Limits of specs: size, depth, aliases, keys; each is refused at its place, soon."""

import re
import time

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import bemcontact
from bemcontact.problems.geometry import MOST_ELEMENTS, MOST_ENDS
from bemcontact.spec.yaml_1_2 import DEEPEST, MOST_CHARACTERS, MOST_KEYS, MOST_VALUES

SOON = 5.0
"""Seconds of processor time."""


def refused(text: str) -> str:
    """The first line of the error of a text, which comes soon."""
    start = time.process_time()
    with pytest.raises(bemcontact.SpecError) as caught:
        bemcontact.loads(text, "a.yaml")
    assert time.process_time() - start < SOON
    return str(caught.value).splitlines()[0]


def bomb(count: int, copies: int, entry: str = "[{}]", alias: str = "*a{}") -> str:
    """Anchors, each with several aliases of the one before."""
    lines = ["a0: &a0 {x: 1}"]
    for i in range(1, count):
        lines.append(f"a{i}: &a{i} " + entry.format(", ".join([alias.format(i - 1)] * copies)))
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize("copies", [2, 9])
@pytest.mark.parametrize("entry", ["[{}]", "{{<<: [{}]}}"])
def test_aliases_count_as_often_as_they_are_used(copies, entry):
    assert f"more than {MOST_VALUES} keys and values" in refused(bomb(30, copies, entry))


@pytest.mark.parametrize("depth", [DEEPEST + 1, 340, 600, 100_000])
@pytest.mark.parametrize("start", ["[", "{a: ", "- ", "? "])
def test_deep_nesting_is_refused_at_its_place(depth, start):
    line = refused(start * depth)
    assert "deep" in line
    assert line.startswith("a.yaml:1:")


@pytest.mark.parametrize("text", ["{}: 1", "c:\n  {}: {{x: 1}}", "x: {{{}: 1, b: 2}}", "x: [{}: 1]", "{}: a\nb: 1"])
@pytest.mark.parametrize("quote", ["", "'", '"'])
@pytest.mark.parametrize("length", [1030, 5000])
def test_a_key_that_is_too_long_is_said_to_be(text, quote, length):
    line = refused(text.format(quote + "k" * length + quote))
    assert re.fullmatch(r"a\.yaml:[12]:\d: a key has at most 1024 characters; shorten it", line)


@pytest.mark.parametrize("text", ["name: {} b: 1", "name: [{}, b: c: d]\n", "name: {}\nb: c: d", "{}: a"])
def test_a_long_text_is_no_long_key(text):
    words = " ".join(["word"] * (50 if text.startswith("{") else 500))
    assert "1024" not in refused(text.format(words))


def test_depth_counts_through_aliases():
    links = "".join(f"k{i}: &k{i} {'[' * 40}{f'*k{i - 1}' if i else 1}{']' * 40}\n" for i in range(60))
    assert f"nested more than {DEEPEST} deep" in refused(links)


def test_the_depth_that_is_allowed_is_read():
    assert "unknown key 'a'" in refused("a: " + "[" * (DEEPEST - 2) + "]" * (DEEPEST - 2))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("".join(f"k{i}: 1\n" for i in range(100_000)), "keys and values"),
        ("".join(f"k{i}: 1\n" for i in range(MOST_KEYS + 1)), f"more than {MOST_KEYS} keys"),
        ("a: 1 # " + "x" * MOST_CHARACTERS, "characters"),
        ("a: [" + "1," * 200_000 + "1]", "keys and values"),
        ("? " * 20_000, "deep"),
    ],
)
def test_large_texts_are_refused_soon(text, words):
    assert words in refused(text)


@pytest.mark.slow
@settings(max_examples=60)
@given(st.lists(st.tuples(st.integers(0, 9), st.integers(0, 9), st.booleans()), min_size=1, max_size=12))
def test_any_graph_of_aliases_ends(graph):
    """Aliases of anchors before and around them, in lists and as merged mappings."""
    text = ""
    for i, (one, other, merged) in enumerate(graph):
        targets = f"*n{min(one, i)}, *n{min(other, i)}"
        text += f"n{i}: &n{i} " + (f"{{<<: [{targets}], k{i}: 1}}\n" if merged else f"[{targets}]\n")
    refused(text)


def test_merged_keys_do_not_replace_given_ones():
    text = "a: &a {x: 1, y: 2}\nb: &b {<<: *a, y: 3}\nc: {<<: [*b, *a], x: 4}\n"
    with pytest.raises(bemcontact.SpecError):
        bemcontact.loads(text)
    from bemcontact.spec.reading import _parsed

    assert _parsed(text, "a").data["c"] == {"x": 4, "y": 3}


def test_halves_of_a_character_as_json_writes_them_are_the_character():
    from bemcontact.spec.reading import _parsed

    assert _parsed('"a\\ud83d\\ude00"', "a").data == "a\N{GRINNING FACE}"
    assert "half of a character" in refused('name: "\\ud83d"')


BODY = """\
name: block
material: {young_modulus: 1000, poisson_ratio: 0.3}
boundary: {outer: [%s, {name: right, start: [4, 0]}, {name: top, start: [4, 2]}, {name: left, start: [0, 2]}]}
conditions: {left: {displacement: {x: 0}}, top: {pressure: 1}}
contact_zones: {foot: {edges: bottom, surface: {kind: plane, point: [0, 0], normal: [0, 1]}}}
"""


def bottom(keys: str) -> str:
    return BODY % f"{{name: bottom, start: [0, 0], {keys}}}"


@pytest.mark.parametrize("elements", [MOST_ELEMENTS, MOST_ELEMENTS - 2])
def test_each_edge_has_an_element(elements):
    line = refused(bottom(f"elements: {elements}"))
    assert f"at least {elements + 3} elements are too many for a dense matrix" in line
    bemcontact.loads(bottom(f"elements: {MOST_ELEMENTS - 3}"))


@pytest.mark.slow
def test_many_ends_of_elements_need_elements():
    ends = [f"{k / 5000:.4f}" for k in range(1, 5000)]
    line = refused(bottom(f"ends_at: [{', '.join(ends)}]"))
    assert f"ends_at has 4999 places, more than {MOST_ENDS}" in line
    problem = bemcontact.loads(bottom(f"ends_at: [{', '.join(ends[:MOST_ENDS])}]"))
    start = time.process_time()
    others = {edge.name: [0.5] for edge in problem.boundary.edges}
    problem = problem.with_element_ends({**others, "bottom": [float(end) for end in ends]})
    assert problem.with_value("material.poisson_ratio", 0.2).edge("bottom").elements == 5000
    assert time.process_time() - start < SOON
    twice = refused(bottom(f"elements: 5000, ends_at: [{', '.join([*ends[:-1], ends[2500]])}]"))
    assert "ends here already" in twice


def test_a_body_that_is_too_slender_for_a_mesh_is_told_so():
    """Its user has stated no elements."""
    problem = bemcontact.loads(bottom("end: [4e6, 0]").replace("[4, ", "[4e6, "))
    with pytest.raises(bemcontact.ProblemError, match=r"a mesh of this body needs .* it is too slender"):
        bemcontact.solve(problem)
