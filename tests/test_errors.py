"""Hidden characters: which ones they are, and that escaping leaves none."""

import json
import unicodedata

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bemcontact.errors import (
    LINE_BREAKS,
    Issue,
    ProblemError,
    SpecError,
    escaped,
    escaped_json,
    escaped_lines,
    hidden_character,
)
from bemcontact.problems.units import Units
from bemcontact.serialization import json_text

TEXTS = st.text(st.characters(exclude_categories=()), max_size=20)
"""All code points, with halves of characters."""
MOVES_TEXT = {"LRE", "RLE", "LRO", "RLO", "PDF", "LRI", "RLI", "FSI", "PDI"}
"""Classes of characters that change the direction of the text after them."""


def test_control_characters_separators_and_changes_of_direction_are_hidden():
    for code in range(0x110000):
        character = chr(code)
        expected = (
            unicodedata.category(character) in {"Cc", "Cs", "Zl", "Zp"}
            or unicodedata.bidirectional(character) in MOVES_TEXT
        )
        if expected:
            assert hidden_character(character), f"{code:x}"


@pytest.mark.parametrize("text", ["MPa", "µ", "é", "Ω", "模型", "מודל", "\u200c", "👩\u200d🔧", "a\u00a0b", "☃"])
def test_letters_of_all_scripts_are_not_hidden(text):
    assert hidden_character(text) is None
    assert escaped(text) == text
    assert Units(length=text).length == text


@given(TEXTS)
def test_an_escaped_text_has_no_hidden_character(text):
    assert hidden_character(escaped(text)) is None
    assert hidden_character(escaped_lines(text), LINE_BREAKS) is None
    assert escaped_lines(text).count("\n") == text.count("\n")


@given(TEXTS)
def test_escaped_json_has_the_same_data(text):
    written = json_text({text: [text]})
    assert hidden_character(written, LINE_BREAKS) is None
    assert json.loads(written) == json.loads(json.dumps({text: [text]}))
    assert escaped_json("[1,\n2]") == "[1,\n2]"


@given(TEXTS)
def test_no_error_repeats_a_hidden_character(text):
    for error in (ProblemError(text), ProblemError(Issue(path=(text, 0), message=text)), SpecError(text)):
        assert hidden_character(str(error), LINE_BREAKS) is None
    assert "\n" not in str(Issue(path=(text,), message=text))


@given(TEXTS)
def test_a_label_is_one_line_without_hidden_characters(text):
    if hidden_character(text):
        with pytest.raises(ProblemError, match="one line of text"):
            Units(length=text)
    else:
        assert Units(length=text).length == text


@pytest.mark.parametrize("character", "\u115f\u1160\u17b4\u17b5\u2800\u3164\uffa0")
def test_letters_that_no_font_draws_are_hidden(character: str):
    assert hidden_character(character)


@pytest.mark.parametrize("key", ["k" * 200_000, "k " * 100_000])
def test_long_lines_are_shortened_and_keep_their_ends(key: str):
    text = str(ProblemError(Issue(path=(key,), message="is unknown; leave it out")))
    assert len(text) < 2400
    assert text.startswith("k")
    assert text.endswith("leave it out")
