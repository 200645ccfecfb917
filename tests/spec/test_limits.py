"""Limits of specs: size, depth, aliases, keys; each is refused at its place, soon."""

import time

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import bemcontact
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


def test_depth_counts_through_aliases():
    links = "".join(f"k{i}: &k{i} {'[' * 40}{f'*k{i - 1}' if i else 1}{']' * 40}\n" for i in range(60))
    assert f"nested more than {DEEPEST} deep" in refused(links)


def test_the_depth_that_is_allowed_is_read():
    assert "unknown key 'a'" in refused("a: " + "[" * (DEEPEST - 2) + "]" * (DEEPEST - 2))


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
