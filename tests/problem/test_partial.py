"""Problems as written: what is found in them, in which spelling, and what is passed over."""

from bemcontact.problem import Line, Material
from bemcontact.problem.partial import Written
from bemcontact.problem.problem import Problem


def test_misspelled_key_is_followed_in_its_spelling():
    problem = Written((), {"materiel": {"young_modulus": 1, "poisson_ratio": 0}})
    material = problem.below(Problem, "material")
    assert material.path == ("materiel",)
    assert material.read(Material) == Material(young_modulus=1, poisson_ratio=0)


def test_right_key_wins_over_a_misspelled_one():
    assert Written((), {"nam": "a", "name": "b"}).below(Line, "name") == Written(("name",), "b")


def test_parts_may_be_objects():
    assert Written(("edge",), Line(name="top", elements=1)).below(Line, "name") == Written(("edge", "name"), "top")


def test_what_is_not_there_is_none_and_has_no_entries():
    for value in ({}, None, 3, "text", []):
        absent = Written((), value).below(Problem, "material")
        assert absent == Written(("material",), None)
        assert list(absent.each()) == []
        assert absent.read(Material) is None


def test_entries_know_their_paths():
    assert [*Written(("a",), [1, 2]).each()] == [Written(("a", 0), 1), Written(("a", 1), 2)]
    assert [*Written(("a",), {"b": 1}).each()] == [Written(("a", "b"), 1)]
