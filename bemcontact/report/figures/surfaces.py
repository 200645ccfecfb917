"""Rigid surfaces where they have come to, beside a deformed body to scale or magnified."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from scipy.spatial import KDTree

from bemcontact.analysis.result import Result
from bemcontact.arrays import Array, IntArray
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.problems import BodySurface, DeflectedContour, Problem
from bemcontact.report.figures.page import pieces_of
from bemcontact.report.figures.problem import surface_lines

TURN = 0.6
"""Turn of the normals of a contact, in radians, from which its surface is bent with the gaps, not moved."""
BENT, STEEP = 0.05, 0.1
"""Magnified initial gap over the size of the bodies, and over the length of its zone, up to which a body is bent."""
THROUGH = 0.003
"""Share of the size by which magnified bodies may reach through each other, or stand apart where they touch."""
DEPTH = 0.2
"""Depth up to which a body is bent, over the size of the bodies."""
DISTORTED = 0.1
"""Part of that share by which magnified gaps may displace a surface that is shown."""


class Surface(NamedTuple):
    """Line (j, 2) of a rigid surface with unit normals (j, 2), its name, and whether it is a whole body.

    The name is that of the rigid body, or of the zone.
    """

    points: Array
    normals: Array
    name: str
    body: bool = False


def surfaces_of(
    result: Result, problem: Problem, overhang: float, factor: float = 1.0, near: float = np.inf
) -> Iterator[Surface]:
    """Lines of the rigid surfaces and bodies, displaced with their tools.

    Displacements and gaps are magnified by the factor: a surface is moved as a whole, so that it meets the magnified
    body where it touches or is nearest. That of a zone whose normals turn, such as a pin in a hole, is bent instead,
    see `ground_of`.
    """
    tools = result.contact.tools
    moves = dict(zip(tools.names, tools.displacement(result.solution.rigid_amplitudes), strict=True))
    points, drawn = dict(zip(tools.names, tools.point, strict=True)), set[str]()
    for number, (name, zone) in enumerate(problem.zones.items()):
        if isinstance(zone.surface, BodySurface) and zone.surface.elastic:
            continue  # the other body is drawn itself
        nearest, body = _nearest_points(result, number), isinstance(zone.surface, BodySurface)
        turns = factor > 1 and _turn(result.contact.normals[nearest]) > TURN
        if isinstance(zone.surface, DeflectedContour) or (turns and not body):
            yield from ground_of(result, number, near, factor)
            continue
        if isinstance(zone.surface, BodySurface):
            if zone.surface.body in drawn:
                continue
            drawn.add(zone.surface.body)
        for line, normals in surface_lines(problem, name, overhang):
            for tool in (tool for tool, stated in problem.tools.items() if name in stated.zones):
                x, y, angle = factor * moves[tool]
                line = line + (x, y) + angle * (line - points[tool])[:, ::-1] * (-1, 1)
            if isinstance(zone.surface, BodySurface) and _bends(result, number, factor):
                yield Surface(line + bent(result, zone.surface.body, line, factor), normals, zone.surface.body, body)
            else:
                named = zone.surface.body if isinstance(zone.surface, BodySurface) else name
                yield Surface(line - _shift(result.contact, nearest, factor - 1), normals, named, body)


def bent(result: Result, body: str, points: Array, factor: float) -> Array:
    """Displacement (k, 2) [L] of points of the second body of contacts, which magnifies initial gaps by the factor.

    So the body meets the first one, whose displacements are magnified, where both touch. It decreases with the distance
    from the contact. It is zero where no initial gap needs it.
    """
    contact, problem, total = result.contact, result.problem, np.zeros_like(points)
    assert problem is not None
    for number, name in enumerate(contact.zone_names):
        surface = problem.zones[name].surface
        if isinstance(surface, BodySurface) and surface.body == body and _bends(result, number, factor):
            own = np.flatnonzero(contact.zone == number)
            gap, normals = _gap_as_drawn(contact)[own, None], contact.normals[own]
            away, nearest = KDTree(contact.points[own] - (gap - surface.offset) * normals).query(points)
            moves = -((factor - 1) * gap + surface.offset) * normals
            total += np.maximum(1 - away / (DEPTH * problem.size), 0.0)[:, None] * moves[nearest]
    return total


def reach_through(result: Result, factor: float) -> float:
    """How far [L] magnified bodies reach through surfaces that are moved as a whole, and through each other.

    Two elastic bodies may also stand apart where they touch. Contacts with a body that is bent do not count.
    """
    zones = [n for n in range(len(result.contact.zone_names)) if not _bends(result, n, factor)]
    return max((_reach(result, number, factor) for number in zones), default=0.0)


def bends(result: Result, factor: float) -> bool:
    """Whether a body is bent at any contact, so that its initial gap is magnified too."""
    return any(_bends(result, number, factor) for number in range(len(result.contact.zone_names)))


def _bends(result: Result, number: int, factor: float) -> bool:
    """Whether a body is bent at a zone: magnified initial gaps are small there, and seen if they are not drawn."""
    contact, problem = result.contact, result.problem
    if factor == 1 or problem is None or not isinstance(problem.zones[contact.zone_names[number]].surface, BodySurface):
        return False
    own = contact.zone == number
    largest = (factor - 1) * float(np.abs(_gap_as_drawn(contact)[own]).max())
    small = largest <= min(BENT * problem.size, STEEP * float(contact.weights[own].sum()))
    return small and _reach(result, number, factor) > THROUGH * problem.size


def _reach(result: Result, number: int, factor: float) -> float:
    """How far [L] the magnified body reaches through the surface of a zone, or stands apart from it in contact."""
    contact, problem = result.contact, result.problem
    surface = None if problem is None else problem.zones[contact.zone_names[number]].surface
    own, nearest = np.flatnonzero(contact.zone == number), _nearest_points(result, number)
    gap = factor * contact.gap(result.solution.pressure, result.solution.rigid_amplitudes)
    if isinstance(surface, BodySurface) and surface.elastic:  # neither body is moved as a whole
        apart = gap - (factor - 1) * _gap_as_drawn(contact) - surface.offset
        return float(max(-apart[own].min(), apart[own[result.touching[own]]].max(initial=0.0)))
    if isinstance(surface, BodySurface) or _turn(contact.normals[nearest]) <= TURN:
        moved = _gap_as_drawn(contact)[own] - contact.normals[own] @ _shift(contact, nearest, 1.0)
        return float((-gap[own] + (factor - 1) * moved).max())
    return 0.0


def _shift(contact: CondensedContact, nearest: IntArray, factor: float) -> Array:
    """Mean gap (2,) [L] along the normals of contact points, times a factor."""
    return factor * (_gap_as_drawn(contact)[nearest, None] * contact.normals[nearest]).mean(axis=0)


def _gap_as_drawn(contact: CondensedContact) -> Array:
    """Gap (n,) [L] before anything moves, also the tools whose displacement is prescribed."""
    return contact.initial_gap - contact.tools.motions @ contact.tools.position


def _nearest_points(result: Result, zone: int) -> IntArray:
    """Contact points of a zone that touch, of all that a rigid body has, or the one with the smallest gap."""
    own = np.flatnonzero(np.isin(result.contact.zone, _zones_of_body(result, zone)))
    touching = own[result.touching[own]]
    gap = result.contact.gap(result.solution.pressure, result.solution.rigid_amplitudes)
    return touching if len(touching) else own[[int(np.argmin(gap[own]))]]


def _zones_of_body(result: Result, zone: int) -> list[int]:
    """Numbers of the zones on the rigid body of a zone; of another surface only that zone."""
    zones = () if result.problem is None else [it.surface for it in result.problem.zones.values()]
    bodies = [it.body if isinstance(it, BodySurface) and not it.elastic else None for it in zones]
    return [n for n, body in enumerate(bodies) if n == zone or (body is not None and body == bodies[zone])] or [zone]


def _turn(normals: Array) -> float:
    """Largest angle [rad] between normals (k, 2) and their mean direction."""
    mean = normals.mean(axis=0)
    size = float(np.hypot(*mean))
    return float(np.arccos(np.clip(normals @ mean / size, -1, 1)).max()) if size else np.pi


def ground_of(result: Result, zone: int, near: float, factor: float = 1.0) -> Iterator[Surface]:
    """Lines (j, 2) of the rigid surface of a zone, with normals, no farther than `near` from the deformed body.

    Its gaps to the undeformed body are magnified by the factor, as displacements are, so that the two meet in contact.
    Where that would show it bent or turned, it is left out.
    """
    contact = result.contact
    moved = contact.tools.motions @ (contact.tools.amplitudes @ result.solution.rigid_amplitudes)
    feet = contact.points - factor * (contact.initial_gap + moved)[:, None] * contact.normals
    bent = (factor - 1) * abs(contact.initial_gap + moved)
    gap = result.contact.gap(result.solution.pressure, result.solution.rigid_amplitudes)
    shown = (factor * gap <= near) & (bent <= DISTORTED * near)
    for piece in pieces_of(contact, result.touching):
        for stretch in np.split(piece.index, np.flatnonzero(np.diff(shown[piece.index])) + 1):
            if contact.zone[stretch[0]] == zone and shown[stretch[0]] and len(stretch) > 1:
                yield Surface(feet[stretch], contact.normals[stretch], contact.zone_names[zone])
