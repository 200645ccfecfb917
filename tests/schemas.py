"""Validators by the JSON Schemas of specs and results, made once and valid themselves."""

from functools import cache
from typing import Any

from jsonschema import Draft202012Validator

import bemcontact
from bemcontact.report import schema


def _validator(stated: dict[str, Any]) -> Draft202012Validator:
    Draft202012Validator.check_schema(stated)
    return Draft202012Validator(stated)


@cache
def of_spec() -> Draft202012Validator:
    return _validator(bemcontact.schema())


@cache
def of_result(kind: str) -> Draft202012Validator:
    """Of a kind of result, a key of `RESULTS`."""
    return _validator(schema.schema(kind))
