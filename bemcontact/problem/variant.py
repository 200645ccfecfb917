"""Variants: the same problem with other values, such as another mesh, under a name of its own."""

from collections.abc import Iterator, Mapping
from typing import Annotated, Any

from pydantic import AfterValidator, Field

from bemcontact.errors import Complaint, Path, ProblemError, dotted
from bemcontact.problem.key_path import existing_path, parsed_path
from bemcontact.problem.validation import Stated, Text, complain


def _not_empty(value: dict[str, Any]) -> dict[str, Any]:
    """Refuse a variant in which nothing varies."""
    if not value:
        raise complain("nothing is set; give values by their key paths, such as boundary.outer.top.elements: 5")
    return value


class Variant(Stated):
    """Values that are set in place of others, all of them at once."""

    description: Text = ""
    """What is different, and why."""
    set: Annotated[dict[Text, Any], AfterValidator(_not_empty), Field(json_schema_extra={"minProperties": 1})]
    """The values by their key paths, such as boundary.outer.top.elements: 5."""

    def paths(self, data: Mapping[str, Any]) -> dict[str, Path]:
        """Follow the key paths in the data of a problem; `ProblemError` about the key if one leads nowhere."""
        found, complaints = {}, []
        for key in self.set:
            try:
                found[key] = existing_path(data, parsed_path(key))
            except ProblemError as error:
                complaints += [Complaint(path=("set", key), message=str(item)) for item in error.complaints]
                continue
            if found[key][0] == "variants":
                complaints.append(Complaint(path=("set", key), message="a variant varies the problem, no variants"))
        if complaints:
            raise ProblemError(complaints)
        return found


def blamed(error: ProblemError, paths: Mapping[str, Path]) -> Iterator[Complaint]:
    """Say of what is wrong with a varied problem which of the values is to blame, or that all together are.

    Parameters
    ----------
    error : of the varied problem
    paths : of the values of the variant, by key

    Yields
    ------
    Complaint
        With its path from the variant.
    """
    for item in error.complaints:
        keys = [key for key, path in paths.items() if item.path[: len(path)] == path]
        told = f"{dotted(item.path)}: {item.message}" if item.path else item.message
        yield Complaint(path=("set", keys[-1]) if keys else (), message=f"with this variant, {told}")
