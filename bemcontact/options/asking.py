"""Keywords that state a problem anew before it is solved, with the names of the options of the commands."""

from collections.abc import Mapping
from typing import Literal, TypedDict

AskedAccuracy = float | Literal["stated", "default"] | None
"""A relative accuracy as `Problem.accuracy` has it; "stated" is that of the problem."""


class AskingKeywords(TypedDict, total=False):
    """Keywords of all functions that take a problem; they are applied in this order."""

    variant: str | None
    """Name of the variant to take."""
    set: Mapping[str, object] | None
    """Values that replace others, by key path as of `Problem.with_values`."""
    case: str | None
    """Name of the load case or combination that acts."""
    accuracy: AskedAccuracy
    """Relative accuracy, to which a mesh is found, in place of that of the problem; None: nothing is said of errors."""
    refine: int
    """Number of equal parts into which each element is cut."""


ASKING = tuple(AskingKeywords.__annotations__)
"""Their names."""
