"""Contact zones, and the tools that move their rigid surfaces."""

from collections.abc import Iterable, Mapping, Sequence
from math import fsum
from typing import Annotated, Any, ClassVar, Self

from pydantic import AfterValidator, BeforeValidator, Field, WithJsonSchema, model_validator

from bemcontact.problems.rigid_surface import DeflectedContour, SurfaceSpec
from bemcontact.problems.surface_lines import LOADED
from bemcontact.problems.validation import ALL, Name, Number, Point, SpecModel, invalid
from bemcontact.problems.way import Way

CANCELLED = 1e-14
"""Fraction of the terms of a sum below which the sum is round-off of factors such as 0.1."""


def _as_list(value: Any) -> Any:
    """Read one name as a list of one name; a number is refused later as a name without quotes."""
    return (value,) if isinstance(value, str | int | float) else value


_SCHEMA = WithJsonSchema({"type": ["string", "array"], "items": {"type": "string"}, "minItems": 1})
Names = Annotated[tuple[Name, ...], Field(min_length=1), BeforeValidator(_as_list), _SCHEMA]
"""One name, or a list of names."""


def _unnamed(value: Any) -> Any:
    """Read the word for all edges as no names."""
    return None if isinstance(value, str) and value == ALL else value


class ContactZone(SpecModel):
    """Edges of the body that may touch a rigid surface without friction."""

    example: ClassVar[str] = "{edges: bottom, surface: {kind: plane, point: [0, 0], normal: [0, 1]}}"
    other_words: ClassVar[Mapping[str, str]] = {
        **LOADED,
        **dict.fromkeys(("friction", "friction_coefficient", "mu"), "contact is without friction; leave it out"),
        **dict.fromkeys(
            ("target", "rigid", "plane", "against"), "write surface: {kind: plane, point: [0, 0], normal: [0, 1]}"
        ),
    }

    edges: Annotated[Names | None, BeforeValidator(_unnamed), _SCHEMA] = Field(None, json_schema_extra={"default": ALL})
    """The name of the edge, or a list of names of edges, that may touch the surface. With `all`, or if it is left out,
    these are all edges without a condition that can see the surface. An edge may be in several zones."""
    surface: SurfaceSpec
    """The rigid surface."""

    def after(self, way: Way) -> Self:
        """Copy after another motion of its surface, no deflected contour, beside the body."""
        assert not isinstance(self.surface, DeflectedContour)
        return self.model_copy(update={"surface": self.surface.after(way)})

    @model_validator(mode="after")
    def _contour_of_edges(self) -> Self:
        """Refuse the contour of no edges."""
        if self.edges is None and isinstance(self.surface, DeflectedContour):
            raise invalid("a deflected contour is that of its own edges; give their names, such as edges: left")
        return self


class ToolDisplacement(SpecModel):
    """The displacement of a tool. The tool does not move along a component that is left out."""

    example: ClassVar[str] = "{y: -0.01}"

    x: Number | None = None
    """The displacement along x."""
    y: Number | None = None
    """The displacement along y."""
    rotation: Number | None = None
    """The small rotation about the point, in radians, counterclockwise."""


class ToolForce(SpecModel):
    """The force on a tool per thickness. The tool is free to move along each given component, even if it is 0."""

    example: ClassVar[str] = "{y: -100}"

    x: Number | None = None
    """The force along x."""
    y: Number | None = None
    """The force along y."""
    moment: Number | None = None
    """The moment about the point, counterclockwise. If it is left out, the tool cannot tilt."""


TOOL_COMPONENTS = (("x", "x", "along x"), ("y", "y", "along y"), ("rotation", "moment", "in rotation"))
"""Component of the displacement, component of the force, and its name in messages."""


class ToolAction(SpecModel):
    """The displacement of a tool, or the force on it, or a displacement along one axis and a force along another."""

    example: ClassVar[str] = "{force: {y: -100}}"

    displacement: ToolDisplacement = ToolDisplacement()
    """The small displacement of the tool along x and y, and its rotation; its normal component changes the gaps."""
    force: ToolForce = ToolForce()
    """The force on the tool along x and y, and the moment. The tool moves until contact balances them."""

    @model_validator(mode="after")
    def _one_value_per_axis(self) -> Self:
        """Refuse contradictions, and an action without a value."""
        for move, force, where in TOOL_COMPONENTS:
            if getattr(self.displacement, move) is not None and getattr(self.force, force) is not None:
                name = "moment" if force == "moment" else "force"
                raise invalid(f"both displacement and {name} are given {where}; give only one of them")
        if not any(self.displaced) and not any(self.free):
            raise invalid("the tool has no displacement and no force; give one of them, or leave the tool out")
        return self

    @property
    def displaced(self) -> tuple[bool, ...]:
        """Whether a displacement along x, a displacement along y and a rotation are given."""
        return tuple(getattr(self.displacement, move) is not None for move, _, _ in TOOL_COMPONENTS)

    @property
    def free(self) -> tuple[bool, ...]:
        """Whether the tool is free to move along x, along y, and to rotate: whether a force or moment is given."""
        return tuple(getattr(self.force, force) is not None for _, force, _ in TOOL_COMPONENTS)

    @property
    def position(self) -> tuple[float, ...]:
        """Displacement along x and y, and rotation; zero where none is given."""
        return tuple(getattr(self.displacement, move) or 0.0 for move, _, _ in TOOL_COMPONENTS)

    @property
    def load(self) -> tuple[float, ...]:
        """Force along x and y, and moment; zero where none is given."""
        return tuple(getattr(self.force, force) or 0.0 for _, force, _ in TOOL_COMPONENTS)

    def plus(self, others: Sequence[tuple[float, "ToolAction"]]) -> "ToolAction":
        """Add multiples of other actions; the sum has each component that one of them has."""
        terms = ((1.0, self), *others)
        displacement = _sum((factor, action.displacement) for factor, action in terms)
        force = _sum((factor, action.force) for factor, action in terms)
        return ToolAction(displacement=ToolDisplacement(**displacement), force=ToolForce(**force))


def _sum(parts: Iterable[tuple[float, SpecModel]]) -> dict[str, float]:
    """Sum of multiples of the components of models by name, in any order; zero if it is round-off beside its terms."""
    terms: dict[str, list[float]] = {}
    for factor, part in parts:
        for key, value in part:
            if value is not None:
                terms.setdefault(key, []).append(factor * value)
    least = {key: CANCELLED * fsum(map(abs, some)) for key, some in terms.items()}
    return {key: total if abs(total := fsum(some)) > least[key] else 0.0 for key, some in terms.items()}


def _without_repeats(value: tuple[str, ...]) -> tuple[str, ...]:
    """Refuse a zone that occurs twice."""
    for i, name in enumerate(value):
        if name in value[:i]:
            raise invalid(f"the zone '{name}' occurs twice in the list; list it once")
    return value


class RigidTool(ToolAction):
    """The rigid surfaces of some contact zones, which move together as one rigid body."""

    example: ClassVar[str] = "{zones: foot, force: {y: -100}}"

    zones: Annotated[Names, AfterValidator(_without_repeats)]
    """The name of the contact zone, or a list of names of zones, whose rigid surfaces move together."""
    point: Point | None = None
    """The point [x, y] where the force acts. Rotation and moment are about this point."""

    @model_validator(mode="after")
    def _moment_has_a_point(self) -> Self:
        """Refuse a rotation or a moment without a point."""
        if self.point is None and (self.displaced[2] or self.free[2]):
            name = "rotation" if self.displaced[2] else "moment"
            raise invalid(f"a {name} needs a point; give point: [x, y]")
        return self
