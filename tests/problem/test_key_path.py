"""Key paths: reading them, following them, and replacing one entry."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bemcontact.errors import ProblemError, dotted
from bemcontact.problem.key_path import existing_path, parsed_path, with_entry

KEY = st.text(st.characters(codec="ascii", categories=["L", "N"], include_characters="_- "), min_size=1).filter(
    lambda key: key == key.strip()
)
DATA = {"name": "block", "outer": [{"name": "top", "n": 1}, {"name": "left", "n": 2}], "loads": None}


@given(KEY, st.lists(KEY | st.integers(0, 999)))
def test_reading_is_the_inverse_of_writing(first, rest):
    path = (first, *rest)
    assert parsed_path(dotted(path)) == path


@pytest.mark.parametrize("text", ["", ".", "a.", ".a", "a..b", "[0]", "a[b]", "a[0", "a]b", "a[-1]", "a[0]b=", " "])
def test_what_is_no_path_is_refused(text):
    with pytest.raises(ProblemError, match="is not a key path"):
        parsed_path(text)


def test_entry_of_a_list_may_be_meant_by_its_name():
    assert existing_path(DATA, ("outer", "left", "n")) == ("outer", 1, "n")
    assert existing_path(DATA, ("outer", 1, "n")) == ("outer", 1, "n")
    assert existing_path(DATA, ("loads", "gravity", "density")) == ("loads", "gravity", "density")


@pytest.mark.parametrize(
    ("path", "message"),
    [
        (("outer", 2), "outer: there is no entry [2], the list has 2; count from 0"),
        (("outer", "lift"), "outer: unknown entry 'lift'; did you mean 'left'?"),
        (("name", "x"), "name: has no entry x, it is the text 'block'; give a path to a value"),
        (("loads", 0), "loads: has no entry [0], it is nothing; give a path to a value"),
    ],
)
def test_path_to_nowhere_is_refused(path, message):
    with pytest.raises(ProblemError) as caught:
        existing_path(DATA, path)
    assert str(caught.value) == message


def test_replacing_an_entry_leaves_the_original_alone():
    changed = with_entry(DATA, ("outer", 1, "n"), 7)
    assert changed["outer"] == [{"name": "top", "n": 1}, {"name": "left", "n": 7}]
    assert DATA["outer"][1]["n"] == 2
    assert with_entry(DATA, ("loads", "gravity", "density"), 7)["loads"] == {"gravity": {"density": 7}}
