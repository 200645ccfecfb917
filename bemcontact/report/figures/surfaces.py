"""Rigid surfaces where they have come to, beside a deformed body to scale or magnified."""

from collections.abc import Iterator

import numpy as np

from bemcontact.analysis.result import Result
from bemcontact.arrays import Array, IntArray
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.problem import BodySurface, DeflectedContour, Problem
from bemcontact.report.figures.page import pieces_of
from bemcontact.report.figures.problem import surface_line

TURN = 0.6
"""Turn of the normals of a contact, in radians, from which its surface is bent with the gaps, not moved."""
DISTORTED = 0.1
"""Part of that share by which magnified gaps may displace a surface that is shown."""


def surfaces_of(
    result: Result, problem: Problem, overhang: float, factor: float = 1.0, near: float = np.inf
) -> Iterator[tuple[Array, Array]]:
    """Lines (j, 2) of the rigid surfaces and unit normals (j, 2), displaced with their tools.

    Displacements and gaps are magnified by the factor: a surface is moved as a whole, so that it meets the magnified
    body where it touches or is nearest. That of a zone whose normals turn, such as a pin in a hole, is bent instead,
    see `ground_of`.
    """
    tools = result.contact.tools
    moves = dict(zip(tools.names, tools.displacement(result.solution.rigid_amplitudes), strict=True))
    points = dict(zip(tools.names, tools.point, strict=True))
    for number, (name, zone) in enumerate(problem.zones.items()):
        if isinstance(zone.surface, BodySurface) and zone.surface.elastic:
            continue  # the other body is drawn itself
        nearest = _nearest_points(result, number)
        if isinstance(zone.surface, DeflectedContour) or (factor > 1 and _turn(result.contact.normals[nearest]) > TURN):
            yield from ground_of(result, number, near, factor)
            continue
        line, normals = surface_line(problem, name, overhang)
        for tool in (tool for tool, stated in problem.tools.items() if name in stated.zones):
            x, y, angle = factor * moves[tool]
            line = line + (x, y) + angle * (line - points[tool])[:, ::-1] * (-1, 1)
        yield line - _shift(result.contact, nearest, factor - 1), normals


def reach_through(result: Result, factor: float) -> float:
    """How far [L] the magnified body reaches through the surfaces of `surfaces_of` that are moved as a whole."""
    contact, furthest, problem = result.contact, 0.0, result.problem
    facing = set() if problem is None else {*problem.contacts}
    gap = contact.gap(result.solution.pressure, result.solution.rigid_amplitudes)
    for number in range(len(contact.zone_names)):
        own, nearest = np.flatnonzero(contact.zone == number), _nearest_points(result, number)
        if contact.zone_names[number] in facing:  # two bodies, neither of which is moved as a whole
            furthest = max(furthest, (factor - 1) * float(contact.initial_gap[nearest].max()))
        elif _turn(contact.normals[nearest]) <= TURN:
            moved = contact.initial_gap[own] - contact.normals[own] @ _shift(contact, nearest, 1.0)
            furthest = max(furthest, float((-factor * gap[own] + (factor - 1) * moved).max()))
    return furthest


def _shift(contact: CondensedContact, nearest: IntArray, factor: float) -> Array:
    """Mean gap (2,) [L] along the normals of contact points, times a factor."""
    return factor * (contact.initial_gap[nearest, None] * contact.normals[nearest]).mean(axis=0)


def _nearest_points(result: Result, zone: int) -> IntArray:
    """Contact points of a zone that touch, or the one with the smallest gap."""
    own = np.flatnonzero(result.contact.zone == zone)
    touching = own[result.touching[own]]
    gap = result.contact.gap(result.solution.pressure, result.solution.rigid_amplitudes)
    return touching if len(touching) else own[[int(np.argmin(gap[own]))]]


def _turn(normals: Array) -> float:
    """Largest angle [rad] between normals (k, 2) and their mean direction."""
    mean = normals.mean(axis=0)
    size = float(np.hypot(*mean))
    return float(np.arccos(np.clip(normals @ mean / size, -1, 1)).max()) if size else np.pi


def ground_of(result: Result, zone: int, near: float, factor: float = 1.0) -> Iterator[tuple[Array, Array]]:
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
                yield feet[stretch], contact.normals[stretch]
