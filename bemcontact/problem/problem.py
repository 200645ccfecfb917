"""A problem: a body, what acts on it, and the rigid surfaces that it may touch. Checked as a whole when it is made."""

from collections.abc import Mapping
from typing import Annotated, Any, Self

from pydantic import (
    AfterValidator,
    BeforeValidator,
    Field,
    ModelWrapValidatorHandler,
    ValidationError,
    WithJsonSchema,
    model_validator,
)

from bemcontact.errors import Complaint, ProblemError
from bemcontact.problem.boundary import Boundary
from bemcontact.problem.conditions import Condition
from bemcontact.problem.cross_checks import facing_complaints, mesh_complaints, name_complaints
from bemcontact.problem.curves import Edge
from bemcontact.problem.geometry import MOST_ELEMENTS
from bemcontact.problem.key_path import existing_path, parsed_path, with_entry
from bemcontact.problem.loads import Loads
from bemcontact.problem.material import Material
from bemcontact.problem.rigid_surface import RigidSurface
from bemcontact.problem.stated import Count, Name, Stated, Text, complain, complaints_of, unknown_word


class Units(Stated):
    """Labels of the units that all numbers are in; nothing is converted."""

    length: Text = ""
    """Label of the unit of length, such as mm."""
    force: Text = ""
    """Label of the unit of force, such as kN."""

    @property
    def stress(self) -> str:
        """Label of the unit of stress, such as kN/cm²; empty if a label is missing."""
        return f"{self.force}/{self.length}²" if self.force and self.length else ""


class MeshDensity(Stated):
    """How fine the mesh is, beyond the elements that each edge states."""

    refine: Annotated[Count, Field(ge=1, le=MOST_ELEMENTS)] = 1
    """The number of equal parts into which each stated element is cut."""


def _as_list(value: Any) -> Any:
    """Read one edge name as a list of one."""
    return (value,) if isinstance(value, str) else value


def _not_empty(value: dict[str, Any]) -> dict[str, Any]:
    """Refuse a problem without contact."""
    if not value:
        raise complain("there is no contact zone; name at least one, with its edges and its surface")
    return value


EdgeNames = Annotated[
    tuple[Name, ...],
    Field(min_length=1),
    BeforeValidator(_as_list),
    WithJsonSchema({"anyOf": [{"type": "string"}, {"type": "array", "items": {"type": "string"}, "minItems": 1}]}),
]


class ContactZone(Stated):
    """Edges of the body that may touch a rigid surface without friction."""

    edges: EdgeNames
    """The name of the edge, or a list of names of edges, that may touch the surface."""
    surface: RigidSurface
    """The rigid surface."""


class Problem(Stated):
    """A body in plane strain or plane stress, its conditions and loads, and where it may touch rigid surfaces.

    Raises
    ------
    ProblemError
        With a complaint, and the path of keys it belongs to, for everything that is wrong. Whether the body is held
        at all is not asked here but when it is condensed.
    """

    name: Name
    """A short name of the problem."""
    description: Text = ""
    """What the problem is, its source, and what is known of its solution."""
    units: Units = Units()
    """Labels of the units."""
    material: Material
    """The material of the body: young_modulus and poisson_ratio."""
    boundary: Boundary
    """The outline of the body: the edges of its outer loop, and of holes."""
    conditions: dict[Name, Condition] = Field(default_factory=dict)
    """What is prescribed on edges, by edge name; an edge that is left out is free of traction."""
    loads: Loads = Loads()
    """Loads on the volume of the body."""
    contact_zones: Annotated[dict[Name, ContactZone], AfterValidator(_not_empty)]
    """The contact zones by name, each with edges and the rigid surface that they may touch."""
    mesh: MeshDensity = MeshDensity()
    """Refinement of the mesh."""

    @model_validator(mode="wrap")
    @classmethod
    def _consistent(cls, data: Any, handler: ModelWrapValidatorHandler[Self]) -> Self:
        """Check the parts against each other too; of a problem with ill parts, the names at least."""
        try:
            problem = handler(data)
        except ValidationError as error:
            raise ProblemError([*complaints_of(error), *_name_complaints_of_raw(data)]) from None
        zones = problem.contact_zones
        names = [edge.name for edge in problem.boundary.edges]
        complaints = name_complaints(names, problem.conditions, {name: zone.edges for name, zone in zones.items()})
        complaints += mesh_complaints(problem.boundary, problem.mesh.refine)
        if not complaints:
            facing = {name: (zone.surface, zone.edges) for name, zone in zones.items()}
            complaints = facing_complaints(problem.boundary, facing)
        if complaints:
            raise ProblemError(complaints)
        return problem

    @property
    def size(self) -> float:
        """Diameter of the bounding box of the body [L]."""
        return self.boundary.size

    def edge(self, name: str) -> Edge:
        """Find an edge by its name; `ProblemError` if there is none."""
        for edge in self.boundary.edges:
            if edge.name == name:
                return edge
        known = [edge.name for edge in self.boundary.edges]
        raise ProblemError(Complaint(path=("boundary",), message=unknown_word("edge", name, known)))

    def refined(self, parts: int) -> Self:
        """Cut each element into so many equal parts."""
        return self.with_value("mesh.refine", self.mesh.refine * parts)

    def with_value(self, path: str, value: Any) -> Self:
        """Change one value and check the problem anew.

        Parameters
        ----------
        path : keys in dots and places in brackets: ``material.young_modulus``, ``boundary.outer[2].elements``; an edge
            may be given by its name, ``boundary.outer.top.elements``
        value : what may stand there in a spec

        Returns
        -------
        Problem
            A new one.

        Raises
        ------
        ProblemError
            If the path leads nowhere, or the problem with the new value is wrong.
        """
        data = self.model_dump()
        return type(self)(**with_entry(data, existing_path(data, parsed_path(path)), value))


def _names_of(raw: Any) -> dict[str, tuple[str, ...]]:
    """Read the edges of each contact zone that is in order by itself."""
    zones = {}
    for name, zone in raw.items() if isinstance(raw, Mapping) else ():
        try:
            zones[str(name)] = ContactZone.model_validate(zone).edges
        except ValidationError:
            continue
    return zones


def _edge_names_of(raw: Any) -> list[str] | None:
    """Read the names of all edges from a boundary that may be wrong otherwise; None if some are not to be had."""
    if isinstance(raw, Boundary):
        return [edge.name for edge in raw.edges]
    try:
        edges = [edge for loop in (raw["outer"], *raw.get("holes", ())) for edge in loop]
        names = [edge["name"] if isinstance(edge, Mapping) else edge.name for edge in edges]
    except (AttributeError, KeyError, TypeError):
        return None
    return names if all(isinstance(name, str) for name in names) else None


def _name_complaints_of_raw(data: Any) -> list[Complaint]:
    """Check the names in a problem that has ill parts, as far as they can be read."""
    if not isinstance(data, Mapping):
        return []
    names, conditions = _edge_names_of(data.get("boundary")), data.get("conditions")
    if names is None:
        return []
    conditions = conditions if isinstance(conditions, Mapping) else {}
    return name_complaints(names, conditions, _names_of(data.get("contact_zones")))
