"""The options of solving and comparing: keywords, uses and documentation follow the fields of one declaration."""

from dataclasses import fields
from typing import get_args, get_type_hints

import pytest

from bemcontact.options import (
    USES,
    ComparisonKeywords,
    ComparisonOptions,
    SolveKeywords,
    SolveOptions,
    StatementKeywords,
)

NAMED_IN_SIGNATURES = {"formulation", "formulations", "weights", "penalties"}
STARTS_AND_POLISH = {"start", "seed", "starts", "polish"}


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


def test_each_option_that_a_formulation_uses_is_a_field():
    assert {name for names in USES.values() for name in names} <= {item.name for item in fields(SolveOptions)}


@pytest.mark.parametrize("options", [SolveOptions, ComparisonOptions])
def test_the_docstring_has_the_meaning_of_each_option(options):
    words = " ".join(options.__doc__.split())
    assert all(f"{item.name} : {item.metadata['meaning']}" in words for item in fields(options))
