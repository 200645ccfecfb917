"""Contact points after they have moved: exact gaps, turned normals, and the levers that forces have there."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from bemcontact.arrays import Array, BoolArray, IntArray, indices, magnitudes, scalar_products
from bemcontact.bem.body import Body
from bemcontact.bem.contact_points import ALIKE, SMOOTH, ContactPoints
from bemcontact.bem.free_motions import steps_of_surfaces
from bemcontact.bem.mesh import Mesh, MeshPart
from bemcontact.bem.surface_gaps import SAME_FACE, SurfaceGaps
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.solution import ContactSolution
from bemcontact.problems.body_surface import BodySurface
from bemcontact.problems.conditions import Condition
from bemcontact.problems.curves import cross
from bemcontact.problems.edge_places import curvatures, nearest_on
from bemcontact.problems.problem import Problem
from bemcontact.problems.surface_lines import STEEP, Closest, Polyline

FLAT = (0.0, 1.0)
"""Parts of the first side in common normals that state that one side is flat, where both may be under pressure."""
FLATTER = 0.25
"""Curvature of one side over that of the other one, up to which contact stays on the latter as both slide."""


class Displaced(NamedTuple):
    """Contact points after they have moved.

    Parameters
    ----------
    motion : (n, 2) displacement against the surface [L]
    change : (n,) of the gap beside the linear one [L]
    distance : (n,) from the surface [L]
    other : (n,) whether another face of the surface is nearest
    turn : (n, 2) change of the normal
    """

    motion: Array
    change: Array
    distance: Array
    other: BoolArray
    turn: Array


def displaced(
    gaps: SurfaceGaps, points: ContactPoints, contact: CondensedContact, solution: ContactSolution
) -> Displaced:
    """Compare the gap of contact with the distance after the motion; on another, nearer face the former counts."""
    at, of_nodes = contact.points, _at_nodes(gaps, points)
    displacement = of_nodes[points.node]
    linear, still = contact.initial_gap + solution.displacement, np.zeros_like(displacement)
    found = Displaced(displacement.copy(), np.zeros(len(at)), linear.copy(), np.zeros(len(at), bool), still)
    for number, zone in enumerate(contact.zone_names):
        if zone not in gaps.surfaces:
            continue
        of_zone, surface = contact.zone == number, gaps.surfaces[zone]
        own = slice(None) if of_zone.all() else of_zone
        body = surface if isinstance(surface, BodySurface) and surface.elastic else None
        places, opposite = at[own] + displacement[own], points.opposite.node[own]
        there, has = gaps.exact(zone, places), opposite >= 0
        face, along = points.faces[own], scalar_products(there.normals, contact.normals[own])
        ridge = (magnitudes(face - contact.normals[own]) > ALIKE) & (along > STEEP)
        other = ~ridge & (scalar_products(there.normals, face) < SAME_FACE)
        moved, distance = of_nodes[opposite], there.gap
        carried = None
        if body and solution.pressure[own].any():
            carried = _carried_along(gaps, zone, points, contact, solution.pressure, displacement[own] - moved)
        if carried:
            distance = np.where(other, there.gap, carried.gap)
        beyond = distance / np.where(ridge, along, 1.0) - linear[own]
        found.motion[own] -= moved if has.all() else np.where(has[:, None], moved, gaps.tool_motion(zone, at[own]))
        tip = gaps.beside_groove(zone, at[own], magnitudes(found.motion[own]))
        grooved = (beyond < 0) & (tip | (other & isinstance(surface, Polyline)))
        turned = np.where(ridge[:, None], face, there.normals)
        if body:
            turned = turned + gaps.turn_of(body, places - gaps.tool_motion(zone, places), turned)
        if carried:
            turned = np.where((other | ridge)[:, None], turned, carried.normals)
        found.turn[own] = np.where((other | tip)[:, None], 0.0, turned - face)
        found.change[own] = np.where(grooved, 0.0, beyond)
        found.distance[own], found.other[own] = there.gap, other
        if body:
            sure, pressed = of_zone.copy(), contact.pressed(solution.pressure, solution.displacement)
            sure[own] = ~tip
            _see_from_other_side(gaps, zone, points, of_zone, sure, pressed, linear, found)
    if points.bonded_ends.any():
        at_tip = _at_tip_of_bond(points, found.motion)
        found.change[at_tip], found.turn[at_tip], found.other[at_tip] = 0.0, 0.0, False
    return found


def _carried_along(
    gaps: SurfaceGaps, zone: str, points: ContactPoints, contact: CondensedContact, pressure: Array, against: Array
) -> Closest | None:
    """Distance (k,) [L] and normals (k, 2) where one side is flat, after displacements (k, 2) against the second body.

    Pressure slides along on the flat side and takes its deformation along. So each point has the displacement of its
    pair, not that of the place where it comes to, which may be beside all pressure. It only goes up or down the slope
    that the flat side has under an unbroken contact as a whole, and has the normal of this slope. None without a flat
    side.
    """
    own = indices(contact.zone == contact.zone_names.index(zone))
    surface, force = gaps.surfaces[zone], (contact.weights * pressure)[own]
    assert isinstance(surface, BodySurface)
    at, pairs = contact.points[own], points.mesh.nodes[points.opposite.node[own]]
    flat = _flat_side(surface, at, pairs, force)
    if flat is None:
        return None
    if flat == 0:  # seen from the other side, a slide along it changes nothing
        surface, at, pairs, against = surface.other_side, pairs, at, -against
    places = at + against
    turn = gaps.turn_of(surface, pairs, surface.closest(pairs).normals)
    distance, normals = surface.continued.closest(places)
    for beside in _around_contacts(contact.run[own], force > 0):
        mean = force[beside] @ turn[beside] / force[beside].sum()
        distance[beside] += (places - pairs)[beside] @ mean
        normals[beside] += mean
    return Closest(distance, normals if flat else -normals)


def _flat_side(surface: BodySurface, at: Array, pairs: Array, force: Array) -> int | None:
    """Side, 0 or 1, that is flat beside the other one where points (k, 2) press on their pairs; None if neither is.

    Where both are, it is the side on which the other one may slide past its round edges, as of `share`. Contact up to
    an end of a side, as at a corner or a bond, does not have the slope of the whole.
    """
    if surface.share in FLAT:
        return int(surface.share == 0)
    pressed = force > 0
    around = pressed | np.roll(pressed, 1) | np.roll(pressed, -1)
    if surface.other_side.feet(at[around]).at_corner.any() or surface.feet(pairs[around]).at_corner.any():
        return None
    first, second = (
        float(force[pressed] @ abs(curvatures(edges, nearest_on(edges, places[pressed]))))
        for edges, places in ((surface.first, at), (surface.edges, pairs))
    )
    return int(second < first) if min(first, second) < FLATTER * max(first, second) else None


def _around_contacts(run: IntArray, pressed: BoolArray) -> Iterator[IntArray]:
    """Points of each unbroken contact, with the open ones that are nearer to it in their run than to another one."""
    for number in np.unique(run[pressed]).tolist():
        at = indices(run == number)
        inside = indices(pressed[at])
        starts = indices(np.diff(inside) > 1)
        yield from np.split(at, (inside[starts] + inside[starts + 1] + 1) // 2)


def _at_tip_of_bond(points: ContactPoints, motion: Array) -> BoolArray:
    """Whether points (n,) are so near to the begin of a bond that linear theory does not tell their displaced places.

    Both sides slide there by the root of the distance. So this is the first element, whose places between nodes slide
    otherwise, and what slides by more than its distance.
    """
    beside, mesh = np.zeros(len(points), bool), points.mesh
    for run, end in np.argwhere(points.bonded_ends).tolist():
        element = points.elements_of_run[run][-end]
        away = np.hypot(*(mesh.nodes[points.node] - mesh.nodes[mesh.elements[element, 2 * end]]).T)
        near = np.isin(points.node, mesh.elements[element]) | (away <= np.hypot(*motion.T))
        beside |= near & (points.run == run)
    return beside


def _see_from_other_side(
    gaps: SurfaceGaps, zone: str, points: ContactPoints, own: BoolArray, sure: BoolArray, pressed: BoolArray,
    linear: Array, found: Displaced,
) -> None:  # fmt: skip
    """Put the distance of nodes of the second elastic body from the first one, where it says more.

    `own` (n,) are the points of the zone, `sure` (n,) those not at the tip of a notch, where another face may be
    nearer, and `pressed` (n,) those under pressure.

    If an end of the second body slides along the first one, nothing is opposite to points behind it. But the pressure
    slides along with the end, if all pressed nodes of the second body in this run are still opposite to the first one.
    Opposite to a corner slopes are infinite, and the corner has slid on from there. So places beside a corner of the
    first body are compared with that body. Both is the same if the sides are exchanged.
    """
    mesh, other = points.mesh, points.opposite.node
    at = indices(own & (other >= 0))
    there = gaps.from_other_side(zone, mesh.nodes[other[at]] + _at_nodes(gaps, points)[other[at]])
    change = there.gap - linear[at]
    facing = np.sum(there.normals * points.faces[at], axis=1) >= SAME_FACE * np.hypot(*there.normals.T)
    slid, off = found.other[at] & (found.change[at] > 0), pressed[at] & sure[at] & ~facing & (change > 0)
    along = slid & ~np.isin(points.run[at], points.run[at][off])
    corners, others = (mesh.nodes[_convex(mesh, nodes[at[pressed[at]]])] for nodes in (points.node, other))
    places = mesh.nodes[points.node[at]]
    use = facing & (along | (sure[at] & ~slid & (_nearest(places, corners) < _nearest(places, others))))
    at = at[use]
    found.change[at], found.distance[at], found.other[at] = change[use], there.gap[use], False
    found.turn[at] = there.normals[use] - points.faces[at]


def _convex(mesh: Mesh, nodes: IntArray) -> IntArray:
    """Those of some nodes that are convex corners of their body."""
    ends = nodes[nodes < len(mesh.elements)]
    return ends[mesh.turns[ends] < -SMOOTH]


def _nearest(points: Array, places: Array) -> Array:
    """Distance (k,) [L] of points (k, 2) from the nearest of some places (j, 2); infinite without any."""
    return magnitudes(points[:, None] - places).min(axis=1, initial=np.inf)


def _at_points(gaps: SurfaceGaps, points: ContactPoints) -> Array:
    """Displacement (n, 2) [L] of the contact points."""
    return _at_nodes(gaps, points)[points.node]


def _at_nodes(gaps: SurfaceGaps, points: ContactPoints) -> Array:
    """Displacement (N, 2) [L] of all nodes."""
    displacement = np.zeros((len(points.mesh.nodes), 2))
    displacement[points.mesh.elements] = gaps.state.displacement
    return displacement


def load_after(
    gaps: SurfaceGaps, body: Body, contact: CondensedContact, solution: ContactSolution, moved: Displaced, ways: Array,
    least: float,
) -> Array:  # fmt: skip
    """Work (j,) in all free motions, seen and unseen, of what forces gain by the motion: other levers and directions.

    As drawn, forces do no work in them. So it is their virtual work at the displaced places, whose normals are turned:
    Σ w p (n + turn)·way over all zones, and that of the loads. The `ways` (n, 2, j) are as of `ways_of_contact`.
    Pressure that balances the other levers by moving by less than a `least` part of its length may come from the mesh.
    """
    motions = body.free
    load = np.tensordot((contact.weights * solution.pressure)[:, None] * moved.turn, ways, axes=2)
    if not len(motions):
        return load
    pressed = contact.lengths_by_zone @ (solution.pressure > 0)
    enough = least * pressed[pressed > 0].min() * (contact.weights @ solution.pressure)
    for number, part in enumerate(body.mesh.parts):
        center = centroid(part.mesh)
        force, moment = _gain_of_levers(gaps, body, part, center)
        if abs(moment) > enough:
            load = load + motions.of_body(number).work_of(force, moment, about=center)
    for number, tool in enumerate(gaps.problem.tools.values()):
        moment = _gain_of_levers_of_tool(gaps, body.points, contact, solution, tool.zones)
        if abs(moment) > enough:
            load = load - moment * motions.tools[3 * number + 2]
    return load


def _gain_of_levers_of_tool(
    gaps: SurfaceGaps, points: ContactPoints, contact: CondensedContact, solution: ContactSolution, zones: Sequence[str]
) -> float:
    """Moment that pressure on the body gains about the point of a tool, by motion that contact has not followed."""
    own = np.isin(contact.zone, [contact.zone_names.index(zone) for zone in zones])
    beside = _at_points(gaps, points)[own] - gaps.way_of_tool(zones[0]).step
    forces = (contact.weights * solution.pressure)[own, None] * contact.normals[own]
    return float(np.sum(cross(beside + steps_of_surfaces(gaps.problem)[contact.zone[own]], forces)))


def turn_of_body(gaps: SurfaceGaps, part: MeshPart | None = None) -> float:
    """Turn [rad] nearest to the displacement of the boundary, or of that of one body."""
    mesh, own = (gaps.outline.mesh, slice(None)) if part is None else part[:2]
    length, x, u = mesh.tributary, gaps.state.points[own] - mesh.centroid, gaps.state.displacement[own]
    return float(np.vdot(length, cross(x, u)) / np.vdot(length, scalar_products(x, x)))


def _gain_of_levers(gaps: SurfaceGaps, body: Body, part: MeshPart, center: Array) -> tuple[Array, float]:
    """Force (2,) and moment about the centroid (2,) that the forces on a body gain as it turns by θ."""
    angle, (force, moment) = turn_of_body(gaps, part), gain_by_turn(gaps, body, part, center)
    return angle * force, angle * moment


def gain_by_turn(gaps: SurfaceGaps, body: Body, part: MeshPart, center: Array) -> tuple[Array, float]:
    """Force (2,) and moment about the centroid (2,) that the forces on a body gain for each radian by which it turns.

    Their places turn with the body, which adds -Σ r·f to the moment. A prescribed pressure turns with its face: it
    keeps its moment, and its resultant has another direction. A weight acts on the centroid.
    """
    mesh, own = part.mesh, part.elements
    length, r = mesh.tributary, gaps.state.points[own] - center
    dead = float(np.vdot(length, scalar_products(gaps.state.traction[own], r)))
    following = {edge for edge, held in _conditions(gaps) if held.pressure is not None}
    with_face = np.array([name in following for name in mesh.edge_names])[mesh.edge]
    if not with_face.any():
        return np.zeros(2), -dead
    normals = mesh.normals[with_face]
    pressure = length[with_face] * scalar_products(body.acting.values.traction[own][with_face], normals)
    forces = pressure[..., None] * normals
    x, y = forces.sum(axis=(0, 1)).tolist()
    return np.array([-y, x]), float(scalar_products(forces, r[with_face]).sum()) - dead


def _conditions(gaps: SurfaceGaps) -> Iterator[tuple[str, Condition]]:
    """Conditions of edges, permanent and of load cases."""
    yield from gaps.problem.edge_conditions.items()
    for case in gaps.problem.load_cases.values():
        yield from case.conditions.items()


def centroid(mesh: Mesh) -> Array:
    """Centroid (2,) of the area [L]."""
    x = mesh.nodes[mesh.elements] - mesh.centroid
    flux = (mesh.tributary * scalar_products(x, mesh.normals)).ravel()
    return mesh.centroid + 2 / 3 * (flux @ x.reshape(-1, 2)) / flux.sum()


def ways_of_contact(problem: Problem, body: Body, contact: CondensedContact) -> Array:
    """Motion (n, 2, j) of the contact points against their surfaces in each of all free motions, seen and unseen."""
    motions, other = body.free, body.points.opposite.node
    at = motions.displacement(body.mesh)
    ways = at[body.points.node] - np.where((other >= 0)[:, None, None], at[other], 0.0)
    for number, name in enumerate(contact.tools.names):
        own = np.isin(contact.zone, [contact.zone_names.index(zone) for zone in problem.tools[name].zones])
        about = steps_of_surfaces(problem)[contact.zone[own]] + contact.tools.point[number]
        (x, y), (along_x, along_y, turn) = (contact.points[own] - about).T, motions.tools[3 * number : 3 * number + 3]
        ways[own] -= np.stack([along_x - np.outer(y, turn), along_y + np.outer(x, turn)], axis=1)
    return ways
