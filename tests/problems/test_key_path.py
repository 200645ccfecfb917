"""Key paths: parsing, following and replacing; raw values with misspelled keys."""

from typing import get_origin

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bemcontact.errors import ProblemError, dotted
from bemcontact.problems import Line, Material, Problem
from bemcontact.problems.key_path import NAMED, RawValue, existing_path, parsed_path, with_entry

KEY = st.text(st.characters(codec="ascii", categories=["L", "N"], include_characters="_- "), min_size=1).filter(
    lambda key: key == key.strip()
)
DATA = {"name": "block", "outer": [{"name": "top", "n": 1}, {"name": "left", "n": 2}], "loads": None}


@given(KEY, st.lists(KEY | st.integers(0, 999)))
def test_parsing_is_the_inverse_of_writing(first, rest):
    path = (first, *rest)
    assert parsed_path(dotted(path)) == path


@pytest.mark.parametrize("text", ["", ".", "a.", ".a", "a..b", "[0]", "a[b]", "a[0", "a]b", "a[-1]", "a[0]b=", " "])
def test_invalid_path_is_refused(text):
    with pytest.raises(ProblemError, match="is not a key path"):
        parsed_path(text)


def test_entry_of_a_list_may_be_given_by_its_name():
    assert existing_path(DATA, ("outer", "left", "n")) == ("outer", 1, "n")
    assert existing_path(DATA, ("outer", 1, "n")) == ("outer", 1, "n")
    assert existing_path(DATA, ("loads", "gravity", "density")) == ("loads", "gravity", "density")


def test_a_fillet_without_a_name_is_given_by_that_of_its_edge():
    """It is the name of the edge that the problem then has, also where the loop closes."""
    outer = [{"name": "a", "start": [0, 0], "end": [9, 0]}, {"fillet": 1}, {"name": "b", "end": [0, 9]}, {"name": "d"}]
    outer.append({"fillet": 1})
    problem = Problem(
        name="triangle",
        material={"young_modulus": 1.0, "poisson_ratio": 0.3},  # pyright: ignore[reportArgumentType]
        boundary={"outer": outer},  # pyright: ignore[reportArgumentType]
        conditions={"a-b": {"fixed": True}},  # pyright: ignore[reportArgumentType]
        contact_zones={"z": {"edges": "b", "surface": {"kind": "plane", "point": (9, 9), "normal": (-1, -1)}}},  # pyright: ignore
    )
    for name, radius in (("a-b", 0.5), ("d-a", 0.3)):
        changed = problem.with_value(f"boundary.outer.{name}.fillet", radius)
        assert changed.edge(name).length < problem.edge(name).length


@pytest.mark.parametrize(
    ("path", "message"),
    [
        (("outer", 2), "outer: there is no entry [2], the list has 2; count from 0"),
        (("outer", "lift"), "outer: unknown entry 'lift'; did you mean 'left'?"),
        (("name", "x"), "name: it has no entry x, because it is the text 'block'; give the path of a value"),
        (("loads", 0), "loads: it has no entry [0], because it is nothing; give the path of a value"),
    ],
)
def test_path_to_a_missing_entry_is_refused(path, message):
    with pytest.raises(ProblemError) as caught:
        existing_path(DATA, path)
    assert str(caught.value) == message


BODIES = {
    "materials": {"steel": {"young_modulus": 1}},
    "bodies": {
        "low": {"material": "steel", "boundary": {}},
        "up": {"material": "steel", "boundary": {}},
        "own": {"material": {"young_modulus": 2}, "boundary": {}},
        "twin": {"material": None, "boundary": None, "copy_of": "low"},
    },
}


@pytest.mark.parametrize(
    ("path", "message"),
    [
        ("bodies.low.material.young_modulus", "bodies.low.material: it is the name of a material; write "
         "materials.steel.young_modulus, which changes that of 'up' too"),
        ("bodies.twin.material.young_modulus", "bodies.twin: 'twin' is a copy of 'low' and has its material; write "
         "bodies.low.material.young_modulus, which changes both"),
        ("bodies.twin.boundary.outer", "bodies.twin: 'twin' is a copy of 'low' and has its boundary; write "
         "bodies.low.boundary.outer, which changes both"),
    ],
)  # fmt: skip
def test_a_value_that_bodies_share_is_to_be_changed_where_it_is_stated(path, message):
    with pytest.raises(ProblemError) as caught:
        existing_path(BODIES, parsed_path(path))
    assert str(caught.value) == message
    assert existing_path(BODIES, parsed_path("bodies.own.material.young_modulus"))
    assert existing_path(BODIES, parsed_path("bodies.low.material"))


