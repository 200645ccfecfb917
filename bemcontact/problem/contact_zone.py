"""Contact zones: edges of the body, and the rigid surface that they may touch."""

from typing import Annotated, Any

from pydantic import BeforeValidator, Field, WithJsonSchema

from bemcontact.problem.rigid_surface import StatedSurface
from bemcontact.problem.validation import Name, Stated


def _as_list(value: Any) -> Any:
    """Read one edge name as a list of one; a number is taken for a name without quotes, and refused as such."""
    return (value,) if isinstance(value, str | int | float) else value


EdgeNames = Annotated[
    tuple[Name, ...],
    Field(min_length=1),
    BeforeValidator(_as_list),
    WithJsonSchema({"type": ["string", "array"], "items": {"type": "string"}, "minItems": 1}),
]


class ContactZone(Stated):
    """Edges of the body that may touch a rigid surface without friction."""

    edges: EdgeNames
    """The name of the edge, or a list of names of edges, that may touch the surface."""
    surface: StatedSurface
    """The rigid surface."""
