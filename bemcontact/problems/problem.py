"""A problem: elastic bodies, their conditions and loads, and what they may touch; checked when it is made."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Annotated, Any, ClassVar, Literal, Self

import numpy as np
from pydantic import (
    ConfigDict,
    Field,
    ModelWrapValidatorHandler,
    Strict,
    ValidationError,
    ValidatorFunctionWrapHandler,
    WrapValidator,
    model_validator,
)

from bemcontact.arrays import real_array
from bemcontact.checks.arguments import load_factors, shown, text_of_argument, whole_number
from bemcontact.errors import Issue, KeyPath, ProblemError
from bemcontact.options import EXPECTED_ACCURACY
from bemcontact.problems.body_checks import (
    body_issues,
    closed_form_issues,
    contact_issues,
    opposite_issues,
    symmetry_issues,
)
from bemcontact.problems.boundary import Boundary
from bemcontact.problems.conditions import SPRING
from bemcontact.problems.contact_zone import ContactZone, RigidTool, ToolAction
from bemcontact.problems.cross_checks import (
    edge_name_issues,
    facing_issues,
    load_case_issues,
    mesh_issues,
    reference_issues,
    tool_issues,
)
from bemcontact.problems.curves import Edge
from bemcontact.problems.drawn_overlaps import overlap_issues
from bemcontact.problems.geometry import MOST_ELEMENTS
from bemcontact.problems.joints import without_joints
from bemcontact.problems.key_path import RawValue, existing_path, parsed_path, with_entry
from bemcontact.problems.load_case import Combination, LoadCase
from bemcontact.problems.quantities import with_numbers
from bemcontact.problems.reference import ReferenceSpec
from bemcontact.problems.rigid_surface import DeflectedContour
from bemcontact.problems.stated_bodies import StatedBodies
from bemcontact.problems.validation import (
    Count,
    Flag,
    Name,
    SpecModel,
    Title,
    invalid,
    issues_of,
    missing_keys,
)
from bemcontact.problems.variant import Variant, issues_of_values
from bemcontact.problems.way import AS_DRAWN
from bemcontact.problems.wording import unknown_word

ON_EDGE = 1e-9
"""Distance beyond the end of an edge, over its length, up to which a load is on the edge: round-off."""
ACCURACY = 0.01
"""Relative accuracy that is asked for by default."""


class MeshDensity(SpecModel):
    """The mesh: whether it is found or stated, and its refinement."""

    example: ClassVar[str] = "{refine: 2}"
    other_words: ClassVar[Mapping[str, str]] = dict.fromkeys(
        ("size", "element_size", "elements", "h", "density", "order"),
        "a mesh is found for the accuracy; an edge may state its elements, such as elements: 8",
    )

    refine: Annotated[Count, Field(ge=1, le=MOST_ELEMENTS)] = 1
    """The number of equal parts into which each element is cut."""
    adapt: Flag | None = None
    """Whether a mesh is found for the accuracy; where elements are stated, it is nowhere coarser. With false, the
    errors of the stated mesh are estimated if an accuracy is stated. If left out, a mesh is found if an accuracy is
    stated or an edge has no elements."""


NO_CONTACT = "there is no contact zone; give at least one, with its edges and its surface"
NO_BODIES = (
    "bodies is empty; give each body a name and under it material and boundary, or leave bodies out and give material, "
    "boundary and contact_zones of one body"
)
OF_ONE_BODY = ("material", "boundary", "contact_zones")
"""Keys that a problem of one body needs."""


def _accuracy(value: Any, handler: ValidatorFunctionWrapHandler) -> Any:
    """Say in one sentence what an accuracy is, in place of one for each kind of value."""
    try:
        return handler(value)
    except ValidationError:
        raise invalid(
            f"{EXPECTED_ACCURACY}, such as 0.01 for 1 percent, or null for none; found {shown(value)}"
        ) from None


class Problem(StatedBodies):
    """Bodies in plane strain or plane stress, their conditions and loads, and what they may touch.

    Parameters are the keys of a spec, see the attributes. A problem of one body has material and boundary, a problem of
    several bodies has bodies and contacts instead.

    Raises
    ------
    ProblemError
        With an issue and its key path for each mistake. `bemcontact.condense` checks whether the body is held.
    """

    model_config = ConfigDict(
        json_schema_extra={"anyOf": [{"required": [*OF_ONE_BODY]}, {"required": ["bodies"]}]},
    )
    root: ClassVar[bool] = True
    inside: ClassVar[tuple[str, ...]] = (
        "adapts", "after_motions", "asked_accuracy", "bonded_edges", "bonded_groups", "bonds", "boundary_of",
        "condition_path", "edge_conditions", "edges_of", "factors", "is_elastic", "load_stops", "loops", "on_mesh_of",
        "on_contacts_of", "opposite", "opposite_edges", "part_of", "parts", "reach_of", "several", "sides_of",
        "to_be_meshed", "tool_action", "touching_bodies", "touching_parts", "volume_loads", "without_joints", "zones",
    )  # fmt: skip
    other_words: ClassVar[Mapping[str, str]] = {
        "body": "bodies has several bodies by name; an only one has material and boundary at the top level",
        **dict.fromkeys(
            ("thickness", "depth", "width", "length"),
            "forces are per thickness, and nothing else depends on it; divide forces by it",
        ),
        **dict.fromkeys(
            ("E", "nu", "young_modulus", "poisson_ratio"),
            "it belongs to material: {young_modulus: …, poisson_ratio: …}",
        ),
        **dict.fromkeys(
            ("supports", "support", "boundary_conditions", "bc", "bcs", "constraints", "fixed", "fixtures", "symmetry"),
            "what holds or loads an edge is in conditions, by edge name: {left: {fixed: true}}",
        ),
        **dict.fromkeys(
            ("force", "forces", "pressure", "traction"),
            "loads on edges are in conditions, by edge name: {top: {pressure: 20}}",
        ),
        **dict.fromkeys(
            ("spring", "springs", "foundation"),
            f"springs on an edge are a condition of it, by edge name: {SPRING}",
        ),
        **dict.fromkeys(("roller", "rollers"), "a rigid roller is a contact zone with surface: {kind: circle, …}"),
        **dict.fromkeys(("friction", "mu"), "contact is frictionless; leave it out"),
        **dict.fromkeys(
            ("contact", "zones", "contact_pairs"),
            "contact with rigid surfaces is in contact_zones, contact between bodies in contacts",
        ),
        **dict.fromkeys(
            ("geometry", "outline", "outer", "edges", "shape"),
            "the outline is boundary: {outer: [{name: bottom, …}, …]}",
        ),
        **dict.fromkeys(("plane", "plane_stress"), "it belongs to material: {state: plane_stress, …}"),
        "title": "write name",
    }

    tools: dict[Name, RigidTool] = Field(default_factory=dict)
    """The tools by name: rigid surfaces that are displaced, or loaded and free to move; others are fixed."""
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

    @model_validator(mode="wrap")
    @classmethod
    def _consistent(cls, data: Any, handler: ModelWrapValidatorHandler[Self]) -> Self:
        """Check the parts against each other; if some parts are wrong, check the others."""
        if isinstance(data, Mapping) and data.get("bodies"):
            data = {key: value for key, value in data.items() if value is not None or key not in OF_ONE_BODY}
        data, unread = with_numbers(data)
        if any(issue.path[:1] == ("units",) for issue in unread):
            raise ProblemError(unread)
        try:
            problem = handler(data)
            raw, issues = RawValue((), problem), []
        except ValidationError as error:
            taken = {path for issue in unread for path in (issue.path, (*issue.path[:-1], 0, *issue.path[-1:]))}
            problem, raw = None, RawValue((), data)
            issues = [*unread, *(issue for issue in issues_of(error) if issue.path not in taken)]
        issues += cls._missing_parts(RawValue((), data))
        several = bool(raw.below(cls, "bodies").value)
        if not several:
            issues += cls._mismatches(raw)
            if problem is not None and not issues:
                issues += closed_form_issues(problem, problem.reference)
        elif problem is not None:
            issues += problem._mismatches_of_bodies()
        if problem is not None and not issues:
            issues += problem._load_place_issues()
            issues += symmetry_issues(problem, data)
        if problem is not None and not issues:
            issues += problem._variant_issues()
        if problem is None or issues:
            raise ProblemError(issues)
        for zone in problem.zones:
            problem.edges_of(zone)
        return problem

    def _load_place_issues(self) -> Iterator[Issue]:
        """Issues of loads that reach beyond the edge along which they are given."""
        cases = ((("load_cases", name, "conditions"), case.conditions) for name, case in self.load_cases.items())
        for room, conditions in ((("conditions",), self.edge_conditions), *cases):
            for edge, condition in conditions.items():
                length = self.edge(edge).length if condition.varies_along else 0.0
                beyond = [stop for stop in condition.stops(length) if not -ON_EDGE <= stop / length <= 1 + ON_EDGE]
                if beyond:
                    message = (
                        f"this load reaches to the distance {beyond[-1]:.6g} from the start of '{edge}', which is "
                        f"{length:.6g} long; keep it on the edge"
                    )
                    path = (*room, edge)
                    yield Issue(path=path if len(room) > 1 else self.condition_path(path), message=message)

    @classmethod
    def _missing_parts(cls, raw: RawValue) -> Iterator[Issue]:
        """Issues of a problem of one body without one of its parts."""
        if isinstance(raw.value, Mapping) and "body" in raw.value:
            return
        bodies, zones = raw.below(cls, "bodies"), raw.below(cls, "contact_zones")
        if bodies.value is not None and bodies.value != {}:
            return
        of_one = (raw.below(cls, key).value for key in ("material", "boundary"))
        if isinstance(raw.value, Mapping) and bodies.name in raw.value and all(value is None for value in of_one):
            if bodies.value is not None:  # else it is not a mapping
                yield Issue(path=bodies.path, message=NO_BODIES)
            return
        yield from missing_keys(cls, raw.value, OF_ONE_BODY)
        if isinstance(zones.value, Mapping) and not zones.value:
            yield Issue(path=zones.path, message=NO_CONTACT)

    @classmethod
    def _mismatches(cls, raw: RawValue) -> list[Issue]:
        """Issues of parts that do not fit each other: names first, then the geometry of valid parts."""
        boundary, conditions, zones = (raw.below(cls, key) for key in ("boundary", "conditions", "contact_zones"))
        cases = [case.below(LoadCase, "conditions") for case in raw.below(cls, "load_cases").named()]
        issues = edge_name_issues(boundary, [conditions, *cases], zones)
        references = reference_issues(raw.below(cls, "reference"), zones, cls._raw_case_names(raw))
        references += cls._action_issues(raw, zones, conditions)
        body = boundary.read(Boundary)
        if body is None:
            return [*issues, *references]
        if not issues:  # else an edge may be in the zone by mistake
            valid = {item.path: zone for item in zones.named() if (zone := item.read(ContactZone))}
            prescribed = {item.name for group in (conditions, *cases) for item in group.named()}
            issues += facing_issues(body.edges, valid, prescribed)
        density = raw.below(cls, "mesh").read(MeshDensity) or MeshDensity()
        issues += cls._mesh_choice_issues(raw, body.edges, density)
        return [*issues, *references, *mesh_issues(body, boundary.path, density.refine)]

    @classmethod
    def _mesh_choice_issues(cls, raw: RawValue, edges: Sequence[Edge], density: MeshDensity) -> Iterator[Issue]:
        """Issues of a mesh that is neither stated nor to be found."""
        accuracy = raw.below(cls, "accuracy")
        none_asked = accuracy.value is None and (isinstance(raw.value, Problem) or accuracy.name in raw.value)
        unmeshed = next((edge.name for edge in edges if edge.elements is None), None)
        if unmeshed is not None and density.adapt is False:
            message = f"edge '{unmeshed}' states no elements; give their number, or leave adapt out: the mesh is found"
            yield Issue(path=("mesh", "adapt"), message=message)
        elif none_asked and (unmeshed is not None or density.adapt):
            what = f"edge '{unmeshed}' states no elements" if unmeshed else "mesh.adapt is true"
            message = f"{what}, and a mesh is found for an accuracy; give one such as 0.01, or state all elements"
            yield Issue(path=accuracy.path, message=message)

    def _mismatches_of_bodies(self) -> list[Issue]:
        """Issues of parts of several bodies that do not fit each other."""
        if issues := [*body_issues(self)]:
            return issues
        raw, conditions = RawValue((), self), RawValue(("conditions",), self.edge_conditions)
        zones = RawValue(("contact_zones",), {**self.contact_zones, **self.contacts})
        issues += [*contact_issues(self, self.tools), *self._action_issues(raw, zones, conditions)]
        references = raw.below(type(self), "reference")
        issues += reference_issues(references, zones, self._raw_case_names(raw), several=True)
        stated: dict[KeyPath, ContactZone] = {
            ("contact_zones", name): zone for name, zone in self.contact_zones.items()
        }
        if not issues:
            issues += facing_issues(self.edges, stated, self._held_edges())
        if not issues:
            issues += overlap_issues(self) or [*opposite_issues(self), *closed_form_issues(self, self.reference)]
        issues += self._mesh_choice_issues(raw, self.edges, self.mesh)
        for part in self.parts:
            issues += mesh_issues(part.boundary, self._boundary_path(part.name), self.mesh.refine)
        return issues

    @classmethod
    def _action_issues(cls, raw: RawValue, zones: RawValue, conditions: RawValue) -> list[Issue]:
        """Issues of tools and load cases that do not fit the other parts."""
        parts = {key: raw.below(cls, key) for key in ("tools", "load_cases", "combinations", "case")}
        parts["conditions"] = conditions
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

    def __repr__(self) -> str:
        """One line: the name, and how many bodies, edges, zones and load cases there are."""
        counts = (
            ("body", "bodies", self.bodies), ("edge", "edges", self.edges),
            ("contact zone", "contact zones", self.zones), ("load case", "load cases", self.load_cases),
        )  # fmt: skip
        words = (f"{len(items)} {one if len(items) == 1 else more}" for one, more, items in counts if items)
        return f"<Problem {self.title!r}: {', '.join(words)}; bemcontact.dumps writes it>"

    __str__ = __repr__

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
        return any(edge.elements is None for edge in self.edges) or isinstance(self.accuracy, float)

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
        acting, moved = self.model_copy(update={"case": name}), self._ways.get(self.case or "", {})
        ways = {**dict.fromkeys(moved, AS_DRAWN), **self._ways.get(name, {})}
        return acting.after_motions(ways) if ways else acting

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

    def without_joints(self) -> Self:
        """Copy in which edges that go on in the next one without any change are one edge, without variants.

        Those of several bodies stay as they are stated.
        They have the same curve, conditions and zones, and state no elements. The name of the one edge has all theirs.
        """
        if self.boundary is None or self.boundary.meshed:
            return self  # edges that state their elements stay as they are
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
        if any(edge in group and group[edge].varies_along for group in groups for edge in (one, other)):
            return False
        return all(group.get(one) == group.get(other) for group in groups) and all(
            (one in edges) == (other in edges) for edges in named
        )

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
        issues, changed = list[Issue](), dict[str, Boundary]()
        known = [edge.name for edge in self.edges]
        if unknown := [name for name in numbers if name not in known]:
            raise ProblemError(Issue(path=("boundary",), message=unknown_word("edge", unknown[0], known)))
        for part in self.parts:
            own = {
                edge.name: numbers[full]
                for edge in part.boundary.edges
                if (full := part.edge_name(edge.name)) in numbers
            }
            changed[part.name] = part.boundary.with_element_ends(own)
            issues += mesh_issues(changed[part.name], self._boundary_path(part.name), self.mesh.refine)
        if issues:
            raise ProblemError(issues)
        mesh = self.mesh.model_copy(update={"adapt": False})
        return self._with_boundaries(changed, mesh=mesh, variants={})

    def on_mesh_of(self, other: Self) -> Self:
        """Copy on the mesh of another problem with the same boundaries, with its accuracy."""
        boundaries = {part.name: part.boundary for part in other.parts}
        return self._with_boundaries(boundaries, mesh=other.mesh, accuracy=other.accuracy)

    def to_be_meshed(self, accuracy: float) -> Self:
        """Copy whose mesh is to be found for an accuracy: no edge states elements, and there are no variants."""
        boundaries = {part.name: part.boundary.without_elements() for part in self.parts}
        return self._with_boundaries(boundaries, mesh=MeshDensity(), accuracy=accuracy, variants={})

    def with_value(self, path: str, value: Any) -> Self:
        """Copy with one value changed.

        Parameters
        ----------
        path : key path such as ``material.young_modulus`` or ``boundary.outer[2].elements``; an edge may be given by
            its name, ``boundary.outer.top.elements``. Zones, tools and load cases are changed, none is added.
        value : the new value, of the form that a spec has there; also a number or an array of NumPy

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
        paths = {path: parsed_path(path) for path in changes}
        changed = {str(keys[0]) for keys in paths.values()}
        data = {key: getattr(self, key) for key in type(self).model_fields} | self.model_dump(include=changed)
        for path, value in changes.items():
            data = with_entry(data, existing_path(data, paths[path]), _plain(value))
        return type(self)(**data)


def problem(parts: Mapping[str, Any]) -> Problem:
    """Make a problem from a mapping with the keys of a spec.

    Parameters
    ----------
    parts : mappings, lists, numbers and texts as YAML has them; also arrays and numbers of NumPy, and objects of
        ``bemcontact.problems`` such as ``Material(young_modulus=210e3, poisson_ratio=0.3)``

    Returns
    -------
    Problem

    Raises
    ------
    ProblemError
        With an issue and its key path for each mistake.
    """
    if not isinstance(parts, Mapping):
        message = f"the keys of a spec are needed, such as {{'name': …, 'material': …}}; found {shown(parts)}"
        raise ProblemError(f"{message}; bemcontact.load reads a file, and bemcontact.loads a text")
    for key in parts:
        if not isinstance(key, str):
            raise ProblemError(f"the keys of a spec are texts, such as 'name'; found {shown(key)}")
    return Problem(**_plain(parts))


def _plain(value: Any) -> Any:
    """A value with the numbers and arrays of NumPy in it as those of Python."""
    match value:
        case np.generic() | np.ndarray():
            return value.tolist()
        case Mapping():
            return {key: _plain(part) for key, part in value.items()}
        case list() | tuple():
            return [_plain(part) for part in value]
    return value