def test_replacing_an_entry_does_not_change_the_original():
    changed = with_entry(DATA, ("outer", 1, "n"), 7)
    assert changed["outer"] == [{"name": "top", "n": 1}, {"name": "left", "n": 7}]
    assert DATA["outer"][1]["n"] == 2
    assert with_entry(DATA, ("loads", "gravity", "density"), 7)["loads"] == {"gravity": {"density": 7}}


def test_a_key_of_the_only_entry_of_a_list_leads_to_it():
    """A spec may state `force: {y: -200}` for a list of one force; with names or more entries there is a choice."""
    assert existing_path({"force": [{"x": 0, "y": -200}]}, ("force", "y")) == ("force", 0, "y")
    for entries in ([{"y": 1}, {"y": 2}], [{"name": "a", "y": 1}]):
        with pytest.raises(ProblemError):
            existing_path({"force": entries}, ("force", "y"))


@pytest.mark.parametrize("written", [{"y": -200}, None, {}, ()])
def test_the_first_entry_of_a_list_that_is_written_as_its_entry_or_not_yet_is_that_entry(written):
    for path in (("force", 0, "y"), ("force", "y")):
        assert existing_path({"force": written}, path) == ("force", "y")
    assert with_entry({"force": written}, ("force", "y"), 3)["force"] == {"y": 3}
    for path in (("force", 1, "y"), ("material", 0, "young_modulus")):
        with pytest.raises(ProblemError, match=r"no entry \[[01]\]"):
            existing_path({"force": {"y": -200}, "material": {"young_modulus": 1}}, path)


def test_value_under_a_misspelled_key_is_read():
    problem = RawValue((), {"materiel": {"young_modulus": 1, "poisson_ratio": 0}})
    material = problem.below(Problem, "material")
    assert material.path == ("materiel",)
    assert material.read(Material) == Material(young_modulus=1, poisson_ratio=0)


def test_correct_key_takes_precedence_over_a_misspelled_one():
    assert RawValue((), {"nam": "a", "name": "b"}).below(Line, "name") == RawValue(("name",), "b")


def test_raw_value_may_be_an_object():
    assert RawValue(("edge",), Line(name="top", elements=1)).below(Line, "name") == RawValue(("edge", "name"), "top")


def test_missing_value_is_none_and_has_no_entries():
    for value in ({}, None, 3, "text", []):
        absent = RawValue((), value).below(Problem, "material")
        assert absent == RawValue(("material",), None)
        assert list(absent.each()) == []
        assert absent.read(Material) is None


def test_entries_have_their_key_paths():
    assert [*RawValue(("a",), [1, 2]).each()] == [RawValue(("a", 0), 1), RawValue(("a", 1), 2)]
    assert [*RawValue(("a",), {"b": 1}).each()] == [RawValue(("a", "b"), 1)]


@pytest.mark.parametrize("key", NAMED)
def test_a_change_reaches_each_named_entry_and_adds_none(key):
    data = {key: {"presser": {"a": 1}}}
    assert existing_path(data, (key, "presser", "b")) == (key, "presser", "b")
    with pytest.raises(ProblemError, match=f"{key}: a change adds no .*; did you mean 'presser'?"):
        existing_path(data, (key, "preser", "a"))
    with pytest.raises(ProblemError, match="there are none"):
        existing_path({}, (key, "presser"))


def test_each_mapping_of_a_problem_with_free_names_is_known():
    """Conditions are named by edges, which the problem checks; all other mappings have names of the user's choice."""
    mappings = {key for key, item in Problem.model_fields.items() if get_origin(item.annotation) is dict}
    assert mappings == {*NAMED, "conditions"}
