"""Problems as written: what is found in them, in which spelling, and what is passed over."""

from bemcontact.problem import Line, Material
from bemcontact.problem.partial import RawValue
from bemcontact.problem.problem import Problem


def test_misspelled_key_is_followed_in_its_spelling():
    problem = RawValue((), {"materiel": {"young_modulus": 1, "poisson_ratio": 0}})
    material = problem.below(Problem, "material")
    assert material.path == ("materiel",)
    assert material.read(Material) == Material(young_modulus=1, poisson_ratio=0)


def test_right_key_wins_over_a_misspelled_one():
    assert RawValue((), {"nam": "a", "name": "b"}).below(Line, "name") == RawValue(("name",), "b")


def test_parts_may_be_objects():
    assert RawValue(("edge",), Line(name="top", elements=1)).below(Line, "name") == RawValue(("edge", "name"), "top")


def test_what_is_not_there_is_none_and_has_no_entries():
    for value in ({}, None, 3, "text", []):
        absent = RawValue((), value).below(Problem, "material")
        assert absent == RawValue(("material",), None)
        assert list(absent.each()) == []
        assert absent.read(Material) is None


def test_entries_know_their_paths():
    assert [*RawValue(("a",), [1, 2]).each()] == [RawValue(("a", 0), 1), RawValue(("a", 1), 2)]
    assert [*RawValue(("a",), {"b": 1}).each()] == [RawValue(("a", "b"), 1)]
