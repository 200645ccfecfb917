"""The options of solving and comparing: keywords, uses and documentation follow the fields of one declaration."""

import inspect
from dataclasses import fields, replace
from functools import partial
from pathlib import Path
from typing import get_args, get_type_hints

import numpy as np
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

MODEL = Path(__file__).parents[2] / "models" / "cylinder_on_plane.yaml"
LOAD = "conditions.top.pressure"
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
        (bemcontact.solve, {"method": "qp1"}, "there is no option 'method'; did you mean 'formulation'"),
        (bemcontact.solve, {"tolerance": 0.01}, "there is no option 'tolerance'; did you mean 'accuracy'"),
        (bemcontact.solve, {"what": 1}, "there is no option 'what'; choose from formulation, weights"),
        (bemcontact.compare, {"method": "qp1"}, "there is no option 'method'; choose from formulations"),
        (bemcontact.random_starts, {"polish": True}, "there is no option 'polish'; choose from penalty, rows"),
        (bemcontact.random_starts, {"start": "null"}, "there is no option 'start'"),
        (bemcontact.solve, {"acuracy": 0.01}, "there is no option 'acuracy'; did you mean 'accuracy'"),
        (bemcontact.solve, {"progres": print}, "there is no option 'progres'; did you mean 'progress'"),
        (bemcontact.compare, {"progres": print}, "there is no option 'progres'; did you mean 'progress'"),
        (bemcontact.random_starts, {"cout": 3}, "there is no option 'cout'; did you mean 'count'"),
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


@pytest.mark.parametrize(
    "verb",
    [
        bemcontact.solve, bemcontact.solve_cases, bemcontact.random_starts, bemcontact.compare, bemcontact.condense,
        bemcontact.sensitivities, partial(bemcontact.follow, key=LOAD, to=2),
        partial(bemcontact.study, vary={LOAD: [2]}),
    ],
)  # fmt: skip
def test_each_verb_takes_what_is_asked_by_the_names_of_the_command(verb):
    """A mistake in each of them is found, in its place; a word that is near to one of them is led to it."""
    problem = bemcontact.load(MODEL)
    for asked, words in (
        ({"variant": "none"}, r"variants: .*none"), ({"set": {"material.nu": 1}}, r"material\.nu"),
        ({"case": "none"}, r"case: .*none"), ({"accuracy": 2.0}, r"^accuracy: "), ({"refine": 0}, "number of parts"),
        ({"refin": 2}, "did you mean 'refine'"),
    ):  # fmt: skip
        with pytest.raises(bemcontact.ProblemError, match=words):
            verb(problem, **asked)


def test_what_is_asked_of_a_solve_is_what_the_problem_states_then():
    problem = bemcontact.load(MODEL.parent / "gallery" / "roller_in_v_block.yaml")
    changes = {"material.young_modulus": 150e3}
    stated = problem.with_values(changes).with_case("aside").with_value("accuracy", 0.1)
    asked = bemcontact.solve(problem, set=changes, case="aside", accuracy=0.1)
    np.testing.assert_array_equal(asked.solution.pressure, bemcontact.solve(stated).solution.pressure)
    coarse = bemcontact.solve(bemcontact.load(MODEL), variant="paper", refine=2)
    assert coarse.problem is not None
    assert coarse.problem.mesh.refine == 2
    contact = asked.contact
    with pytest.raises(bemcontact.ProblemError, match="refine is 2, but a condensed problem"):
        bemcontact.solve(contact, refine=2)


@pytest.mark.parametrize(
    ("options", "keyword", "words"),
    [
        (bemcontact.QPOptions, "by_nmba", "there is no option 'by_nmba'; did you mean 'by_numba'?"),
        (bemcontact.QPOptions, "what", "there is no option 'what'; choose from max_iterations, feasibility_tolerance"),
        (SolveOptions, "penalti", "there is no option 'penalti'; did you mean 'penalty'?"),
        (SolveOptions, "method", "there is no option 'method'; did you mean 'formulation'?"),
        (ComparisonOptions, "seeed", "there is no option 'seeed'; did you mean 'seed'?"),
    ],
)
def test_classes_of_options_refuse_unknown_keywords_with_the_right_one(options, keyword, words):
    """A `TypeError` of Python named neither. `dataclasses.replace` refuses them too; what is known stays as it is."""
    for make in (options, partial(replace, options())):
        with pytest.raises(OptionError) as raised:
            make(**{keyword: 1})
        assert str(raised.value).startswith(words)
    assert options() == replace(options())
    assert [*inspect.signature(options).parameters] == [item.name for item in fields(options)]
