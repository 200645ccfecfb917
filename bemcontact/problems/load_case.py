"""Load cases and their combinations."""

from typing import Annotated, ClassVar, Self

from pydantic import AfterValidator, Field, Strict, model_validator

from bemcontact.problems.conditions import Condition, Loads
from bemcontact.problems.contact_zone import ToolAction
from bemcontact.problems.validation import LARGEST_STATED, Name, SpecModel, Text, invalid


class LoadCase(SpecModel):
    """Conditions, loads and tool actions that are added to those of the problem.

    A load case does not change the supports of the body: it may give a displacement only where the problem has one, and
    a traction only where the problem has none.
    """

    example: ClassVar[str] = "{conditions: {top: {pressure: 1}}}"

    description: Text = ""
    """A description of the load case."""
    conditions: dict[Name, Condition] = Field(default_factory=dict)
    """The conditions on edges that are added, by edge name."""
    loads: Loads = Loads()
    """The loads on the volume of the body that are added."""
    bodies: dict[Name, Loads] = Field(default_factory=dict)
    """The loads on the volume of each of several bodies that are added, by the name of the body."""
    tools: dict[Name, ToolAction] = Field(default_factory=dict)
    """The displacements of tools and forces on them that are added, by the name of the tool."""

    @model_validator(mode="after")
    def _not_empty(self) -> Self:
        """Refuse a load case without loads."""
        if not self.conditions and self.loads == Loads() and not self.bodies and not self.tools:
            raise invalid("the load case is empty; give conditions, loads or tools")
        return self


def _not_empty(value: dict[str, float]) -> dict[str, float]:
    """Refuse a combination without load cases."""
    if not value:
        raise invalid("the combination is empty; give load cases with their factors, such as wind: 1.5")
    return value


def _of_moderate_size(value: float) -> float:
    """Refuse factors that are no factors of loads."""
    if value and not 1 / LARGEST_STATED <= abs(value) <= LARGEST_STATED:
        raise invalid(
            f"a factor is 0, or between {1 / LARGEST_STATED:g} and {LARGEST_STATED:g} in size, found {value:g}"
        )
    return value


Factor = Annotated[float, Strict(), AfterValidator(_of_moderate_size)]
"""Factor of a load case."""
Combination = Annotated[dict[Name, Factor], AfterValidator(_not_empty), Field(json_schema_extra={"minProperties": 1})]
"""Factors by load case."""
