"""Variants: the same problem with other values, such as another mesh, under a name of its own."""

from collections.abc import Iterator, Mapping
from typing import Annotated, Any

from pydantic import AfterValidator, Field

from bemcontact.errors import Issue, KeyPath, ProblemError, dotted
from bemcontact.problem.key_path import existing_path, parsed_path
from bemcontact.problem.validation import SpecModel, Text, invalid


def _not_empty(value: dict[str, Any]) -> dict[str, Any]:
    """Refuse a variant in which nothing varies."""
    if not value:
        raise invalid("nothing is set; give values by their key paths, such as boundary.outer.top.elements: 5")
    return value


class Variant(SpecModel):
    """Values that are set in place of others, all of them at once."""

    description: Text = ""
    """What is different, and why."""
    set: Annotated[dict[Text, Any], AfterValidator(_not_empty), Field(json_schema_extra={"minProperties": 1})]
    """The values by their key paths, such as boundary.outer.top.elements: 5."""

    def paths(self, data: Mapping[str, Any]) -> dict[str, KeyPath]:
        """Follow the key paths in the data of a problem; `ProblemError` about the key if one leads nowhere."""
        found, issues = {}, []
        for key in self.set:
            try:
                found[key] = existing_path(data, parsed_path(key))
            except ProblemError as error:
                issues += [Issue(path=("set", key), message=str(item)) for item in error.issues]
                continue
            if found[key][0] == "variants":
                issues.append(Issue(path=("set", key), message="a variant varies the problem, no variants"))
        if issues:
            raise ProblemError(issues)
        return found


def blamed(error: ProblemError, paths: Mapping[str, KeyPath]) -> Iterator[Issue]:
    """Say of what is wrong with a varied problem which of the values is to blame, or that all together are.

    Parameters
    ----------
    error : of the varied problem
    paths : of the values of the variant, by key

    Yields
    ------
    Issue
        With its path from the variant.
    """
    for item in error.issues:
        keys = [key for key, path in paths.items() if item.path[: len(path)] == path]
        told = f"{dotted(item.path)}: {item.message}" if item.path else item.message
        yield Issue(path=("set", keys[-1]) if keys else (), message=f"with this variant, {told}")
