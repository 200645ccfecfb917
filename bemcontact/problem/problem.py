"""A problem: a body, what acts on it, and the rigid surfaces that it may touch. Checked as a whole when it is made."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Annotated, Any, Self

from pydantic import (
    AfterValidator,
    Field,
    ModelWrapValidatorHandler,
    ValidationError,
    model_validator,
)

from bemcontact.errors import Complaint, ProblemError
from bemcontact.problem.boundary import Boundary
from bemcontact.problem.conditions import Condition
from bemcontact.problem.contact_zone import ContactZone
from bemcontact.problem.cross_checks import facing_complaints, mesh_complaints
from bemcontact.problem.curves import Edge
from bemcontact.problem.edge_names import name_complaints
from bemcontact.problem.geometry import MOST_ELEMENTS
from bemcontact.problem.key_path import existing_path, parsed_path, with_entry
from bemcontact.problem.load_case import Combination, LoadCase, case_complaints, tool_complaints
from bemcontact.problem.loads import Loads
from bemcontact.problem.material import Material
from bemcontact.problem.partial import Written
from bemcontact.problem.reference import StatedReference, Words, reference_complaints
from bemcontact.problem.rigid_tool import RigidTool, ToolAction
from bemcontact.problem.validation import Count, Flag, Name, Stated, Text, complain, complaints_of, unknown_word
from bemcontact.problem.variant import Variant, blamed


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
    fit_contact_edges: Flag = False
    """Whether to find the ends of contact first and grade the elements of the contact zones towards them."""


def _not_empty(value: dict[str, Any]) -> dict[str, Any]:
    """Refuse a problem without contact."""
    if not value:
        raise complain("there is no contact zone; name at least one, with its edges and its surface")
    return value


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
    contact_zones: Annotated[
        dict[Name, ContactZone], AfterValidator(_not_empty), Field(json_schema_extra={"minProperties": 1})
    ]
    """The contact zones by name, each with edges and the rigid surface that they may touch."""
    tools: dict[Name, RigidTool] = Field(default_factory=dict)
    """Rigid surfaces that are displaced, or loaded and free to move, by the name of the tool; others are fixed."""
    load_cases: dict[Name, LoadCase] = Field(default_factory=dict)
    """What acts in addition to conditions, loads and tools, which are permanent, by the name of the load case."""
    combinations: dict[Name, Combination] = Field(default_factory=dict)
    """Sums of load cases, each with its factor, by the name of the combination."""
    case: Name | None = None
    """The load case or combination that acts; if left out, all of them are solved one after the other."""
    mesh: MeshDensity = MeshDensity()
    """Refinement of the mesh."""
    reference: dict[Words, StatedReference] = Field(default_factory=dict)
    """What is known of the answer, by name: closed forms and published values, with which it is compared."""
    variants: dict[Name, Variant] = Field(default_factory=dict)
    """The same problem with other values, such as another mesh, by the name of the variant."""

    @model_validator(mode="wrap")
    @classmethod
    def _consistent(cls, data: Any, handler: ModelWrapValidatorHandler[Self]) -> Self:
        """Check the parts against each other too; where some are wrong, those that are right."""
        try:
            made = handler(data)
            written, complaints = Written((), made), []
        except ValidationError as error:
            made, written, complaints = None, Written((), data), complaints_of(error)
        complaints += cls._mismatches(written)
        if made is not None and not complaints:
            complaints += made._broken_variants()
        if made is None or complaints:
            raise ProblemError(complaints)
        return made

    @classmethod
    def _mismatches(cls, written: Written) -> list[Complaint]:
        """Find parts that do not fit each other: names first, then the geometry of what is right by itself."""
        boundary, conditions, zones = (written.below(cls, key) for key in ("boundary", "conditions", "contact_zones"))
        cases = [case.below(LoadCase, "conditions") for case in written.below(cls, "load_cases").each()]
        complaints = name_complaints(boundary, [conditions, *cases], zones)
        references = reference_complaints(written.below(cls, "reference"), zones, cls._written_cases(written))
        references += cls._wrong_actions(written, zones)
        body = boundary.read(Boundary)
        if body is None:
            return [*complaints, *references]
        if not complaints:  # an edge that is in a zone by mistake need not face the surface
            surfaces = {zone.path: made for zone in zones.each() if (made := zone.read(ContactZone))}
            complaints += facing_complaints(body, surfaces)
        density = written.below(cls, "mesh").read(MeshDensity) or MeshDensity()
        return [*complaints, *references, *mesh_complaints(body, boundary.path, density.refine)]

    @classmethod
    def _wrong_actions(cls, written: Written, zones: Written) -> list[Complaint]:
        """Find tools and load cases that do not fit the rest."""
        parts = {key: written.below(cls, key) for key in ("conditions", "tools", "load_cases", "combinations", "case")}
        cases, combinations, case = parts["load_cases"], parts["combinations"], parts["case"]
        complaints = [*tool_complaints(parts["tools"], zones), *case_complaints(cases, combinations, parts)]
        names = cls._written_cases(written)
        if isinstance(case.value, str) and case.value not in names:
            complaints.append(Complaint(path=case.path, message=unknown_word("load case", case.value, names)))
        return complaints

    @classmethod
    def _written_cases(cls, written: Written) -> list[str]:
        """Names of load cases and combinations, right or wrong."""
        parts = (written.below(cls, key) for key in ("load_cases", "combinations"))
        return [str(item.path[-1]) for part in parts for item in part.each()]

    @property
    def case_names(self) -> tuple[str, ...]:
        """Names of the load cases, then of the combinations."""
        return (*self.load_cases, *self.combinations)

    @property
    def title(self) -> str:
        """Its name, with that of the load case or combination that acts."""
        return self.name if self.case is None else f"{self.name}, {self.case}"

    def factors(self, case: str | None = None) -> dict[str, float]:
        """Factors by load case of a case or combination, of the one that acts if None; none of them acts by itself."""
        name = self.case if case is None else case
        if name is None or name in self.load_cases:
            return {} if name is None else {name: 1.0}
        if name in self.combinations:
            return dict(self.combinations[name])
        raise ProblemError(Complaint(path=("case",), message=unknown_word("load case", name, self.case_names)))

    def tool_action(self, tool: str) -> ToolAction:
        """What a tool is displaced and loaded by, with the load cases that act."""
        found: ToolAction = self.tools[tool]
        for case, factor in self.factors().items():
            if tool in self.load_cases[case].tools:
                found = found.plus(factor, self.load_cases[case].tools[tool])
        return found

    def with_case(self, name: str) -> Self:
        """Let a load case or a combination act, and no other; `ProblemError` if there is none of that name."""
        self.factors(name)
        return self.model_copy(update={"case": name})

    def with_factors(self, factors: Mapping[str, float]) -> Self:
        """Let load cases act by some factors, as a combination with a name that tells them.

        Raises
        ------
        ProblemError
            If there is no such load case, or a factor is no number.
        """
        name = " + ".join(f"{factor:.6g} {case}" for case, factor in factors.items()).replace(".", ",")
        data = self.model_dump(exclude={"variants"})
        return type(self)(**{**data, "combinations": {**self.combinations, name: dict(factors)}, "case": name})

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

    def variant(self, name: str) -> Self:
        """Take a variant: its values set, its name added to that of the problem, and no variants any more.

        Raises
        ------
        ProblemError
            If there is no such variant.
        """
        if name not in self.variants:
            raise ProblemError(Complaint(path=("variants",), message=unknown_word("variant", name, self.variants)))
        values, data = self.variants[name], self.model_dump(exclude={"variants"})
        paths = values.paths(data)
        for key, path in paths.items():
            data = with_entry(data, path, values.set[key])
        try:
            return type(self)(**{**data, "name": f"{data['name']}, {name}"})
        except ProblemError as error:
            raise ProblemError([*blamed(error, paths)]) from None

    def _broken_variants(self) -> Iterator[Complaint]:
        """Try all variants, so that a mistake in one is found before somebody asks for it."""
        for name in self.variants:
            try:
                self.variant(name)
            except ProblemError as error:
                yield from (replace(item, path=("variants", name, *item.path)) for item in error.complaints)

    def with_element_ends(self, ends: Mapping[str, Sequence[float]]) -> Self:
        """State all element ends of some edges; no mesh is fitted any more, and variants are left out.

        Parameters
        ----------
        ends : by the name of an edge, fractions of its length at which its elements end, ascending, without 0 and 1

        Returns
        -------
        Problem
            A new one; `mesh.refine` is kept.

        Raises
        ------
        ProblemError
            If an edge does not exist, or its elements cannot end there, would turn too much or are too many.
        """
        boundary = self.boundary.with_element_ends(ends)
        if complaints := mesh_complaints(boundary, ("boundary",), self.mesh.refine):
            raise ProblemError(complaints)
        mesh = self.mesh.model_copy(update={"fit_contact_edges": False})
        return self.model_copy(update={"boundary": boundary, "mesh": mesh, "variants": {}})

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
