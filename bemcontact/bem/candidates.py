"""The search for contact points: nodes of the zones that may touch, piece by piece along the boundary."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import accumulate, pairwise
from typing import NamedTuple, Self

import numpy as np

from bemcontact.arrays import Array, BoolArray, IntArray, ObjectArray, indices, magnitudes
from bemcontact.bem.boundary_values import BoundaryValues
from bemcontact.bem.contact_points import ALIKE, SMOOTH, ContactPoints, HeldNodes
from bemcontact.bem.mesh import Mesh, runs
from bemcontact.bem.outline import Outline
from bemcontact.errors import Issue, ProblemError
from bemcontact.problems.body_surface import AnySurface, BodySurface
from bemcontact.problems.curves import cross
from bemcontact.problems.problem import Problem
from bemcontact.problems.rigid_surface import DeflectedContour
from bemcontact.problems.surface_lines import Closest, Faces, SmoothSurface
from bemcontact.problems.visibility import turned_to

ENDS = np.array([0, -1])
"""Indices of both ends of a piece."""
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
    zones, in_zones, given = problem.zones, outline.in_zones, values.displacement_given
    choice, tied, kinds = _in_several(mesh, in_zones), _tied(problem, mesh), _kinds(problem, mesh)
    for number, (name, zone) in enumerate(zones.items()):
        in_zone, faces = in_zones[number], _faces(outline, zone.surface, in_zones[number], deflections.get(name))
        other = isinstance(zone.surface, BodySurface) and zone.surface.elastic
        across, divides = _across(mesh, mesh.facing.get(name)), faces.differs[:, 0]
        if name in mesh.facing:
            divides = divides | _parted(across, tied, kinds)
        for elements, closed in _between(mesh, runs(mesh, in_zone), divides):
            nodes, arc = _nodes_along(mesh, halves, elements, closed=closed)
            gap, normals, lies = faces.along(nodes, closed=closed)
            opposite = _along(across, nodes, closed=closed)
            stuck, bonded = _stuck(given, tied, normals, nodes, opposite)
            free = ~(stuck | bonded)
            if choice[nodes].any():
                free &= ~choice[nodes] | faces.turned(mesh, elements, closed=closed)
            length = arc[-1] + halves[elements[-1], 1] if closed else np.inf
            fixed = not closed and name not in tool_of and not other
            ends, held, goes_on = nodes[ENDS], np.full(2, np.nan), (False, False)
            at_bond, to_hold = bonded[ENDS] & (not closed), bonded[ENDS] | (stuck[ENDS] & fixed)
            beyond = _held_beyond(mesh, values, elements, normals) if fixed else np.zeros(2, bool)
            if to_hold.any() or beyond.any():
                on_surface = _on_surface(mesh, (values, *cases), ends, normals[ENDS], gap[ENDS])
                goes_on = _goes_on(mesh, elements, on_surface & beyond)
                held[:] = np.where(on_surface & to_hold, arc[ENDS], np.nan)
            at, fast = indices(free), indices(stuck)
            pieces.append(
                _Piece(
                    number, tool_of.get(name), elements, elements, length, goes_on, at_bond, nodes[at], arc[at],
                    normals[at], lies[at], gap[at], opposite[at], held, mesh.nodes[ends],
                    HeldNodes(np.full(len(fast), number), nodes[fast], normals[fast], gap[fast]),
                )
            )  # fmt: skip
        touching = any(len(piece.nodes) for piece in pieces if piece.zone == number)
        if not touching and choice[mesh.elements[in_zone, 1]].any():
            message = "no node of its edges is turned to the surface; give these edges more elements"
            raise ProblemError(Issue(path=("contact_zones", name, "edges"), message=message))
        pieces += _standing(mesh, number, tool_of.get(name), in_zone, faces, across, given, tied)
    facing = {number: mesh.facing[name] for number, name in enumerate(zones) if name in mesh.facing}
    return _joined(mesh, pieces, tied, kinds, facing)


def _in_several(mesh: Mesh, in_zones: BoolArray) -> BoolArray:
    """Whether each node (N,) is one of elements of several zones, (zones, m)."""
    if len(in_zones) < 2:
        return np.zeros(len(mesh.nodes), bool)
    count = np.zeros(len(mesh.nodes), int)
    for in_zone in in_zones:
        count[mesh.nodes_of(indices(in_zone))] += 1
    return count > 1


def _parted(across: IntArray, tied: IntArray, kinds: IntArray) -> BoolArray:
    """Whether nodes (N,) have two opposite nodes (2, N) that bonds do not join, or in bodies of two kinds."""
    parted = across.min(axis=0) >= 0
    one, two = across[:, parted]
    parted[parted] = (tied[one] != tied[two]) | (kinds[one] != kinds[two])
    return parted


def _kinds(problem: Problem, mesh: Mesh) -> IntArray:
    """Number of the material and the heat at each node (N,): stress jumps where a bond joins bodies of other ones."""
    kinds = np.zeros(len(mesh.nodes), int)
    if not problem.bonded:
        return kinds
    heats = zip(*([loads.temperature for loads in each] for each in problem.volume_loads), strict=True)
    of_parts = [(part.material, heat) for part, heat in zip(problem.parts, heats, strict=True)]
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
        own = indices(facing >= 0)
        start, middle, end = mesh.elements[own].T
        theirs = mesh.elements[facing[own]]
        across[1, start], across[:, middle], across[0, end] = theirs[:, 2], theirs[:, 1], theirs[:, 0]
    return across


def _stuck(
    given: BoolArray, tied: IntArray, normals: Array, nodes: IntArray, opposite: IntArray
) -> tuple[BoolArray, BoolArray]:
    """Whether displacements that are `given` (N, 2) hold pairs (k,) of nodes along the normal, and whether bonds do."""
    stuck, bonded, paired = _held_along(normals, given[nodes]), np.zeros(len(nodes), bool), opposite >= 0
    if paired.any():
        bonded = paired & (tied[nodes] == tied[opposite])
        stuck &= ~bonded & (~paired | _held_along(normals, given[opposite]))  # else the other body comes up to it
    return stuck, bonded


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

    @classmethod
    def of_one(cls, face: Closest) -> Self:
        """One face for all sides of each node."""
        gap, normals = face.gap[:, None].repeat(3, axis=1), face.normals[:, None].repeat(3, axis=1)
        return cls(gap, normals, normals, np.zeros(gap.shape, bool))

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


def _faces(outline: Outline, surface: AnySurface, in_zone: BoolArray, deflection: Array | None) -> _NodeFaces:
    """Faces of a surface at all nodes, or of the deflected contour.

    Those of another elastic body, which take long, are found at nodes of elements (m,) in the zone alone.
    """
    mesh = outline.mesh
    if isinstance(surface, DeflectedContour):
        assert deflection is not None
        return _NodeFaces.of_one(surface.behind(deflection))
    if isinstance(surface, SmoothSurface):
        return _NodeFaces(*outline.held_nodes(surface), np.zeros((len(mesh.nodes), 3), bool))
    if isinstance(surface, BodySurface) and surface.elastic:
        own, (inward, reach) = mesh.nodes_of(indices(in_zone)), outline.sides
        held = Faces(*(np.zeros((len(mesh.nodes), *shape)) for shape in ((3,), (3, 2), (3, 2))))
        for part, known in zip(held, surface.faces(mesh.nodes[own], inward[own], reach[own]), strict=True):
            part[own] = known
    else:
        held = outline.held_nodes(surface)
    other = magnitudes(held.normals - held.normals[:, [2, 0, 0]]) > ALIKE
    return _NodeFaces(*held, other | (abs(held.gap - held.gap[:, [2, 0, 0]]) > ALIKE * mesh.size))


def _between(mesh: Mesh, runs: Iterable[tuple[IntArray, bool]], divides: BoolArray) -> Iterator[tuple[IntArray, bool]]:
    """Divide runs at nodes (N,) that two faces of the surface hold, or that have two opposite nodes."""
    for elements, closed in runs:
        corners = indices(divides[mesh.elements[elements, 0]])
        if closed and len(corners):
            elements, corners, closed = np.roll(elements, -corners[0]), corners - corners[0], False
        bounds = [0, *corners[corners > 0].tolist(), len(elements)]
        for low, high in pairwise(bounds):
            yield elements[low:high], closed


def _standing(
    mesh: Mesh, zone: int, tool: str | None, in_zone: BoolArray, faces: _NodeFaces, across: IntArray, given: BoolArray,
    tied: IntArray,
) -> Iterator["_Piece"]:  # fmt: skip
    """Corners of the body that stand on a face of the surface to which neither side of them is turned."""
    differs = faces.differs[: len(mesh.elements), 1]
    for node in indices(differs & (in_zone | in_zone[mesh.before])) if differs.any() else ():
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
    moved = np.array([(normals * item.displacement[nodes]).sum(axis=1) for item in values])
    moved[0] += gap
    return np.all(abs(moved) <= ALIKE * mesh.size, axis=0)


def _held_beyond(mesh: Mesh, values: BoundaryValues, elements: IntArray, normals: Array) -> BoolArray:
    """Whether a condition holds the element beyond each end of a run (2,) along its last normal."""
    first, after = elements[0], mesh.elements[elements[-1], 2]  # an element has the number of its start node
    return _held_along(normals[ENDS], values.traction_unknown[[mesh.before[first], after]])


def _goes_on(mesh: Mesh, elements: IntArray, may: BoolArray) -> tuple[bool, bool]:
    """Whether contact continues smoothly beyond those ends of a run (2,) where it may."""
    if not may.any():
        return False, False
    ends = elements[0], mesh.elements[elements[-1], 2]
    start, end = (may & (abs(mesh.turns[[*ends]]) < SMOOTH)).tolist()
    return start, end


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


def _joined(
    mesh: Mesh, pieces: list[_Piece], tied: IntArray, kinds: IntArray, facing: Mapping[int, IntArray]
) -> ContactPoints:
    """Join all runs, and find the (element, local node) pairs of every point.

    Pressure jumps at a node where a bond joins bodies of other `kinds` (N,). It is no contact point: on either side it
    has the pressure of the middle node beside it.
    """
    sizes = [len(piece.nodes) for piece in pieces]
    node, normals, gap, opposite = (
        np.concatenate([getattr(piece, name) for piece in pieces]) for name in ("nodes", "normals", "gap", "opposite")
    )
    run = np.arange(len(pieces)).repeat(sizes)
    tool = np.array([piece.tool for piece in pieces], object)[run]
    sides = tied[node], np.where(opposite >= 0, tied[opposite], -1)
    first_alike = _first_alike(mesh, sides, normals, gap, tool)
    jumps = np.zeros(len(node), bool)
    if kinds.any():  # else all bodies are alike
        of_sides = kinds[node], np.where(opposite >= 0, kinds[opposite], -1)
        jumps = _jumps(np.stack(sides, axis=1), np.stack(of_sides, axis=1), normals, tool)
        jumps |= (first_alike >= 0) & jumps[first_alike]
        first_alike[jumps] = -1
    alone = first_alike == np.arange(len(node))
    shared, number, sense = not alone.all(), alone.cumsum() - 1, np.ones(len(node))
    own = indices(alone) if shared else slice(None)
    if shared:
        sense[(normals * normals[first_alike]).sum(axis=1) < 0] = -1.0
        number = np.where(first_alike < 0, -1, number[first_alike])
    elements, points, senses = [], [], []
    held_arc = np.array([piece.held_arc for piece in pieces])
    held_points = np.array([piece.held_points for piece in pieces])
    for row, (first, piece) in enumerate(zip(accumulate(sizes, initial=0), pieces, strict=False)):
        for end, i in enumerate((0, len(piece.nodes) - 1) if len(piece.nodes) else ()):
            of_other = first_alike[first + i] not in (-1, first + i)  # is a point of another zone
            if of_other or jumps[first + i]:  # contact goes on up to there
                held_arc[row, end], held_points[row, end] = piece.arc[i], mesh.nodes[piece.nodes[i]]
        point_of = np.full(len(mesh.nodes), -1)
        point_of[piece.nodes] = number[first : first + len(piece.nodes)]
        its_nodes = mesh.elements[piece.elements]
        carrier, signs = point_of[its_nodes], np.ones(its_nodes.shape)
        if shared:
            sense_of = np.ones(len(mesh.nodes))
            sense_of[piece.nodes] = sense[first : first + len(piece.nodes)]
            signs = sense_of[its_nodes]
        if jumps.any():
            at_jump = np.isin(its_nodes, piece.nodes[jumps[first : first + len(piece.nodes)]])
            carrier, signs = (np.where(at_jump, values[:, [1]], values) for values in (carrier, signs))
        for bonded, goes_on, element, end in zip(piece.bonded.tolist(), piece.goes_on, (0, -1), (0, 2), strict=True):
            if bonded or goes_on:
                carrier[element, end] = carrier[element, 1]
        elements.append(piece.elements)
        points.append(carrier)
        senses.append(signs)
    shares = 3 * np.concatenate(elements)[:, None] + np.arange(3)
    share, point = shares.ravel(), np.concatenate(points).ravel()
    once = indices(point >= 0)
    if len(pieces) > 1:  # zones that share an edge and a face share its points
        once = once[_once(share[once] * len(node) + point[once])]
    element, local = np.divmod(share[once], 3)
    return ContactPoints(
        mesh=mesh,
        node=node[own],
        zone=np.array([piece.zone for piece in pieces])[run[own]],
        run=run[own],
        arc_position=np.concatenate([piece.arc for piece in pieces])[own],
        run_length=np.array([piece.length for piece in pieces]),
        normals=normals[own],
        faces=np.concatenate([piece.faces for piece in pieces])[own],
        gap=gap[own],
        element=element,
        local=local,
        point=point[once],
        sense=np.concatenate(senses).ravel()[once],
        held_arc=held_arc,
        held_points=held_points,
        tied=tied,
        bonded_ends=np.array([piece.bonded for piece in pieces]),
        elements_of_run=tuple(piece.own for piece in pieces),
        zone_of_run=tuple(piece.zone for piece in pieces),
        held=HeldNodes(*map(np.concatenate, zip(*(piece.held for piece in pieces if piece.held), strict=True))),
        facing=facing,
    )


def _once(code: IntArray) -> IntArray:
    """Ascending indices of the first of equal numbers (q,)."""
    order = code.argsort(kind="stable")
    first = np.ones(len(code), bool)
    first[order[1:]] = code[order[1:]] != code[order[:-1]]
    return indices(first)


def _first_alike(
    mesh: Mesh, sides: tuple[IntArray, IntArray], normals: Array, gap: Array, tool: ObjectArray
) -> IntArray:
    """The first point (n,) with the same nodes, normal, gap and tool, which contacts that meet on one surface share.

    Nodes (n,) on both sides are one if they move together. Two contacts may state the sides the other way round. It
    is -1 for a point that another one with a smaller gap keeps from touching.
    """
    (near, far), first = sides, np.arange(len(gap))
    code = np.minimum(near, far) * len(mesh.nodes) + np.maximum(near, far)
    if len({*code.tolist()}) == len(code):
        return first
    _, place = np.unique(code, return_inverse=True)
    for j in indices(np.bincount(place)[place] > 1).tolist():
        same = [i for i in indices(place == place[j]).tolist() if tool[i] == tool[j]]
        turned = {i: 1.0 if near[i] == near[j] else -1.0 for i in same}
        same = [i for i in same if np.hypot(*(normals[i] - turned[i] * normals[j])) <= ALIKE]
        least = min(gap[i] for i in same)
        if gap[j] <= least + ALIKE * mesh.size:
            first[j] = next(i for i in same if gap[i] <= least + ALIKE * mesh.size)
        else:
            first[j] = -1
    return first


def _jumps(sides: IntArray, kinds: IntArray, normals: Array, tool: ObjectArray) -> BoolArray:
    """Whether points (n,) move with others where a body on one of both sides (n, 2) is of another kind (n, 2).

    Common normals with bodies of other moduli are not quite the same.
    """
    jumps, order = np.zeros(len(sides), bool), np.argsort(sides, axis=1)
    sides, kinds = (np.take_along_axis(values, order, axis=1) for values in (sides, kinds))
    place = np.unique(sides, axis=0, return_inverse=True)[1].reshape(-1)
    for j in indices(np.bincount(place)[place] > 1).tolist():
        others = indices((place == place[j]) & (kinds != kinds[j]).any(axis=1))
        jumps[j] = any(tool[i] == tool[j] and abs(cross(normals[i], normals[j])) < SMOOTH for i in others.tolist())
    return jumps


def _nodes_along(mesh: Mesh, halves: Array, elements: IntArray, *, closed: bool) -> tuple[IntArray, Array]:
    """Nodes of a run in order, and the arc length up to each."""
    nodes, arc = np.empty(2 * len(elements) + 1, int), np.zeros(2 * len(elements) + 1)
    nodes[:-1], nodes[-1] = mesh.elements[elements, :2].ravel(), mesh.elements[elements[-1], 2]
    halves[elements].cumsum(out=arc[1:])
    return (nodes[:-1], arc[:-1]) if closed else (nodes, arc)


def _held_along(normals: Array, given: BoolArray) -> BoolArray:
    """Whether prescribed displacements (n, 2) span the normal."""
    held = (abs(normals) <= PARALLEL) | given
    return held[:, 0] & held[:, 1]
