"""A problem: a body, its conditions and loads, and the rigid surfaces that it may touch; checked when it is made."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import (
    AfterValidator,
    Field,
    ModelWrapValidatorHandler,
    PrivateAttr,
    Strict,
    ValidationError,
    ValidatorFunctionWrapHandler,
    WrapValidator,
    model_validator,
)

from bemcontact.arrays import real_array
from bemcontact.checks.arguments import load_factors, shown, text_of_argument, whole_number
from bemcontact.errors import Issue, ProblemError
from bemcontact.options import EXPECTED_ACCURACY
from bemcontact.problem.boundary import Boundary
from bemcontact.problem.conditions import Condition, Loads
from bemcontact.problem.contact_zone import ContactZone, RigidTool, ToolAction
from bemcontact.problem.cross_checks import (
    edge_name_issues,
    facing_issues,
    load_case_issues,
    mesh_issues,
    reference_issues,
    tool_issues,
)
from bemcontact.problem.curves import Edge
from bemcontact.problem.geometry import MOST_ELEMENTS
from bemcontact.problem.joints import without_joints
from bemcontact.problem.key_path import RawValue, existing_path, parsed_path, with_entry
from bemcontact.problem.load_case import Combination, LoadCase
from bemcontact.problem.material import Material
from bemcontact.problem.reference import ReferenceSpec
from bemcontact.problem.rigid_surface import DeflectedContour
from bemcontact.problem.units import Units
from bemcontact.problem.validation import (
    Count,
    Flag,
    Name,
    SpecModel,
    Text,
    Title,
    invalid,
    issues_of,
)
from bemcontact.problem.variant import Variant, issues_of_values
from bemcontact.problem.visibility import zone_edges
from bemcontact.problem.wording import unknown_word

ACCURACY = 0.01
"""Relative accuracy that is asked for by default."""


class MeshDensity(SpecModel):
    """The mesh: whether it is found or stated, and its refinement."""

    example: ClassVar[str] = "{refine: 2}"

    refine: Annotated[Count, Field(ge=1, le=MOST_ELEMENTS)] = 1
    """The number of equal parts into which each element is cut."""
    adapt: Flag | None = None
    """Whether a mesh is found for the accuracy; where elements are stated, it is nowhere coarser. With false, the
    errors of the stated mesh are estimated if an accuracy is stated. If left out, a mesh is found if an accuracy is
    stated or an edge has no elements."""


def _has_contact(value: dict[str, Any]) -> dict[str, Any]:
    """Refuse a problem without a contact zone."""
    if not value:
        raise invalid("there is no contact zone; give at least one, with its edges and its surface")
    return value


def _accuracy(value: Any, handler: ValidatorFunctionWrapHandler) -> Any:
    """Say in one sentence what an accuracy is, in place of one for each kind of value."""
    try:
        return handler(value)
    except ValidationError:
        raise invalid(f"{EXPECTED_ACCURACY}, or null for none; found {shown(value)}") from None


class Problem(SpecModel):
    """A body in plane strain or plane stress, its conditions and loads, and the rigid surfaces that it may touch.

    Parameters are the keys of a spec, see the attributes.

    Raises
    ------
    ProblemError
        With an issue and its key path for each mistake. `bemcontact.condense` checks whether the body is held.
    """

    root: ClassVar[bool] = True

    name: Title
    """A short name of the problem."""
    description: Text = ""
    """A description of the problem: its source, and what is known about its solution."""
    units: Units = Units()
    """The labels of the units."""
    material: Material
    """The material of the body: young_modulus and poisson_ratio."""
    boundary: Boundary
    """The boundary of the body: the edges of its outer loop, and of its holes."""
    conditions: dict[Name, Condition] = Field(default_factory=dict)
    """The conditions on edges, by edge name. An edge that is left out is free of traction."""
    loads: Loads = Loads()
    """The loads on the volume of the body."""
    contact_zones: Annotated[
        dict[Name, ContactZone], AfterValidator(_has_contact), Field(json_schema_extra={"minProperties": 1})
    ]
    """The contact zones by name, each with edges and the rigid surface that they may touch."""
    tools: dict[Name, RigidTool] = Field(default_factory=dict)
    """The tools by name: rigid surfaces that are displaced, or loaded and free to move; others are fixed."""
    load_cases: dict[Name, LoadCase] = Field(default_factory=dict)
    """The load cases by name. A load case acts in addition to the conditions, loads and tools of the problem."""
    combinations: dict[Name, Combination] = Field(default_factory=dict)
    """The combinations by name: sums of load cases, each with a factor."""
    case: Name | None = None
    """The load case or combination to solve; if left out, all of them are solved one after the other."""
    accuracy: Annotated[
        Annotated[float, Strict(), Field(gt=0, lt=1)] | Literal["default"] | None, WrapValidator(_accuracy)
    ] = "default"
    """The accuracy to reach, relative: 0.003 is 0.3 %. A mesh is found on which no error bar is larger. If left out,
    it is 0.01, and a mesh that all edges state is taken as it is: its errors are estimated. With null none is asked
    for, all edges state their elements, and errors are not estimated."""
    mesh: MeshDensity = MeshDensity()
    """The mesh: whether it is found, and its refinement."""
    reference: dict[Title, ReferenceSpec] = Field(default_factory=dict)
    """The references by name: closed forms and published values, with which the result is compared."""
    variants: dict[Name, Variant] = Field(default_factory=dict)
    """The variants by name: values that replace others, such as another mesh."""

    _edges: dict[str, tuple[str, ...]] = PrivateAttr(default_factory=dict)
    """The edges of each zone; copies with other elements or loads share them."""

    @model_validator(mode="wrap")
    @classmethod
    def _consistent(cls, data: Any, handler: ModelWrapValidatorHandler[Self]) -> Self:
        """Check the parts against each other; if some parts are wrong, check the others."""
        try:
            problem = handler(data)
            raw, issues = RawValue((), problem), []
        except ValidationError as error:
            problem, raw, issues = None, RawValue((), data), issues_of(error)
        issues += cls._mismatches(raw)
        if problem is not None and not issues:
            issues += problem._variant_issues()
        if problem is None or issues:
            raise ProblemError(issues)
        for zone in problem.contact_zones:
            problem.edges_of(zone)
        return problem

    @classmethod
    def _mismatches(cls, raw: RawValue) -> list[Issue]:
        """Issues of parts that do not fit each other: names first, then the geometry of valid parts."""
        boundary, conditions, zones = (raw.below(cls, key) for key in ("boundary", "conditions", "contact_zones"))
        cases = [case.below(LoadCase, "conditions") for case in raw.below(cls, "load_cases").named()]
        issues = edge_name_issues(boundary, [conditions, *cases], zones)
        references = reference_issues(raw.below(cls, "reference"), zones, cls._raw_case_names(raw))
        references += cls._action_issues(raw, zones)
        body = boundary.read(Boundary)
        if body is None:
            return [*issues, *references]
        if not issues:  # else an edge may be in the zone by mistake
            valid = {item.path: zone for item in zones.named() if (zone := item.read(ContactZone))}
            prescribed = {item.name for group in (conditions, *cases) for item in group.named()}
            issues += facing_issues(body, valid, prescribed)
        density = raw.below(cls, "mesh").read(MeshDensity) or MeshDensity()
        issues += cls._mesh_choice_issues(raw, body, density)
        return [*issues, *references, *mesh_issues(body, boundary.path, density.refine)]

    @classmethod
    def _mesh_choice_issues(cls, raw: RawValue, body: Boundary, density: MeshDensity) -> Iterator[Issue]:
        """Issues of a mesh that is neither stated nor to be found."""
        accuracy = raw.below(cls, "accuracy")
        none_asked = accuracy.value is None and (isinstance(raw.value, Problem) or accuracy.name in raw.value)
        unmeshed = next((edge.name for edge in body.edges if edge.elements is None), None)
        if unmeshed is not None and density.adapt is False:
            message = f"edge '{unmeshed}' states no elements; give their number, or leave adapt out: the mesh is found"
            yield Issue(path=("mesh", "adapt"), message=message)
        elif none_asked and (unmeshed is not None or density.adapt):
            what = f"edge '{unmeshed}' states no elements" if unmeshed else "mesh.adapt is true"
            message = f"{what}, and a mesh is found for an accuracy; give one such as 0.01, or state all elements"
            yield Issue(path=accuracy.path, message=message)

    @classmethod
    def _action_issues(cls, raw: RawValue, zones: RawValue) -> list[Issue]:
        """Issues of tools and load cases that do not fit the other parts."""
        parts = {key: raw.below(cls, key) for key in ("conditions", "tools", "load_cases", "combinations", "case")}
        cases, combinations, case = parts["load_cases"], parts["combinations"], parts["case"]
        issues = [*tool_issues(parts["tools"], zones), *load_case_issues(cases, combinations, parts)]
        names = cls._raw_case_names(raw)
        if isinstance(case.value, str) and case.value not in names:
            issues.append(Issue(path=case.path, message=unknown_word("load case", case.value, names)))
        return issues

    @classmethod
    def _raw_case_names(cls, raw: RawValue) -> list[str]:
        """Names of load cases and combinations, valid or not."""
        parts = (raw.below(cls, key) for key in ("load_cases", "combinations"))
        return [item.name for part in parts for item in part.named()]

    @property
    def case_names(self) -> tuple[str, ...]:
        """Names of the load cases, then of the combinations."""
        return (*self.load_cases, *self.combinations)

    @property
    def asked_accuracy(self) -> float | None:
        """The relative accuracy to reach; None if none is asked for."""
        return ACCURACY if self.accuracy == "default" else self.accuracy

    @property
    def adapts(self) -> bool:
        """Whether a mesh is to be found for the accuracy."""
        if self.mesh.adapt is not None:
            return self.mesh.adapt
        return not self.boundary.meshed or isinstance(self.accuracy, float)

    @property
    def title(self) -> str:
        """Name of the problem, and of the load case or combination that acts."""
        return self.name if self.case is None else f"{self.name}, {self.case}"

    def factors(self, case: str | None = None) -> dict[str, float]:
        """Factors of the load cases in a case or combination; in the one that acts if None; empty if none acts."""
        name = self.case if case is None else text_of_argument(case, "the name of a load case")
        if name is None or name in self.load_cases:
            return {} if name is None else {name: 1.0}
        if name in self.combinations:
            return dict(self.combinations[name])
        raise ProblemError(Issue(path=("case",), message=unknown_word("load case", name, self.case_names)))

    def tool_action(self, tool: str) -> ToolAction:
        """Displacement of a tool and force on it, including the load cases that act."""
        if text_of_argument(tool, "the name of a tool") not in self.tools:
            raise ProblemError(Issue(path=("tools",), message=unknown_word("tool", tool, self.tools)))
        acting = [(self.load_cases[case].tools.get(tool), factor) for case, factor in self.factors().items()]
        added = [(factor, action) for action, factor in acting if action is not None]
        return self.tools[tool].plus(added) if added else self.tools[tool]

    def with_case(self, name: str) -> Self:
        """Copy with one load case or combination that acts.

        Parameters
        ----------
        name : name of the load case or combination

        Raises
        ------
        ProblemError
            If there is no load case or combination of this name.
        """
        self.factors(text_of_argument(name, "the name of a load case"))
        return self.model_copy(update={"case": name})

    def with_factors(self, factors: Mapping[str, float]) -> Self:
        """Copy in which load cases act with given factors, as a combination whose name lists them.

        Parameters
        ----------
        factors : factor of each load case, by name

        Raises
        ------
        ProblemError
            If a load case does not exist, or a factor is not a number.
        """
        numbers = load_factors(factors)
        name = " + ".join(f"{factor:.6g} {case}" for case, factor in numbers.items()).replace(".", ",")
        data = self.model_dump(exclude={"variants"})
        return type(self)(**{**data, "combinations": {**self.combinations, name: numbers}, "case": name})

    def edges_of(self, zone: str) -> tuple[str, ...]:
        """Names of the edges that may touch the surface of a contact zone.

        Parameters
        ----------
        zone : name of the zone
        """
        if zone not in self._edges:
            prescribed = {*self.conditions}.union(*(case.conditions for case in self.load_cases.values()))
            self._edges[zone] = zone_edges(self.boundary, self.contact_zones[zone], prescribed)
        return self._edges[zone]

    def without_joints(self) -> Self:
        """Copy in which edges that go on in the next one without any change are one edge, without variants.

        They have the same curve, conditions and zones, and state no elements. The name of the one edge has all theirs.
        """
        loops = [*zip(self.boundary.loop_specs, self.boundary.loops, strict=True)]
        surfaces = [zone.surface for zone in self.contact_zones.values()]
        known = [surface for surface in surfaces if not isinstance(surface, DeflectedContour)]
        known = known if len(known) == len(surfaces) else []
        (stated, edges), *others = loops
        first = without_joints(stated, edges, self._alike, known)
        near = first[0][0].own_ends()[0] or edges[0].start
        joined = [first, *(without_joints(*loop, self._alike, known, near) for loop in others)]
        names = {part: edge.name for loop in joined for edge, parts in loop for part in parts}
        outer, *holes = whole = [tuple(edge for edge, _ in loop) for loop in joined]
        if whole == [*map(tuple, self.boundary.loop_specs)] or len({*names.values()}) < sum(map(len, joined)):
            return self  # or a name is taken
        data = self.model_dump(exclude={"variants", "boundary"})
        for group in (data, *data["load_cases"].values()):
            group["conditions"] = {names[edge]: condition for edge, condition in group["conditions"].items()}
        for zone in data["contact_zones"].values():
            zone["edges"] = zone["edges"] and tuple(dict.fromkeys(names[edge] for edge in zone["edges"]))
        return type(self)(**data, boundary=Boundary(outer=outer, holes=tuple(holes)))

    def _alike(self, one: str, other: str) -> bool:
        """Whether two edges have the same conditions under all load cases, and are named by the same zones.

        A deflected contour is that of edges as they are stated.
        """
        if any(isinstance(zone.surface, DeflectedContour) for zone in self.contact_zones.values()):
            return False
        groups = [self.conditions, *(case.conditions for case in self.load_cases.values())]
        named = [zone.edges for zone in self.contact_zones.values() if zone.edges is not None]
        return all(group.get(one) == group.get(other) for group in groups) and all(
            (one in edges) == (other in edges) for edges in named
        )

    def edge(self, name: str) -> Edge:
        """Edge with a name; `ProblemError` if there is none."""
        text_of_argument(name, "the name of an edge")
        for edge in self.boundary.edges:
            if edge.name == name:
                return edge
        known = [edge.name for edge in self.boundary.edges]
        raise ProblemError(Issue(path=("boundary",), message=unknown_word("edge", name, known)))

    def refined(self, parts: int) -> Self:
        """Copy with a finer mesh.

        Parameters
        ----------
        parts : number of equal parts into which each element is cut
        """
        parts = whole_number(parts, "number of parts", 1)
        return self if parts == 1 else self.with_value("mesh.refine", self.mesh.refine * parts)

    def variant(self, name: str) -> Self:
        """Copy with the values of a variant. Its name has the name of the variant added, and it has no variants.

        Parameters
        ----------
        name : name of the variant

        Raises
        ------
        ProblemError
            If there is no variant of this name.
        """
        if text_of_argument(name, "the name of a variant") not in self.variants:
            raise ProblemError(Issue(path=("variants",), message=unknown_word("variant", name, self.variants)))
        variant, data = self.variants[name], self.model_dump(exclude={"variants"})
        paths = variant.paths(data)
        for key, path in paths.items():
            data = with_entry(data, path, variant.set[key])
        try:
            return type(self)(**{**data, "name": f"{data['name']}, {name}"})
        except ProblemError as error:
            raise ProblemError([*issues_of_values(error, paths)]) from None

    def _variant_issues(self) -> Iterator[Issue]:
        """Issues of all variants, so that mistakes are reported before a variant is used."""
        for name in self.variants:
            try:
                self.variant(name)
            except ProblemError as error:
                yield from (replace(item, path=("variants", name, *item.path)) for item in error.issues)

    def with_element_ends(self, ends: Mapping[str, Sequence[float]]) -> Self:
        """Copy with all element ends of some edges given, without variants; its mesh is taken as it is.

        Parameters
        ----------
        ends : fractions of the length at which elements end, by edge name; ascending, without 0 and 1

        Raises
        ------
        ProblemError
            If an edge does not exist, its elements cannot end there, turn too much, or are too many.
        """
        if not isinstance(ends, Mapping):
            raise ProblemError(f"ends by edge name are needed, such as {{'top': [0.5]}}; found {shown(ends)}")
        numbers = {
            text_of_argument(name, "the name of an edge"): real_array(given, f"the ends on '{name}'", (None,)).tolist()
            for name, given in ends.items()
        }
        boundary = self.boundary.with_element_ends(numbers)
        if issues := mesh_issues(boundary, ("boundary",), self.mesh.refine):
            raise ProblemError(issues)
        mesh = self.mesh.model_copy(update={"adapt": False})
        return self.model_copy(update={"boundary": boundary, "mesh": mesh, "variants": {}})

    def to_be_meshed(self, accuracy: float) -> Self:
        """Copy whose mesh is to be found for an accuracy: no edge states elements, and there are no variants."""
        mesh, boundary = MeshDensity(), self.boundary.without_elements()
        return self.model_copy(update={"boundary": boundary, "mesh": mesh, "accuracy": accuracy, "variants": {}})

    def with_value(self, path: str, value: Any) -> Self:
        """Copy with one value changed.

        Parameters
        ----------
        path : key path such as ``material.young_modulus`` or ``boundary.outer[2].elements``; an edge may be given by
            its name, ``boundary.outer.top.elements``. Zones, tools and load cases are changed, none is added.
        value : the new value, of the form that a spec has there

        Raises
        ------
        ProblemError
            If the path leads nowhere, or the problem with the new value is wrong.
        """
        return self.with_values({text_of_argument(path, "a key path"): value})

    def with_values(self, changes: Mapping[str, Any]) -> Self:
        """Copy with several values changed at once; only the problem with all of them has to be right.

        Parameters
        ----------
        changes : new values by key path, as of `with_value`, made in their order

        Raises
        ------
        ProblemError
            If a path leads nowhere, or the problem with the new values is wrong.
        """
        if not isinstance(changes, Mapping):
            example = "{'material.young_modulus': 70e3, 'material.poisson_ratio': 0.33}"
            raise ProblemError(f"values by key path are needed, such as {example}; found {shown(changes)}")
        data = self.model_dump()
        for path, value in changes.items():
            data = with_entry(data, existing_path(data, parsed_path(path)), value)
        return type(self)(**data)
