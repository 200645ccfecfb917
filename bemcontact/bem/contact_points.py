"""The contact points of a mesh: pairs (zone, node) with their gaps, normals and weights."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from bemcontact.arrays import Array, BoolArray, IntArray
from bemcontact.bem import reference_element
from bemcontact.bem.mesh import BoundaryValues, Mesh, MeshPart
from bemcontact.bem.outline import Outline
from bemcontact.bem.unit_pressures import UnitPressures
from bemcontact.errors import Issue, ProblemError
from bemcontact.problems.body_surface import AnySurface, BodySurface
from bemcontact.problems.problem import Problem
from bemcontact.problems.rigid_surface import DeflectedContour
from bemcontact.problems.surface_lines import Faces
from bemcontact.problems.visibility import turned_to

PARALLEL = 1e-9
"""Sine of the angle below which the rigid normal lies along a prescribed axis."""
ALIKE = 1e-9
"""Difference of two normals, or of two gaps over the size of the body, at one node that counts as none."""
SMOOTH = 0.05
"""Sine of the angle between elements below which the boundary is smooth: quadratic elements on a curve kink a bit."""
CONSISTENT_ORDER = 12
"""Gauss points for the consistent weights."""


class Opposite(NamedTuple):
    """The other elastic body at contact points.

    Parameters
    ----------
    node : (n,) its node at each point; -1 where the surface is rigid
    share : (q,) shares of points whose element faces one of the other body
    element, local : (q,) the (element, local node) pair that this share faces
    traction : (q, 2) there by a unit pressure: the nodal forces of both bodies are equal and opposite
    """

    node: IntArray
    share: IntArray
    element: IntArray
    local: IntArray
    traction: Array


@dataclass(frozen=True, kw_only=True, eq=False)
class ContactPoints:
    """Candidates for contact, zone by zone, run by run, along the boundary.

    A node is no candidate if a condition prescribes its motion along the normal, and that of the other body if this is
    elastic; its pressure is zero. Contact may continue smoothly beyond such a node, as at the tip of a closed slit. The
    end node then has the pressure of the middle node of the element, whose tributary length includes that of the end
    node.

    So it is where a bond begins. The gap of this node is zero whatever the pressure is, so that it would be no unknown
    of a complementarity problem with one solution. The traction of the bond is another one, on its own elements: beside
    a debond it is infinite, with shear alone if the debond is closed.

    Parameters
    ----------
    mesh : Mesh
    node : (n,) node of each point
    zone : (n,) number of its zone
    run : (n,) number of the unbroken piece of boundary it is on
    arc_position : (n,) arc length along that piece [L]
    run_length : (runs,) perimeter of a piece that closes on itself, else infinity [L]
    normals : (n, 2) of the rigid surface, into the body; common ones of two elastic bodies, into the first
    faces : (n, 2) normals of the faces of the surface, as in `Faces`
    gap : (n,) ε [L]
    element, local, point : (q,) the (element, local node) pairs that carry the pressure of each point
    sense : (q,) -1 where this pair belongs to a contact that states the two bodies the other way round, else 1
    held_arc : (runs, 2) arc position of the first and the last node of a piece if a condition holds it on the rigid
        surface, else not a number [L]
    held_points : (runs, 2, 2) these nodes [L]
    tied : (N,) for each node the least of all that bonds make move with it
    bonded_ends : (runs, 2) whether a bond begins at the first and the last node of a piece
    elements_of_run : elements of each piece in order; none for a corner of the body that stands on a face by itself
    zone_of_run : number of the zone of each piece
    held : nodes of the zones that are no points
    facing : (m,) by number of the zone, element of the other elastic body opposite to each element, else -1
    """

    mesh: Mesh
    node: IntArray
    zone: IntArray
    run: IntArray
    arc_position: Array
    run_length: Array
    normals: Array
    faces: Array
    gap: Array
    element: IntArray
    local: IntArray
    point: IntArray
    sense: Array
    held_arc: Array
    held_points: Array
    tied: IntArray
    bonded_ends: BoolArray
    elements_of_run: tuple[IntArray, ...] = ()
    zone_of_run: tuple[int, ...] = ()
    held: "HeldNodes | None" = None
    facing: Mapping[int, IntArray] = field(default_factory=dict)

    @cached_property
    def opposite(self) -> Opposite:
        """The other elastic body at the points.

        What contacts with equal sides share of a point has one pressure on each body, also across two bonded ones.
        """
        node, facing = np.full(len(self), -1), np.full(len(self.point), -1)
        for zone, elements in self.facing.items():
            own = self.zone_of_share == zone
            facing[own] = elements[self.element[own]]
        share = np.flatnonzero(facing >= 0)
        element, local, point = facing[share], 2 - self.local[share], self.point[share]
        turned = (self.sense < 0).astype(int)
        own = self.mesh.elements[self.element[share], self.local[share]]
        straight = (turned[share] == 0) & (self.tied[own] == self.tied[self.node[point]])
        node[point[straight]] = self.mesh.elements[element, local][straight]
        lengths, opposite = np.zeros((2, 2, len(self)))
        np.add.at(lengths, (turned, self.point), self.mesh.tributary[self.element, self.local])
        np.add.at(opposite, (turned[share], point), self.mesh.tributary[element, local])
        factor = self.sense[share] * (lengths / np.where(opposite, opposite, 1.0))[turned[share], point]
        return Opposite(node, share, element, local, -factor[:, None] * self.normals[point])

    @property
    def tractions(self) -> Array:
        """Traction (q, 2) by a unit pressure on each share."""
        return self.sense[:, None] * self.normals[self.point]

    @cached_property
    def moved(self) -> tuple[IntArray, IntArray, Array]:
        """Nodes (r,) whose displacement changes a gap, numbers (r,) of the points, and the change (r, 2) by it.

        Bonded nodes that share a point count in proportion to the forces on them: then pressure and gap do the same
        work in any motion, also in one that would part them.
        """
        other = self.opposite
        has = np.flatnonzero(other.node >= 0)
        node, gap = np.concatenate([self.node, other.node[has]]), np.concatenate([np.arange(len(self)), has])
        change = np.concatenate([self.normals, -self.normals[has]])
        element, local = np.append(self.element, other.element), np.append(self.local, other.local)
        point, at = np.append(self.point, self.point[other.share]), self.mesh.elements[element, local]
        far = np.where(other.node >= 0, other.node, self.node)
        sides = np.column_stack([self.node, far])[point]
        bonded = (at[:, None] != sides).all(axis=1) & (self.tied[at][:, None] == self.tied[sides]).any(axis=1)
        shared = np.zeros(len(self), bool)
        shared[point[bonded]] = True
        forces = self.mesh.tributary[element, local, None] * np.concatenate([self.tractions, other.traction])
        own, still = shared[point], ~shared[gap]
        return (
            np.append(node[still], at[own]),
            np.append(gap[still], point[own]),
            np.concatenate([change[still], forces[own] / self.tributary[point[own], None]]),
        )

    @cached_property
    def unit_pressures(self) -> tuple[UnitPressures, ...]:
        """Unit pressures on the mesh of each of the bodies."""
        return tuple(map(self._unit_pressures, self.mesh.parts))

    def _unit_pressures(self, part: MeshPart) -> UnitPressures:
        """Unit pressures on the mesh of one of the bodies."""
        other, m = self.opposite, len(self.mesh.elements)
        element, local, point = (
            np.concatenate(both)
            for both in (
                (self.element, other.element), (self.local, other.local), (self.point, self.point[other.share]),
            )
        )  # fmt: skip
        traction = np.concatenate([self.tractions, other.traction])
        node, gap, change = self.moved
        new = np.full(len(self.mesh.nodes), -1)
        new[part.nodes] = np.arange(len(part.mesh.nodes))
        elements = np.arange(m)[part.elements]
        own, seen = (element >= elements[0]) & (element <= elements[-1]), new[node] >= 0
        number, pressure = np.unique(point[own], return_inverse=True)
        return UnitPressures(
            number=number, element=element[own] - elements[0], local=local[own], pressure=pressure,
            traction=traction[own], node=new[node[seen]], gap=gap[seen], change=change[seen],
        )  # fmt: skip

    def __len__(self) -> int:
        """Return the number of points."""
        return len(self.node)

    @cached_property
    def in_zone(self) -> BoolArray:
        """Whether each element (m,) carries the pressure of a point."""
        in_zone = np.zeros(len(self.mesh.elements), bool)
        in_zone[self.element] = True
        return in_zone

    @cached_property
    def zone_of_share(self) -> IntArray:
        """Number of the zone of each share of a point, an (element, local node) pair: that of its element.

        A node between two zones on one face is a point of the first of them, and acts on the elements of both. The
        last node that is turned to the surface of a zone acts on the element beyond, which may be one of another zone
        that has a point at this node too.
        """
        zones = self.zone[self.point]
        has = np.zeros((max(self.zone, default=0) + 1, len(self.mesh.elements), 3), bool)
        has[zones, self.element, self.local] = True
        middle = has[:, self.element, 1]
        other = middle.argmax(axis=0)
        own = middle[zones, np.arange(len(zones))] | ~middle.any(axis=0) | has[other, self.element, self.local]
        return np.where(own, zones, other)

    def tributary_by_zone(self, zones: int) -> Array:
        """(zones, n) [L]: the parts of the tributary lengths in each zone, negative with the sides exchanged."""
        lengths = np.zeros((zones, len(self)))
        signed = self.sense * self.mesh.tributary[self.element, self.local]
        np.add.at(lengths, (self.zone_of_share, self.point), signed)
        return lengths

    @cached_property
    def tributary(self) -> Array:
        """(n,) [L]: Σ over elements of (1/3, 4/3, 1/3) |dx/dξ|."""
        return np.bincount(self.point, self.mesh.tributary[self.element, self.local], len(self)).astype(float)

    @cached_property
    def element_length(self) -> Array:
        """(n,) [L]: length of the element, the mean of the two where a node has two; [SS92] (26) taken literally."""
        lengths = self.mesh.lengths[self.element]
        return np.bincount(self.point, lengths, len(self)) / np.bincount(self.point, minlength=len(self))

    @cached_property
    def consistent(self) -> Array:
        """(n, n) [L]: Σ over elements of ∫ h hᵀ |dx/dξ| dξ, [SS92] (24)-(25)."""
        xi, weights = reference_element.gauss_legendre(CONSISTENT_ORDER)
        N, tangents = reference_element.values(xi), self.mesh.tangents_at(xi)
        jacobian = np.hypot(tangents[..., 0], tangents[..., 1])
        local = np.einsum("gk,gl,mg,g->mkl", N, N, jacobian, weights)
        owner = np.full((max(self.zone, default=0) + 1, len(self.mesh.elements), 3), len(self))  # else one too many
        owner[self.zone_of_share, self.element, self.local] = self.point
        of_zone, element = np.nonzero((owner < len(self)).any(axis=2))
        i, J = owner[of_zone, element], np.zeros((len(self) + 1, len(self) + 1))
        np.add.at(J, (i[:, :, None], i[:, None, :]), local[element])
        return J[:-1, :-1]


def contact_points(
    outline: Outline,
    values: BoundaryValues,
    deflections: Mapping[str, Array],
    cases: Sequence[BoundaryValues] = (),
) -> ContactPoints:
    """List the contact points of all zones.

    `deflections` has the displacement (N, 2) [L] of the nodes by zone, for zones on a deflected contour. `cases` has
    what load cases prescribe in addition to `values`.

    A node in several zones is a point of those only to whose surfaces it is turned: normals that oppose one another
    would make the compliance singular.
    """
    problem, mesh, halves = outline.problem, outline.mesh, outline.mesh.halves
    tool_of = {zone: tool for tool, stated in problem.tools.items() for zone in stated.zones}
    pieces: list[_Piece] = []
    in_zones, has = outline.in_zones, np.zeros((len(problem.zones), len(mesh.nodes)), bool)
    of_zone, element = np.nonzero(in_zones)
    has[of_zone[:, None], mesh.elements[element]] = True
    choice = has.sum(axis=0) > 1
    middles, tied = mesh.elements[:, 1], _tied(problem, mesh)
    for number, (name, zone) in enumerate(problem.zones.items()):
        in_zone, faces = in_zones[number], _faces(outline, zone.surface, deflections.get(name))
        other = isinstance(zone.surface, BodySurface) and zone.surface.elastic
        across = _across(mesh, mesh.facing.get(name))
        apart = across.min(axis=0) >= 0
        apart[apart] = tied[across[0, apart]] != tied[across[1, apart]]
        for elements, closed in _between(mesh, runs(mesh, in_zone), faces.differs[:, 0] | apart):
            nodes, arc = _nodes_along(mesh, halves, elements, closed=closed)
            gap, normals, lies = faces.along(nodes, closed=closed)
            opposite = _along(across, nodes, closed=closed)
            bonded = (opposite >= 0) & (tied[nodes] == tied[opposite])
            given = values.displacement_given
            across_held = (opposite < 0) | _held_along(normals, given[opposite])  # else the other body comes up to it
            loose = ~(_held_along(normals, given[nodes]) & across_held) & ~bonded
            free = loose & ~(choice[nodes] & ~faces.turned(mesh, elements, closed=closed))
            length = arc[-1] + halves[elements[-1], 1] if closed else np.inf
            fixed = not closed and name not in tool_of and not other
            stuck = ~loose & ~bonded
            on_surface = _on_surface(mesh, (values, *cases), nodes, normals, gap)
            goes_on = _goes_on(mesh, values, elements, normals, on_surface) if fixed else (False, False)
            at_bond = bonded[[0, -1]] & (not closed)
            held = np.where((~loose & on_surface & fixed) | (bonded & on_surface), arc, np.nan)[[0, -1]]
            pieces.append(
                _Piece(
                    number, tool_of.get(name), elements, elements, length, goes_on, at_bond, nodes[free], arc[free],
                    normals[free], lies[free], gap[free], opposite[free], held, mesh.nodes[nodes[[0, -1]]],
                    HeldNodes(np.full(len(nodes), number)[stuck], nodes[stuck], normals[stuck], gap[stuck]),
                )
            )  # fmt: skip
        if not any(len(piece.nodes) for piece in pieces if piece.zone == number) and (in_zone & choice[middles]).any():
            message = "no node of its edges is turned to the surface; give these edges more elements"
            raise ProblemError(Issue(path=("contact_zones", name, "edges"), message=message))
        pieces += _standing(mesh, number, tool_of.get(name), in_zone, faces, across, values.displacement_given, tied)
    facing = {number: mesh.facing[name] for number, name in enumerate(problem.zones) if name in mesh.facing}
    return replace(_joined(mesh, pieces, tied), facing=facing)


def _tied(problem: Problem, mesh: Mesh) -> IntArray:
    """For each node (N,) the least of all nodes that bonds make move with it."""
    tied = np.arange(len(mesh.nodes))
    first, second = np.zeros((2, 0), int)
    for facing in (mesh.facing[name] for name in problem.bonded):
        own = facing >= 0
        first = np.append(first, mesh.elements[own])
        second = np.append(second, mesh.elements[facing[own], ::-1])
    while len(first) and (tied[first] != tied[second]).any():
        least = np.minimum(tied[first], tied[second])
        np.minimum.at(tied, first, least)
        np.minimum.at(tied, second, least)
    return tied


def _across(mesh: Mesh, facing: IntArray | None) -> IntArray:
    """Node of the other body opposite to each node (2, N), on the element before it and on the one after; else -1."""
    across = np.full((2, len(mesh.nodes)), -1)
    if facing is not None:
        own = np.flatnonzero(facing >= 0)
        start, middle, end = mesh.elements[own].T
        theirs = mesh.elements[facing[own]]
        across[1, start], across[:, middle], across[0, end] = theirs[:, 2], theirs[:, 1], theirs[:, 0]
    return across


def _along(across: IntArray, nodes: IntArray, *, closed: bool) -> IntArray:
    """Opposite nodes of those (k,) of a piece in order, on the side of each which is on the piece."""
    side = np.ones(len(nodes), int)
    side[-1] = 1 if closed else 0
    return across[side, nodes]


class HeldNodes(NamedTuple):
    """Nodes (h,) that prescribed displacements hold along the normal of the surface: zone, normals (h, 2), ε [L]."""

    zone: IntArray
    node: IntArray
    normals: Array
    gap: Array


class _NodeFaces(NamedTuple):
    """`Faces` before, at and after each node (N,); whether the sides differ."""

    gap: Array
    normals: Array
    faces: Array
    differs: BoolArray

    def along(self, nodes: IntArray, *, closed: bool) -> tuple[Array, Array, Array]:
        """Gap, normals and faces at the nodes of a piece in order, of that side of each which is on the piece."""
        side = np.full(len(nodes), 2)
        side[-1] = 2 if closed else 0
        return self.gap[nodes, side], self.normals[nodes, side], self.faces[nodes, side]

    def turned(self, mesh: Mesh, elements: IntArray, *, closed: bool) -> BoolArray:
        """Whether a side of each node of a piece, on its elements in order, is turned to the face there."""
        at_start, at_middle, at_end = (
            turned_to(-mesh.normals[elements, local], self.normals[mesh.elements[elements, local], side])
            for local, side in enumerate((2, 2, 0))
        )
        start = np.append(at_start, False) | np.append(False, at_end)
        if closed:
            start = at_start | np.roll(at_end, 1)
        nodes = np.zeros(2 * len(elements) + (not closed), bool)
        nodes[0::2], nodes[1::2] = start, at_middle
        return nodes


def _faces(outline: Outline, surface: AnySurface, deflection: Array | None) -> _NodeFaces:
    """Faces of a surface at all nodes, or of the deflected contour."""
    if isinstance(surface, DeflectedContour):
        assert deflection is not None
        gap, normals = (np.repeat(part[:, None], 3, axis=1) for part in surface.behind(deflection))
        held = Faces(gap, normals, normals)
    else:
        held = surface.faces(outline.mesh.nodes, *outline.sides)
    other = np.hypot(*np.moveaxis(held.normals - held.normals[:, [2, 0, 0]], 2, 0)) > ALIKE
    return _NodeFaces(*held, other | (abs(held.gap - held.gap[:, [2, 0, 0]]) > ALIKE * outline.mesh.size))


def _between(mesh: Mesh, runs: Iterable[tuple[IntArray, bool]], divides: BoolArray) -> Iterator[tuple[IntArray, bool]]:
    """Divide runs at nodes (N,) that two faces of the surface hold, or that have two opposite nodes."""
    for elements, closed in runs:
        corner = divides[mesh.elements[elements, 0]]
        if closed and corner.any():
            first = int(np.argmax(corner))
            elements, corner, closed = np.roll(elements, -first), np.roll(corner, -first), False
        for piece in np.split(elements, np.flatnonzero(corner[1:]) + 1):
            yield piece, closed


def _standing(
    mesh: Mesh, zone: int, tool: str | None, in_zone: BoolArray, faces: _NodeFaces, across: IntArray, given: BoolArray,
    tied: IntArray,
) -> Iterator["_Piece"]:  # fmt: skip
    """Corners of the body that stand on a face of the surface to which neither side of them is turned."""
    for node in np.flatnonzero(faces.differs[: len(mesh.elements), 1] & (in_zone | in_zone[mesh.before])):
        elements = np.array([element for element in (mesh.before[node], node) if in_zone[element]])
        normals, nodes = faces.normals[[node], 1], np.array([node])
        opposite = across.max(axis=0)[node]
        bonded = opposite >= 0 and tied[node] == tied[opposite]
        if not (bonded or _held_along(normals, given[nodes])[0]):
            yield _Piece(
                zone, tool, elements, elements[:0], np.inf, (False, False), np.zeros(2, bool), nodes, np.zeros(1),
                normals, normals, faces.gap[[node], 1], np.array([opposite]), np.full(2, np.nan),
                mesh.nodes[[node, node]], None,
            )  # fmt: skip


def _on_surface(mesh: Mesh, values: Sequence[BoundaryValues], nodes: IntArray, normals: Array, gap: Array) -> BoolArray:
    """Whether prescribed displacements put nodes on the rigid surface, and no load case moves them off it."""
    moved = [np.sum(normals * item.displacement[nodes], axis=1) for item in values]
    return np.all(np.abs([gap + moved[0], *moved[1:]]) <= ALIKE * mesh.size, axis=0)


def _goes_on(
    mesh: Mesh, values: BoundaryValues, elements: IntArray, normals: Array, on_surface: BoolArray
) -> tuple[bool, bool]:
    """Whether contact continues beyond each end of a run, on an element that a condition holds."""
    first, after = elements[0], mesh.elements[elements[-1], 2]  # an element has the number of its start node
    here, beyond = np.array([first, after]), np.array([mesh.before[first], after])
    smooth = abs(mesh.turns[here]) < SMOOTH
    start, end = smooth & on_surface[[0, -1]] & _held_along(normals[[0, -1]], values.traction_unknown[beyond])
    return bool(start), bool(end)


class _Piece(NamedTuple):
    """One run: zone, tool, elements beside its points and its own, length, what is beyond its ends, points, held ends.

    Points have the opposite node too, -1 on a rigid surface.
    """

    zone: int
    tool: str | None
    elements: IntArray
    own: IntArray
    length: float
    goes_on: tuple[bool, bool]
    bonded: BoolArray
    nodes: IntArray
    arc: Array
    normals: Array
    faces: Array
    gap: Array
    opposite: IntArray
    held_arc: Array
    held_points: Array
    held: HeldNodes | None


def _joined(mesh: Mesh, pieces: list[_Piece], tied: IntArray) -> ContactPoints:
    """Join all runs, and find the (element, local node) pairs of every point."""
    sizes = [len(piece.nodes) for piece in pieces]
    node, normals, gap, opposite = (
        np.concatenate([getattr(piece, name) for piece in pieces]) for name in ("nodes", "normals", "gap", "opposite")
    )
    tool = [piece.tool for piece, size in zip(pieces, sizes, strict=True) for _ in range(size)]
    sides = np.column_stack([tied[node], np.where(opposite >= 0, tied[opposite], -1)])
    first_alike = _first_alike(mesh, sides, normals, gap, tool)
    own = first_alike == np.arange(len(node))
    sense = np.where(np.sum(normals * normals[first_alike], axis=1) < 0, -1.0, 1.0)
    number = np.where(first_alike < 0, -1, (np.cumsum(own) - 1)[first_alike])
    elements, points, senses = [], [], []
    held_arc = np.array([piece.held_arc for piece in pieces])
    held_points = np.array([piece.held_points for piece in pieces])
    for row, (first, piece) in enumerate(zip(np.cumsum([0, *sizes]), pieces, strict=False)):
        for end, i in enumerate((0, len(piece.nodes) - 1) if len(piece.nodes) else ()):
            if first_alike[first + i] not in (-1, first + i):  # a point of another zone, up to which contact goes on
                held_arc[row, end], held_points[row, end] = piece.arc[i], mesh.nodes[piece.nodes[i]]
        point_of = np.full(len(mesh.nodes), -1)
        point_of[piece.nodes] = number[first : first + len(piece.nodes)]
        sense_of = np.ones(len(mesh.nodes))
        sense_of[piece.nodes] = sense[first : first + len(piece.nodes)]
        carrier, signs = point_of[mesh.elements[piece.elements]], sense_of[mesh.elements[piece.elements]]
        beyond = piece.bonded | piece.goes_on
        for goes_on, element, end in zip(beyond.tolist(), (0, -1), (0, 2), strict=True):
            if goes_on:
                carrier[element, end] = carrier[element, 1]
        elements.append(np.repeat(piece.elements, 3))
        points.append(carrier.ravel())
        senses.append(signs.ravel())
    triples = np.column_stack(
        [np.concatenate(elements), np.tile(np.arange(3), sum(map(len, elements)) // 3), np.concatenate(points)]
    )
    code = (triples[:, 0] * 3 + triples[:, 1]) * (len(node) + 1) + triples[:, 2] + 1
    once = np.sort(np.unique(code, return_index=True)[1])  # zones that share an edge and a face share its points
    once = once[triples[once, 2] >= 0]
    element, local, point = triples[once].T
    return ContactPoints(
        mesh=mesh,
        node=node[own],
        zone=np.repeat([piece.zone for piece in pieces], sizes)[own],
        run=np.repeat(np.arange(len(pieces)), sizes)[own],
        arc_position=np.concatenate([piece.arc for piece in pieces])[own],
        run_length=np.array([piece.length for piece in pieces]),
        normals=normals[own],
        faces=np.concatenate([piece.faces for piece in pieces])[own],
        gap=gap[own],
        element=element,
        local=local,
        point=point,
        sense=np.concatenate(senses)[once],
        held_arc=held_arc,
        held_points=held_points,
        tied=tied,
        bonded_ends=np.array([piece.bonded for piece in pieces]),
        elements_of_run=tuple(piece.own for piece in pieces),
        zone_of_run=tuple(piece.zone for piece in pieces),
        held=HeldNodes(*map(np.concatenate, zip(*(piece.held for piece in pieces if piece.held), strict=True))),
    )


def _first_alike(mesh: Mesh, sides: IntArray, normals: Array, gap: Array, tool: Sequence[str | None]) -> IntArray:
    """The first point (n,) with the same nodes, normal, gap and tool, which contacts that meet on one surface share.

    Nodes (n, 2) on both sides are one if they move together. Two contacts may state the sides the other way round. It
    is -1 for a point that another one with a smaller gap keeps from touching.
    """
    first, (low, high) = np.arange(len(sides)), np.sort(sides, axis=1).T
    _, place = np.unique(low * len(mesh.nodes) + high, return_inverse=True)
    for j in np.flatnonzero(np.bincount(place)[place] > 1).tolist():
        same = [i for i in np.flatnonzero(place == place[j]).tolist() if tool[i] == tool[j]]
        turned = {i: 1.0 if sides[i, 0] == sides[j, 0] else -1.0 for i in same}
        same = [i for i in same if np.hypot(*(normals[i] - turned[i] * normals[j])) <= ALIKE]
        least = min(gap[i] for i in same)
        if gap[j] <= least + ALIKE * mesh.size:
            first[j] = next(i for i in same if gap[i] <= least + ALIKE * mesh.size)
        else:
            first[j] = -1
    return first


def runs(mesh: Mesh, in_zone: BoolArray) -> Iterator[tuple[IntArray, bool]]:
    """Unbroken pieces of a zone: their elements in order, and whether the piece closes on itself."""
    after = mesh.elements[:, 2]
    before = mesh.before
    left = in_zone.copy()
    starts = [*np.flatnonzero(in_zone & ~in_zone[before]), *np.flatnonzero(in_zone)]
    for start in starts:
        if not left[start]:
            continue
        run, element = [], start
        while left[element]:
            left[element] = False
            run.append(element)
            element = after[element]
        yield np.array(run), bool(element == start)


def _nodes_along(mesh: Mesh, halves: Array, elements: IntArray, *, closed: bool) -> tuple[IntArray, Array]:
    """Nodes of a run in order, and the arc length up to each."""
    nodes = np.append(mesh.elements[elements, :2].ravel(), mesh.elements[elements[-1], 2])
    arc = np.append(0.0, np.cumsum(halves[elements].ravel()))
    return (nodes[:-1], arc[:-1]) if closed else (nodes, arc)


def _held_along(normals: Array, given: BoolArray) -> BoolArray:
    """Whether prescribed displacements (n, 2) span the normal."""
    return np.all((abs(normals) <= PARALLEL) | given, axis=1)
