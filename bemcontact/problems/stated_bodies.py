"""Bodies, conditions and contacts as a problem states them, and what follows for all elastic bodies together."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import chain
from typing import Any, Self

import numpy as np
from pydantic import Field, PrivateAttr

from bemcontact.checks.arguments import text_of_argument
from bemcontact.errors import Issue, KeyPath, ProblemError
from bemcontact.problems.approach import approached
from bemcontact.problems.bodies import (
    SEPARATOR,
    BodyContact,
    BodyName,
    BodySpec,
    Part,
    Sides,
    body_in,
    named_loops,
    placed,
    qualified,
    unknown_edge,
    with_boundary,
)
from bemcontact.problems.body_surface import BodySurface, BodyZone
from bemcontact.problems.boundary import Boundary, in_box
from bemcontact.problems.conditions import Condition, Loads
from bemcontact.problems.contact_zone import ContactZone
from bemcontact.problems.curves import CircularArc, Edge
from bemcontact.problems.edge_places import rests_on_flat
from bemcontact.problems.load_case import LoadCase
from bemcontact.problems.material import Material
from bemcontact.problems.pairing import OppositePart, opposite_parts
from bemcontact.problems.rigid_surface import DeflectedContour
from bemcontact.problems.units import Units
from bemcontact.problems.validation import Name, Point, SpecModel, Text, Title, left_out
from bemcontact.problems.visibility import edges_that_see, zone_edges
from bemcontact.problems.way import Way
from bemcontact.views import Drawn

REACH = 0.03
"""Part of the size of the smaller of two whole bodies up to which gaps may close: a larger strain is not small."""

SAME_CIRCLE = 1e-9
"""Distance of two centers over the radius up to which they are equal."""
SAME_PART = 1e-6
"""Fraction of an edge by which two parts of it may overlap and only meet."""
LEAST_SHARE = 0.05
"""Least part that a body that may spin has in common normals."""


class StatedBodies(SpecModel, Drawn):
    """What a problem states of its bodies and of what they may touch."""

    name: Title
    """A short name of the problem."""
    description: Text = ""
    """A description of the problem: its source, and what is known about its solution."""
    units: Units = Units()
    """The labels of the units."""
    material: Material = left_out()
    """The material of the body: young_modulus and poisson_ratio."""
    boundary: Boundary = left_out()
    """The boundary of the body: the edges of its outer loop, and of its holes."""
    materials: dict[Name, Material] = Field(default_factory=dict)
    """The materials of several bodies, by name."""
    bodies: dict[BodyName, BodySpec] = Field(default_factory=dict)
    """The bodies by name, if there are several. Their edges are called BODY/EDGE in contacts, zones and load cases."""
    contacts: dict[Name, BodyContact] = Field(default_factory=dict)
    """The contacts by name, each between two of the bodies."""
    bonded: dict[Name, Sides] = Field(default_factory=dict)
    """The bonded interfaces by name: two sides as of a contact, which coincide and move together."""
    conditions: dict[Name, Condition] = Field(default_factory=dict)
    """The conditions on edges, by edge name. An edge that is left out is free of traction."""
    loads: Loads = Loads()
    """The loads on the volume of the body."""
    contact_zones: dict[Name, ContactZone] = Field(default_factory=dict, json_schema_extra={"minProperties": 1})
    """The contact zones by name, each with edges and the rigid surface that they may touch."""
    load_cases: dict[Name, LoadCase] = Field(default_factory=dict)
    """The load cases by name. A load case acts in addition to the conditions, loads and tools of the problem."""

    _edges: dict[str, tuple[str, ...]] = PrivateAttr(default_factory=dict)
    """The edges of each zone; copies with other elements or loads share them."""
    _opposite: dict[str, tuple[OppositePart, ...]] = PrivateAttr(default_factory=dict)
    """The parts of edges that are opposite to another elastic body, of each contact; likewise."""
    _placed: dict[str, Boundary] = PrivateAttr(default_factory=dict)
    """The boundaries of copies; a copy with other elements has a boundary of its own."""
    _bonds: dict[str, BodyZone] = PrivateAttr(default_factory=dict)
    """Bonded interfaces by name; likewise."""
    _zones: dict[str, ContactZone | BodyZone] = PrivateAttr(default_factory=dict)
    """Contact zones and contacts by name; likewise."""
    _ways: dict[str, dict[str, Way]] = PrivateAttr(default_factory=dict)
    """Motions of rigid surfaces beside the body under load cases, by load case and zone."""

    @property
    def several(self) -> bool:
        """Whether the problem has several bodies."""
        return bool(self.bodies)

    @property
    def parts(self) -> tuple[Part, ...]:
        """The elastic bodies."""
        if not self.bodies:
            one = Part(
                name="", material=self.material, boundary=self.boundary, conditions=self.conditions, loads=self.loads
            )
            return (one,)
        return tuple(self._part(name, body) for name, body in self.bodies.items() if self.is_elastic(name))

    def is_elastic(self, body: str) -> bool:
        """Whether one of several bodies is elastic."""
        return not self.bodies[self.bodies[body].copy_of or body].rigid

    def _part(self, name: str, body: BodySpec) -> Part:
        """An elastic body."""
        material = self._material(name)
        return Part(
            name=name, material=material, boundary=self.boundary_of(name), conditions=body.conditions, loads=body.loads
        )

    def _material(self, body: str) -> Material:
        """Material of one of several elastic bodies."""
        stated = self.bodies[self.bodies[body].copy_of or body].material
        assert stated is not None, "an elastic body has one"
        return self.materials[stated] if isinstance(stated, str) else stated

    def boundary_of(self, body: str) -> Boundary:
        """Boundary of one of several bodies."""
        stated = self.bodies[body]
        if stated.copy_of is None:
            return stated.boundary
        if body not in self._placed:
            self._placed[body] = placed(self.boundary_of(stated.copy_of), stated)
        return self._placed[body]

    def sides_of(self, contact: str) -> tuple[str, str]:
        """Names of the two bodies of a contact or a bond."""
        first, second = self.bonded[contact] if contact in self.bonded else self.contacts[contact].between
        return body_in(first), body_in(second)

    def touching_bodies(self, zone: str) -> tuple[str, str]:
        """Names of the elastic body that has the edges of a zone, and of the one that it touches; '' for a surface."""
        own = self.part_of(self.edges_of(zone)[0])
        return own, next((name for name in self.sides_of(zone) if name != own), own) if zone in self.contacts else ""

    def touching_parts(self, zone: str | None) -> tuple[Part, ...]:
        """The elastic bodies that meet in a zone, that with its edges first; of no zone in the first one."""
        parts = {part.name: part for part in self.parts}
        names = self.touching_bodies(next(iter(self.zones)) if zone is None else zone)
        return tuple(parts[name] for name in dict.fromkeys(names) if name in parts)

    def part_of(self, edge: str) -> str:
        """Name of the body that has an edge; empty for the only body."""
        return edge.partition(SEPARATOR)[0] if self.bodies else ""

    @property
    def loops(self) -> tuple[tuple[Edge, ...], ...]:
        """All loops of the elastic bodies, with the names that edges have in the problem."""
        return tuple(loop for part in self.parts for loop in part.loops)

    @property
    def edges(self) -> tuple[Edge, ...]:
        """All edges of the elastic bodies in order of the loops, with the names that they have in the problem."""
        return tuple(chain.from_iterable(self.loops))

    @property
    def size(self) -> float:
        """Diameter of the bounding box of the elastic bodies [L]."""
        x, y = zip(*(corner for part in self.parts for corner in part.boundary.box), strict=True)
        return float(np.hypot(max(x) - min(x), max(y) - min(y)))

    @property
    def volume_loads(self) -> list[tuple[Loads, ...]]:
        """The loads on the volume of each elastic body: the permanent ones, then those of each load case."""
        parts = self.parts
        cases = [
            tuple(case.bodies.get(part.name, Loads()) if part.name else case.loads for part in parts)
            for case in self.load_cases.values()
        ]
        return [tuple(part.loads for part in parts), *cases]

    @property
    def edge_conditions(self) -> dict[str, Condition]:
        """The conditions on edges of all bodies, by the names that edges have in the problem."""
        if not self.bodies:
            return self.conditions
        return {part.edge_name(own): it for part in self.parts for own, it in part.conditions.items()}

    def load_stops(self, edge: Edge) -> list[float]:
        """Distances [L] from the start of an edge at which a load on it jumps or kinks, under any load case."""
        groups = (self.edge_conditions, *(case.conditions for case in self.load_cases.values()))
        stops = (stop for group in groups if edge.name in group for stop in group[edge.name].stops(edge.length))
        return [stop for stop in sorted({*stops}) if 0 < stop < edge.length]

    def condition_path(self, path: KeyPath) -> KeyPath:
        """Key path of a condition from ("conditions", name of the edge in the problem, …)."""
        if not self.bodies or path[:1] != ("conditions",):
            return path
        body, _, edge = str(path[1]).partition(SEPARATOR)
        return ("bodies", body, "conditions", edge, *path[2:])

    @property
    def zones(self) -> Mapping[str, ContactZone | BodyZone]:
        """The contact zones, then the contacts between bodies as zones on the surface of the second body."""
        zones = self._known("_zones")
        if self.contacts and not zones:
            zones.update(self.contact_zones)
            of_contacts = {name: self._zone_of(item.between, item.gap) for name, item in self.contacts.items()}
            zones.update(approached(of_contacts, self.bonded_groups))
        return zones or self.contact_zones

    @property
    def bonded_groups(self) -> dict[str, str]:
        """For each body that bonds join to others, directly or through others, the same one of these."""
        groups = dict[str, str]()
        for sides in self.bonded.values():
            one, two = (groups.setdefault(body, body) for body in map(body_in, sides))
            groups = {body: one if group == two else group for body, group in groups.items()}
        return groups

    @property
    def bonds(self) -> Mapping[str, BodyZone]:
        """The bonded interfaces, each as a zone of the first body on the surface of the second one."""
        if len(self._bonds) < len(self.bonded):
            of_bonds = {name: self._zone_of(sides, 0.0) for name, sides in self.bonded.items()}
            self._bonds.update(approached(of_bonds))
        return self._bonds

    def _known(self, name: str) -> dict[str, Any]:
        """A private attribute, without looking for it in all other places first."""
        private = self.__pydantic_private__
        assert private is not None
        return private[name]

    def _zone_of(self, between: tuple[Sequence[str], Sequence[str]], gap: float) -> BodyZone:
        """A contact between two bodies as a zone on the surface of the second one."""
        first, second = between
        if not self.is_elastic(body_in(first)):
            first, second = second, first
        body = body_in(second)
        elastic, loops = self.is_elastic(body), named_loops(self.boundary_of(body), body)
        held = {name for name in self._held_edges() if elastic} if second == (body,) else set[str]()
        touched = tuple(
            edge
            for loop in loops
            for edge in loop
            if (edge.name in second or second == (body,)) and edge.name not in held
        )
        surface = BodySurface(body=body, elastic=elastic, edges=touched, loops=loops, offset=gap)
        edges, own_loops = tuple(first), named_loops(self.boundary_of(body_in(first)), body_in(first))
        if first == (body_in(first),):
            lines = [edge for loop in own_loops for edge in loop]
            edges = tuple(name for name in edges_that_see(lines, surface) if name not in self._held_edges())
        if elastic:
            own = tuple(edge for edge in self.edges if edge.name in edges)
            share = self._share_of_first(body_in(first), body)
            flat = [rests_on_flat(touched, own), rests_on_flat(own, touched)]
            share = float(flat[0]) if flat[0] != flat[1] else share
            surface = replace(surface, share=share, first=own, first_loops=own_loops)
        return BodyZone(edges=edges, surface=surface)

    def _share_of_first(self, first: str, second: str) -> float:
        """Part that the first of two elastic bodies has in common normals, unless a flat side lies on another one.

        A body that may spin has some part of them: else no slope would hold it along a plane that is much stiffer.
        """
        moduli = [self._material(name).contact_modulus for name in (first, second)]
        least, most = (LEAST_SHARE * (self._spin_center(name) is not None) for name in (first, second))
        return min(max(moduli[0] / sum(moduli), least), 1 - most)

    @property
    def spin_centers(self) -> Mapping[str, Point]:
        """Centers [L] of the elastic bodies that may spin and touch others: no pressure without friction spins them."""
        if not self.contacts:
            return {}
        both = [[body_in(side) for side in contact.between] for contact in self.contacts.values()]
        touching = dict.fromkeys(name for pair in both if all(map(self.is_elastic, pair)) for name in pair)
        centers = {name: self._spin_center(name) for name in touching}
        return {name: center for name, center in centers.items() if center is not None}

    def _spin_center(self, body: str) -> Point | None:
        """Center [L] of a body that is not held and may touch with circles about one point only; else None.

        Springs across a circle about this point hold no spin.
        """
        contacts, bonds = ([*pairs] for pairs in ((c.between for c in self.contacts.values()), self.bonded.values()))
        sides = [side for pair in contacts for side in pair if body_in(side) == body]
        pairs = [{*map(body_in, pair)} for pair in contacts]
        others = [self.boundary_of(other) for pair in pairs if body in pair for other in pair - {body}]
        bonded = any(body_in(side) == body for pair in bonds for side in pair)
        conditions = {qualified(body, name): condition for name, condition in self.bodies[body].conditions.items()}
        held = any(condition.displacement.given for condition in conditions.values())
        held |= any(
            condition.displacement.given and self.part_of(edge) == body
            for case in self.load_cases.values()
            for edge, condition in case.conditions.items()
        )
        zones = {edge for zone in self.contact_zones.values() for edge in zone.edges or (body,)}
        touching = {name for side in sides for name in side} | zones
        springs = {name: condition.spring for name, condition in conditions.items() if condition.spring is not None}
        held |= any(spring.given != ("normal",) for spring in springs.values())
        outer, *holes = named_loops(self.boundary_of(body), body)
        smaller = [np.mean(other.box, axis=0) for other in others if other.size < self.boundary_of(body).size]
        around = [hole for hole in holes if any(in_box(hole, middle) for middle in smaller)]
        curves = [
            edge.curve
            for loop in (outer, *holes)
            for edge in loop
            if edge.name in springs
            or (body in touching and loop in (outer, *around))
            or any(other.name in touching for other in loop)
        ]
        arcs = [curve for curve in curves if isinstance(curve, CircularArc)]
        if held or bonded or not arcs or len(arcs) < len(curves):
            return None
        radius = max(max(arc.radii) for arc in arcs)
        x, y = np.mean([arc.center for arc in arcs], axis=0).tolist()
        return (x, y) if np.ptp([arc.center for arc in arcs], axis=0).max() <= SAME_CIRCLE * radius else None

    def on_contacts_of(self, other: Self) -> Self:
        """Copy whose bodies form the pairs that they form in another problem with the same boundaries and contacts.

        Common normals depend on the moduli of both bodies. What is differentiated or followed keeps its pairs, and
        rigid surfaces stay where they came to be touched.
        """
        problem = self.model_copy()
        zones: dict[str, ContactZone | BodyZone] = {}
        for name, zone in self.contact_zones.items():
            surface = other.zones[name].surface
            zones[name] = zone if isinstance(surface, DeflectedContour) else zone.after(surface.way)
        for name, contact in self.contacts.items():
            zone = other.zones[name]
            assert isinstance(zone, BodyZone)
            zones[name] = replace(zone, surface=replace(zone.surface, offset=contact.gap))
        problem._zones, problem._opposite, problem._bonds = zones, other._opposite, dict(other.bonds)
        problem._ways = other._ways
        return problem

    def after_motions(self, motions: Mapping[str, Way], case: str | None = None) -> Self:
        """Copy after motions of the second body, or of a rigid surface, beside the first one, by zone.

        Where a load case is named, rigid surfaces have them where it acts.
        """
        problem = self.model_copy()
        if case is not None:
            problem._ways = {**self._ways, case: {**self._ways.get(case, {}), **motions}}
            return problem
        problem._zones = {
            name: zone.after(motions[name]) if name in motions else zone for name, zone in self.zones.items()
        }
        problem._opposite = {name: parts for name, parts in self._opposite.items() if name not in motions}
        return problem

    def opposite_edges(self, contact: str) -> tuple[str, ...]:
        """Names of the edges of the second elastic body of a contact that the first one may touch; none of others."""
        surface = self.zones[contact].surface
        if not isinstance(surface, BodySurface) or not surface.elastic:
            return ()
        return tuple(dict.fromkeys(surface.edges[part.onto].name for part in self.opposite(contact)))

    def bonded_edges(self, bond: str) -> tuple[str, ...]:
        """Names of the edges of both sides of a bonded interface."""
        zone = self.bonds[bond]
        return (*zone.edges, *(edge.name for edge in zone.surface.edges))

    def _held_edges(self) -> set[str]:
        """Names of the edges with a condition, in the problem or in a load case, and of bonded ones."""
        bonded = {name for sides in self.bonded.values() for side in sides for name in side}
        return {*self.edge_conditions, *bonded}.union(*(case.conditions for case in self.load_cases.values()))

    def reach_of(self, contact: str) -> float:
        """Gap beside the nearest place [L] up to which a body may meet another one; infinite for stated edges of it.

        Not where these would reach so far that other edges are opposite to the same part of the second body.
        """
        if contact not in self.contacts:
            return np.inf
        first, second = self.contacts[contact].between
        if SEPARATOR in (first if self.is_elastic(body_in(first)) else second)[0] and not self._crowded(contact):
            return np.inf
        originals = (self.bodies[body].copy_of or body for body in self.sides_of(contact))  # a box depends on the turn
        return REACH * min(self.boundary_of(body).size for body in originals)

    def _crowded(self, contact: str) -> bool:
        """Whether edges of a contact are opposite to a part of the second body to which edges of others are, too."""
        own = [*self._seen(contact)]
        others = [part for name in self.contacts if name != contact for part in self._seen(name)]
        return any(
            onto == theirs and edge != other and low < end - SAME_PART and start < high - SAME_PART
            for edge, onto, low, high in own
            for other, theirs, start, end in others
        )

    def _seen(self, contact: str) -> Iterator[tuple[str, str, float, float]]:
        """Parts that are opposite to another elastic body at any distance: edges of both, fractions of the second."""
        surface = self.zones[contact].surface
        if not (isinstance(surface, BodySurface) and surface.elastic):
            return
        for part in opposite_parts([self.edge(name) for name in self.edges_of(contact)], surface):
            edge, onto = self.edge(part.edge), surface.edges[part.onto]
            at = np.array([part.low, part.high])
            low, high = sorted(onto.curve.nearest(surface.pairs(edge.points(at), -edge.normals(at)).points).tolist())
            yield part.edge, onto.name, low, high

    def opposite(self, contact: str) -> tuple[OppositePart, ...]:
        """Parts of the edges of the first body that are opposite to the second one of a contact, or of a bond."""
        if contact not in self._opposite:
            edges, zone = {edge.name: edge for edge in self.edges}, self.bonds.get(contact, None)
            names = self.edges_of(contact) if zone is None else zone.edges
            surface = (zone or self.zones[contact]).surface
            assert isinstance(surface, BodySurface)
            parts = opposite_parts([edges[name] for name in names], surface, self.reach_of(contact))
            self._opposite[contact] = tuple(parts)
        return self._opposite[contact]

    def edges_of(self, zone: str) -> tuple[str, ...]:
        """Names of the edges that may touch the surface of a contact zone.

        Parameters
        ----------
        zone : name of the zone
        """
        known = self._known("_edges")
        if zone not in known:
            known[zone] = zone_edges(self.edges, self.zones[zone], self._held_edges())
        return known[zone]

    def edge(self, name: str) -> Edge:
        """Edge with a name; `ProblemError` if there is none."""
        text_of_argument(name, "the name of an edge")
        for edge in self.edges:
            if edge.name == name:
                return edge
        known = [edge.name for edge in self.edges]
        path = ("bodies",) if self.several else ("boundary",)
        raise ProblemError(Issue(path=path, message=unknown_edge(name, known)))

    def _boundary_path(self, body: str) -> KeyPath:
        """Key path of the boundary of a body."""
        return ("bodies", body, "boundary") if body else ("boundary",)

    def _with_boundaries(self, boundaries: Mapping[str, Boundary], **others: Any) -> Self:
        """Copy with other elements on the boundaries of the elastic bodies, and other values."""
        if not self.bodies:
            return self.model_copy(update={"boundary": boundaries[""], **others})
        bodies = {
            name: with_boundary(body, boundaries[name], self.bodies[body.copy_of or name].material)
            if name in boundaries
            else body
            for name, body in self.bodies.items()
        }
        return self.model_copy(update={"bodies": bodies, **others})
