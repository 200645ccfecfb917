"""Variants of a problem: values that replace others, by key path."""

from collections.abc import Iterator, Mapping
from typing import Annotated, Any, ClassVar

from pydantic import AfterValidator, Field

from bemcontact.errors import Issue, KeyPath, ProblemError, dotted
from bemcontact.problems.key_path import existing_path, parsed_path
from bemcontact.problems.validation import SpecModel, Text, invalid


def _not_empty(value: dict[str, Any]) -> dict[str, Any]:
    """Refuse a variant without values."""
    if not value:
        raise invalid("the variant sets no value; give values by key path, such as boundary.outer.top.elements: 5")
    return value


class Variant(SpecModel):
    """Values that replace others of the problem, all at once."""

    example: ClassVar[str] = "{set: {material.young_modulus: 70000}}"

    description: Text = ""
    """A description of the difference, and its reason."""
    set: Annotated[dict[Text, Any], AfterValidator(_not_empty), Field(json_schema_extra={"minProperties": 1})]
    """The values by key path, such as boundary.outer.top.elements: 5."""

    def paths(self, data: Mapping[str, Any]) -> dict[str, KeyPath]:
        """Key paths of the values in the data of a problem; `ProblemError` for keys that lead nowhere."""
        paths, issues = {}, []
        for key in self.set:
            try:
                path = parsed_path(key)
                if path[0] == "variants":
                    raise ProblemError("a variant cannot change variants; remove this value")
                paths[key] = existing_path(data, path)
            except ProblemError as error:
                issues += [Issue(path=("set", key), message=str(item)) for item in error.issues]
        if issues:
            raise ProblemError(issues)
        return paths


def issues_of_values(error: ProblemError, paths: Mapping[str, KeyPath]) -> Iterator[Issue]:
    """Issues of a problem with a variant, each with the path in the variant of the value that causes it."""
    for item in error.issues:
        keys = [key for key, path in paths.items() if item.path[: len(path)] == path]
        where = f"{dotted(item.path)}: " if item.path else ""
        yield Issue(path=("set", keys[-1]) if keys else (), message=f"with this variant, {where}{item.message}")
