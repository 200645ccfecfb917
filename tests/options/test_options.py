"""The options of solving and comparing: keywords, uses and documentation follow the fields of one declaration."""

from dataclasses import fields
from pathlib import Path
from typing import get_args, get_type_hints

import pytest

import bemcontact
from bemcontact.errors import OptionError
from bemcontact.options import (
    USES,
    ComparisonKeywords,
    ComparisonOptions,
    SolveKeywords,
    SolveOptions,
    StatementKeywords,
)
from bemcontact.options.declaration import OF_PROBLEM

MODEL = Path(__file__).parents[2] / "models" / "cylinder_on_plane.yaml"
NAMED_IN_SIGNATURES = {"formulation", "formulations", "weights", "penalties"}
STARTS_AND_POLISH = {"start", "seed", "starts", "solver", "polish"}


@pytest.mark.parametrize(
    ("keywords", "options", "other"),
    [
        (SolveKeywords, SolveOptions, set()),
        (StatementKeywords, SolveOptions, STARTS_AND_POLISH),
        (ComparisonKeywords, ComparisonOptions, set()),
    ],
)
def test_keywords_are_the_fields_of_the_options_with_their_types(keywords, options, other):
    stated, declared = get_type_hints(keywords), get_type_hints(options)
    assert stated.keys() == declared.keys() - NAMED_IN_SIGNATURES - other
    for name, hint in stated.items():
        kinds = {*(get_args(declared[name]) or (declared[name],))}
        assert kinds <= {*(get_args(hint) or (hint,))}, name


@pytest.mark.parametrize(
    ("call", "options", "words"),
    [
        (bemcontact.solve, {"method": "qp1"}, "there is no option 'method'; choose from formulation, weights"),
        (bemcontact.compare, {"method": "qp1"}, "there is no option 'method'; choose from formulations"),
        (bemcontact.random_starts, {"polish": True}, "there is no option 'polish'; choose from penalty, rows"),
        (bemcontact.random_starts, {"start": "null"}, "there is no option 'start'"),
        (bemcontact.solve, {"acuracy": 0.01}, "there is no option 'acuracy'; did you mean 'accuracy'"),
        (bemcontact.solve, {"polish": "no"}, "polish must be True or False; found 'no'"),
        (bemcontact.solve, {"starts": 3}, "complementarity has no use for the option 'starts'"),
    ],
)
def test_an_option_that_does_not_exist_or_has_no_use_is_refused_by_its_name(call, options, words):
    with pytest.raises(OptionError, match=words):
        call(bemcontact.CondensedContact.from_compliance([[1.0]], [-1.0]), **options)


def test_each_option_that_a_formulation_uses_is_a_field():
    assert {name for names in USES.values() for name in names} <= {item.name for item in fields(SolveOptions)}


@pytest.mark.parametrize("options", [SolveOptions, ComparisonOptions])
def test_the_docstring_has_the_meaning_of_each_option(options):
    words = " ".join(options.__doc__.split())
    assert all(f"{item.name} : {item.metadata['meaning']}" in words for item in fields(options))


@pytest.mark.parametrize("option", OF_PROBLEM)
def test_an_option_of_the_problem_is_refused_with_the_call_to_write(option: str):
    problem = bemcontact.load(MODEL)
    with pytest.raises(OptionError, match=rf"'{option}'.*write problem\.") as refused:
        bemcontact.compare(problem, **{option: 2})
    method = str(refused.value).rpartition("problem.")[2].partition("(")[0]
    assert callable(getattr(problem, method))
