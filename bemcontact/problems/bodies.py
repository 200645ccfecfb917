"""Several bodies: what a spec says of each, their copies, and the contacts between them."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from typing import Annotated, Any, ClassVar, Self

from pydantic import (
    AfterValidator,
    BeforeValidator,
    Field,
    ValidatorFunctionWrapHandler,
    WrapValidator,
    model_validator,
)

from bemcontact.cached import cached_property
from bemcontact.frozen import frozen
from bemcontact.problems.boundary import Boundary
from bemcontact.problems.conditions import Condition, Loads
from bemcontact.problems.contact_zone import Names
from bemcontact.problems.curves import Edge, Pair, unit_vector
from bemcontact.problems.geometry import AnyEdge, Line, SplineEdge
from bemcontact.problems.material import Material
from bemcontact.problems.validation import Flag, Name, Number, Point, SpecModel, invalid, left_out
from bemcontact.problems.wording import described, unknown_word

SEPARATOR = "/"
"""What stands between the name of a body and that of its edge."""


def _stated_material(value: Any, handler: ValidatorFunctionWrapHandler) -> Any:
    """Read a mapping as a material, and a text as the name of one."""
    if value is None or isinstance(value, Material | str):
        return handler(value)
    if isinstance(value, Mapping):
        return Material.model_validate(value)
    raise invalid(f"expected the name of a material, or a mapping such as {Material.example}; found {described(value)}")


def _without_separator(value: str) -> str:
    """Refuse a name of a body that could not be told from that of its edge."""
    if SEPARATOR in value:
        raise invalid(
            f"the name of a body must not contain {SEPARATOR}, which stands before its edges; found {value!r}"
        )
    return value


BodyName = Annotated[Name, AfterValidator(_without_separator)]
"""A name of a body."""


class BodySpec(SpecModel):
    """One of several bodies: elastic, rigid, or a copy of another one."""

    example: ClassVar[str] = "{material: steel, boundary: {outer: [{name: bottom, start: [0, 0]}, …]}}"

    other_words: ClassVar[Mapping[str, str]] = {
        "mirror": "a copy is rotated and shifted, not mirrored; state the boundary of the mirrored body",
        **dict.fromkeys(("angle", "rotation", "turn"), "rotate turns a copy by degrees, about the point about"),
        **dict.fromkeys(("move", "translate", "offset"), "shift moves a copy by [x, y]"),
    }

    rigid: Flag = False
    """Whether the body is rigid. A rigid body has a boundary only, and stays where it is unless it is a tool."""
    material: Annotated[Material | Name | None, WrapValidator(_stated_material)] = None
    """The material of the body, or the name of one of the materials."""
    boundary: Boundary = left_out()
    """The boundary of the body."""
    conditions: dict[Name, Condition] = Field(default_factory=dict)
    """The conditions on the edges of this body, by edge name. An edge that is left out is free of traction."""
    loads: Loads = Loads()
    """The loads on the volume of this body."""
    copy_of: Name | None = None
    """The name of another body, whose material and boundary this one has too. Conditions and loads are not copied:
    it has its own, or {}."""
    shift: Point = (0.0, 0.0)
    """The displacement [x, y] of a copy, after its rotation."""
    rotate: Number = 0.0
    """The rotation of a copy in degrees, counterclockwise."""
    about: Point = (0.0, 0.0)
    """The point [x, y] about which a copy is rotated."""

    @model_validator(mode="before")
    @classmethod
    def _without_nothing(cls, data: Any) -> Any:
        """Leave out the boundary that a copy does not have, as its dump has it."""
        if isinstance(data, Mapping) and data.get("copy_of") is not None and data.get("boundary", 0) is None:
            return {key: value for key, value in data.items() if key != "boundary"}
        return data

    @model_validator(mode="after")
    def _one_form(self) -> Self:
        """Refuse what a copy, a rigid body or an elastic body cannot have, and what it needs and does not have."""
        if self.copy_of is not None:
            if self.boundary is not None or self.material is not None or self.rigid:
                raise invalid(
                    "a copy has boundary and material of its original, and is rigid if that is; remove them, or copy_of"
                )
            return self
        if self.shift != (0.0, 0.0) or self.rotate != 0.0 or self.about != (0.0, 0.0):
            raise invalid("shift, rotate and about place a copy; give copy_of too, or move the points of the boundary")
        if self.boundary is None:
            raise invalid("the boundary is missing; give the edges of its outer loop, or copy_of: the name of a body")
        if self.rigid:
            if self.material is not None or self.conditions or self.loads != Loads():
                raise invalid("a rigid body has no material, conditions or loads; remove them, or make a tool of it")
        elif self.material is None:
            raise invalid("the material is missing; give young_modulus and poisson_ratio, or the name of a material")
        return self

    def to_dict(self) -> dict[str, Any]:
        """Return the keys of a spec that state the same; a copy of a body that has them says so if it has none."""
        stated = super().to_dict()
        none = [] if self.copy_of is None else [key for key in ("conditions", "loads") if key in self.model_fields_set]
        return stated | {key: {} for key in none if key not in stated}


BETWEEN = "expected two bodies, or two edges as BODY/EDGE, such as [roller/under, rail/top]"


def _two_sides(value: Any) -> Any:
    """Refuse what is not a pair, before its entries are read."""
    if not isinstance(value, list | tuple) or len(value) != 2:
        raise invalid(f"{BETWEEN}; found {described(value)}")
    for side in value:
        for name in side if isinstance(side, list | tuple) else (side,):
            if isinstance(name, str) and "." in name and SEPARATOR not in name:
                raise invalid(f"an edge of a body is BODY/EDGE: write '{name.replace('.', SEPARATOR)}' for '{name}'")
    return value


Sides = Annotated[
    tuple[Names, Names], BeforeValidator(_two_sides), Field(json_schema_extra={"minItems": 2, "maxItems": 2})
]
"""The two sides of a contact or a bond."""


class BodyContact(SpecModel):
    """Contact of two bodies without friction."""

    example: ClassVar[str] = "{between: [roller/under, rail/top]}"
    other_words: ClassVar[Mapping[str, str]] = {
        **dict.fromkeys(
            ("clearance", "play", "interference", "overlap", "offset", "distance"),
            "gap is the clearance that is added to the gap as drawn; a negative one is an interference",
        ),
        **dict.fromkeys(("friction", "friction_coefficient", "mu"), "contact is without friction; leave it out"),
        **dict.fromkeys(
            ("master", "slave", "primary", "secondary", "bodies", "edges", "sides", "pair", "surfaces"),
            "both sides are between: [BODY/EDGE, BODY/EDGE], or two bodies",
        ),
    }

    between: Sides
    """The two sides: a body, or an edge as BODY/EDGE, or a list of edges of one body. Contact points are nodes of the
    first side, and the mesh of the second side is fitted to them; a rigid body counts as the second side."""
    gap: Number = 0.0
    """The clearance that is added to the gap as drawn; a negative one is an interference."""


@frozen
class Part:
    """An elastic body of a problem.

    Parameters
    ----------
    name : of the body; empty for the only body of a problem
    material, boundary, conditions, loads : of the body, with names of edges as they are in it
    """

    name: str
    material: Material
    boundary: Boundary
    conditions: Mapping[str, Condition]
    loads: Loads

    def edge_name(self, own: str) -> str:
        """Name that an edge of the body has in the problem."""
        return qualified(self.name, own)

    @cached_property
    def loops(self) -> tuple[tuple[Edge, ...], ...]:
        """All loops, with the names that edges have in the problem."""
        return named_loops(self.boundary, self.name)

    @property
    def edges(self) -> tuple[Edge, ...]:
        """All edges in order of the loops, with the names that they have in the problem."""
        return tuple(edge for loop in self.loops for edge in loop)


def qualified(body: str, edge: str) -> str:
    """Name of an edge of a body in a problem; the edges of an only body keep theirs."""
    return f"{body}{SEPARATOR}{edge}" if body else edge


def body_in(side: Sequence[str]) -> str:
    """Name of the body of one side of a contact."""
    return side[0].partition(SEPARATOR)[0]


def unknown_edge(name: str, edges: Collection[str]) -> str:
    """Say that a problem has no edge of a name; one without its body may be that of several bodies."""
    if SEPARATOR not in name:
        meant = [edge for edge in edges if edge.partition(SEPARATOR)[2] == name]
        own = [edge for edge in edges if edge.partition(SEPARATOR)[0] == name]
        if meant:
            return f"unknown edge '{name}'; edges of bodies are BODY/EDGE: write {' or '.join(map(repr, meant))}"
        if any(SEPARATOR in edge for edge in own):
            return f"'{name}' is a body; name its edges: {', '.join(own)}"
    return unknown_word("edge", name, edges)


def named_loops(boundary: Boundary, body: str) -> tuple[tuple[Edge, ...], ...]:
    """Loops of a boundary, with the names that edges have in the problem."""
    if not body:
        return boundary.loops
    if body not in boundary.in_bodies:
        boundary.in_bodies[body] = tuple(
            tuple(replace(edge, name=qualified(body, edge.name)) for edge in loop) for loop in boundary.loops
        )
    return boundary.in_bodies[body]


def placed(boundary: Boundary, body: BodySpec) -> Boundary:
    """The boundary of an original where its copy is; it needs no new check."""
    outer, *holes = (tuple(_placed(edge, body) for edge in loop) for loop in boundary.loop_specs)
    return Boundary.model_construct(outer=outer, holes=tuple(holes))


def _placed(edge: AnyEdge, body: BodySpec) -> AnyEdge:
    """An edge of the original where the copy has it."""
    changes: dict[str, Any] = {}
    for key in ("start", "end", "center"):
        if (point := getattr(edge, key, None)) is not None:
            changes[key] = _moved(point, body)
    if isinstance(edge, SplineEdge):
        changes["points"] = tuple(_moved(point, body) for point in edge.points)
        for key in ("start_direction", "end_direction"):
            if (direction := getattr(edge, key)) is not None:
                changes[key] = _turned(direction, body)
    elif not isinstance(edge, Line) and edge.angles is not None:
        if hasattr(edge, "rotation"):
            changes["rotation"] = edge.rotation + body.rotate  # pyright: ignore[reportAttributeAccessIssue]
        else:
            changes["angles"] = (edge.angles[0] + body.rotate, edge.angles[1] + body.rotate)
    changes["ends_at"] = tuple(_moved(at, body) if isinstance(at, tuple) else at for at in edge.ends_at)
    if edge.grading is not None and isinstance(edge.grading.towards, tuple):
        changes["grading"] = edge.grading.model_copy(update={"towards": _moved(edge.grading.towards, body)})
    return edge.model_copy(update=changes)


def _turned(direction: Pair, body: BodySpec) -> Pair:
    """A direction of the original where the copy has it."""
    (x, y), (c, s) = direction, unit_vector(body.rotate)
    return c * x - s * y, s * x + c * y


def _moved(point: Pair, body: BodySpec) -> Pair:
    """A point of the original where the copy has it; a quarter turn is exact."""
    (x, y), (x0, y0) = point, body.about
    c, s = unit_vector(body.rotate)
    return (
        x0 + c * (x - x0) - s * (y - y0) + body.shift[0],
        y0 + s * (x - x0) + c * (y - y0) + body.shift[1],
    )


def with_boundary(body: BodySpec, boundary: Boundary, material: Material | str | None) -> BodySpec:
    """A body with another division of its boundary; a copy becomes a body of its own."""
    kept = {"copy_of": None, "shift": (0.0, 0.0), "rotate": 0.0, "about": (0.0, 0.0), "material": material}
    return body.model_copy(update={**kept, "boundary": boundary})
