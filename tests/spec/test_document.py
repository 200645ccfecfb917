"""Documents: places of issues and of overrides."""

from bemcontact.errors import Issue
from bemcontact.problems.validation import KeyIssue
from bemcontact.spec.document import Document, Mark, Place, error_text

TOP, KEY, VALUE = Mark(1, 1, "a:1:1"), Mark(2, 1, "a:2:1"), Mark(2, 4, "a:2:4")
DOCUMENT = Document(
    data={"n": 1},
    places={(): Place(value=TOP, key=TOP, scalar=False), ("n",): Place(value=VALUE, key=KEY, scalar=True)},
)


def test_place_of_an_issue_is_its_value_its_key_or_the_value_above():
    assert DOCUMENT.located(Issue(path=("n",), message="bad")) == (VALUE, "n: bad")
    assert DOCUMENT.located(KeyIssue(path=("n",), message="bad")) == (KEY, "n: bad")
    assert DOCUMENT.located(Issue(path=("m", 0), message="missing")) == (TOP, "m[0]: missing")


def test_place_of_an_entry_of_a_scalar_is_the_scalar():
    assert DOCUMENT.located(Issue(path=("n", "constant"), message="bad")) == (VALUE, "n: bad")


def test_change_replaces_all_places_below():
    mark = Mark(0, 0, "--set n=[2]")
    entry = Document(data=[2], places={(): DOCUMENT.places[()], (0,): DOCUMENT.places[("n",)]})
    changed = DOCUMENT.changed(("n",), entry, mark)
    assert (changed.data, changed.change, DOCUMENT.data) == ({"n": [2]}, mark, {"n": 1})
    assert changed.places.keys() == {(), ("n",), ("n", 0)}
    assert changed.located(Issue(path=("n", 0), message="bad"))[0] == mark


def test_lines_are_in_the_order_of_the_text():
    assert error_text([(VALUE, "second"), (TOP, "first")]) == "a:1:1: first\na:2:4: second"
