"""The search for contact points: nodes of the zones that may touch, piece by piece along the boundary."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from bemcontact.arrays import Array, BoolArray, IntArray, magnitudes
from bemcontact.bem.boundary_values import BoundaryValues
from bemcontact.bem.contact_points import ALIKE, SMOOTH, ContactPoints, HeldNodes
from bemcontact.bem.mesh import Mesh, runs
from bemcontact.bem.outline import Outline
from bemcontact.errors import Issue, ProblemError
from bemcontact.problems.body_surface import AnySurface, BodySurface
from bemcontact.problems.curves import cross
from bemcontact.problems.problem import Problem
from bemcontact.problems.rigid_surface import DeflectedContour
from bemcontact.problems.surface_lines import Faces
from bemcontact.problems.visibility import turned_to

PARALLEL = 1e-9
"""Sine of the angle below which the rigid normal lies along a prescribed axis."""


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
    middles, tied, kinds = mesh.elements[:, 1], _tied(problem, mesh), _kinds(problem, mesh)
    for number, (name, zone) in enumerate(problem.zones.items()):
        in_zone, faces = in_zones[number], _faces(outline, zone.surface, deflections.get(name))
        other = isinstance(zone.surface, BodySurface) and zone.surface.elastic
        across = _across(mesh, mesh.facing.get(name))
        apart = across.min(axis=0) >= 0
        one, two = across[:, apart]
        apart[apart] = (tied[one] != tied[two]) | (kinds[one] != kinds[two])
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
    return replace(_joined(mesh, pieces, tied, kinds), facing=facing)


def _kinds(problem: Problem, mesh: Mesh) -> IntArray:
    """Number of the material and the heat at each node (N,): stress jumps where a bond joins bodies of other ones."""
    heats = zip(*([loads.temperature for loads in each] for each in problem.volume_loads), strict=True)
    of_parts = [(part.material, heat) for part, heat in zip(problem.parts, heats, strict=True)]
    kinds = np.zeros(len(mesh.nodes), int)
    for part, kind in zip(mesh.parts, of_parts, strict=True):
        kinds[part.nodes] = of_parts.index(kind)
    return kinds


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
        held = outline.held_nodes(surface)
    other = magnitudes(held.normals - held.normals[:, [2, 0, 0]]) > ALIKE
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


def _joined(mesh: Mesh, pieces: list[_Piece], tied: IntArray, kinds: IntArray) -> ContactPoints:
    """Join all runs, and find the (element, local node) pairs of every point.

    Pressure jumps at a node where a bond joins bodies of other `kinds` (N,). It is no contact point: on either side it
    has the pressure of the middle node beside it.
    """
    sizes = [len(piece.nodes) for piece in pieces]
    node, normals, gap, opposite = (
        np.concatenate([getattr(piece, name) for piece in pieces]) for name in ("nodes", "normals", "gap", "opposite")
    )
    tool = [piece.tool for piece, size in zip(pieces, sizes, strict=True) for _ in range(size)]
    sides = np.column_stack([tied[node], np.where(opposite >= 0, tied[opposite], -1)])
    first_alike = _first_alike(mesh, sides, normals, gap, tool)
    of_sides = np.column_stack([kinds[node], np.where(opposite >= 0, kinds[opposite], -1)])
    jumps = _jumps(sides, of_sides, normals, tool)
    jumps |= (first_alike >= 0) & jumps[first_alike]
    first_alike[jumps] = -1
    own = first_alike == np.arange(len(node))
    sense = np.where(np.sum(normals * normals[first_alike], axis=1) < 0, -1.0, 1.0)
    number = np.where(first_alike < 0, -1, (np.cumsum(own) - 1)[first_alike])
    elements, points, senses = [], [], []
    held_arc = np.array([piece.held_arc for piece in pieces])
    held_points = np.array([piece.held_points for piece in pieces])
    for row, (first, piece) in enumerate(zip(np.cumsum([0, *sizes]), pieces, strict=False)):
        for end, i in enumerate((0, len(piece.nodes) - 1) if len(piece.nodes) else ()):
            shared = first_alike[first + i] not in (-1, first + i)  # is a point of another zone
            if shared or jumps[first + i]:  # contact goes on up to there
                held_arc[row, end], held_points[row, end] = piece.arc[i], mesh.nodes[piece.nodes[i]]
        point_of = np.full(len(mesh.nodes), -1)
        point_of[piece.nodes] = number[first : first + len(piece.nodes)]
        sense_of = np.ones(len(mesh.nodes))
        sense_of[piece.nodes] = sense[first : first + len(piece.nodes)]
        carrier, signs = point_of[mesh.elements[piece.elements]], sense_of[mesh.elements[piece.elements]]
        if jumps.any():
            at_jump = np.isin(mesh.elements[piece.elements], piece.nodes[jumps[first : first + len(piece.nodes)]])
            carrier, signs = (np.where(at_jump, values[:, [1]], values) for values in (carrier, signs))
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


def _jumps(sides: IntArray, kinds: IntArray, normals: Array, tool: Sequence[str | None]) -> BoolArray:
    """Whether points (n,) move with others where a body on one of both sides (n, 2) is of another kind (n, 2).

    Common normals with bodies of other moduli are not quite the same.
    """
    jumps = np.zeros(len(sides), bool)
    if not (kinds > 0).any():  # all bodies are alike
        return jumps
    order = np.argsort(sides, axis=1)
    sides, kinds = (np.take_along_axis(values, order, axis=1) for values in (sides, kinds))
    place = np.unique(sides, axis=0, return_inverse=True)[1].reshape(-1)
    for j in np.flatnonzero(np.bincount(place)[place] > 1).tolist():
        others = np.flatnonzero((place == place[j]) & (kinds != kinds[j]).any(axis=1))
        jumps[j] = any(tool[i] == tool[j] and abs(cross(normals[i], normals[j])) < SMOOTH for i in others.tolist())
    return jumps


def _nodes_along(mesh: Mesh, halves: Array, elements: IntArray, *, closed: bool) -> tuple[IntArray, Array]:
    """Nodes of a run in order, and the arc length up to each."""
    nodes = np.append(mesh.elements[elements, :2].ravel(), mesh.elements[elements[-1], 2])
    arc = np.append(0.0, np.cumsum(halves[elements].ravel()))
    return (nodes[:-1], arc[:-1]) if closed else (nodes, arc)


def _held_along(normals: Array, given: BoolArray) -> BoolArray:
    """Whether prescribed displacements (n, 2) span the normal."""
    return np.all((abs(normals) <= PARALLEL) | given, axis=1)
