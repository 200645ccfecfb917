"""Contact points after they have moved: exact gaps, turned normals, and the levers that forces have there."""

from typing import NamedTuple

import numpy as np

from bemcontact.arrays import Array, BoolArray
from bemcontact.bem.body import Body
from bemcontact.bem.contact_points import ContactPoints
from bemcontact.bem.surface_gaps import SAME_FACE, SurfaceGaps
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.solution import ContactSolution
from bemcontact.problem.surface_lines import Polyline

UNMOVED = 0.01
"""Motion of the place of contact, over the length that is pressed, that may come from the mesh."""


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
    at, displacement = contact.points, _at_points(gaps, points)
    linear = contact.initial_gap + solution.displacement
    still = np.zeros_like(displacement)
    found = Displaced(displacement.copy(), np.zeros(len(at)), linear.copy(), np.zeros(len(at), bool), still)
    for number, zone in enumerate(contact.zone_names):
        if zone not in gaps.surfaces:
            continue
        own = contact.zone == number
        there = gaps.exact(zone, at[own] + displacement[own])
        other = np.sum(there.normals * contact.normals[own], axis=-1) < SAME_FACE
        beyond = there.gap - linear[own]
        grooved = other & (beyond < 0) & isinstance(gaps.surfaces[zone], Polyline)
        found.motion[own] -= gaps.tool_motion(zone, at[own])
        turned = there.normals + gaps.tool_motion(zone, there.normals) - gaps.tool_motion(zone, np.zeros((1, 2)))
        found.turn[own] = np.where(other[:, None], 0.0, turned - contact.normals[own])
        found.change[own] = np.where(grooved, 0.0, beyond)
        found.distance[own], found.other[own] = there.gap, other
    return found


def _at_points(gaps: SurfaceGaps, points: ContactPoints) -> Array:
    """Displacement (n, 2) [L] of the contact points."""
    displacement = np.zeros((len(points.mesh.nodes), 2))
    displacement[points.mesh.elements] = gaps.state.displacement
    return displacement[points.node]


def load_after(
    gaps: SurfaceGaps, body: Body, contact: CondensedContact, solution: ContactSolution, moved: Displaced
) -> Array:
    """Work (k,) in the free motions of what forces gain by the motion: other levers, other directions of pressure."""
    return _load_of_levers(gaps, body, contact, solution) + _load_of_turns(gaps, body, contact, solution, moved)


def _load_of_levers(gaps: SurfaceGaps, body: Body, contact: CondensedContact, solution: ContactSolution) -> Array:
    """Work (k,) in the free motions of the moment -θ Σ r·f that forces gain as they turn with the body by θ.

    Distances r are from the centroid of the area, on which a weight acts. A moment that contact balances by pressure
    that moves by a small part of its length is none: it may come from the mesh.
    """
    mesh, length = body.mesh, body.mesh.tributary[..., None]
    x, u = gaps.state.points - mesh.centroid, gaps.state.displacement
    angle = np.sum(length[..., 0] * (x[..., 0] * u[..., 1] - x[..., 1] * u[..., 0])) / np.sum(length * x**2)
    flux = length * np.sum(x * mesh.normals, axis=-1, keepdims=True)
    r = x - 2 / 3 * np.sum(flux * x, axis=(0, 1)) / flux.sum()
    moment = -angle * float(np.sum(length * gaps.state.traction * r))
    own = contact.weights * (contact.zone == np.arange(len(contact.zone_names))[:, None])
    pressed = own @ (solution.pressure > 0)
    unseen = abs(moment) <= UNMOVED * pressed[pressed > 0].min() * (contact.weights @ solution.pressure)
    return body.seen.body.work_of(np.zeros(2), 0.0 if unseen else moment)


def _load_of_turns(
    gaps: SurfaceGaps, body: Body, contact: CondensedContact, solution: ContactSolution, moved: Displaced
) -> Array:
    """Work (k,) in the free motions of what the pressure gains along the normals of the displaced places."""
    forces = (contact.weights * solution.pressure)[:, None] * moved.turn
    work = body.seen.body.work(contact.points, forces)
    for number, name in enumerate(contact.tools.names):
        zones = [contact.zone_names.index(zone) for zone in gaps.problem.tools[name].zones]
        own = np.isin(contact.zone, zones)
        x, y = (contact.points[own] - contact.tools.point[number]).T
        fx, fy = forces[own].T
        load = np.array([fx.sum(), fy.sum(), (x * fy - y * fx).sum()])
        work = work - load @ contact.tools.amplitudes[3 * number : 3 * number + 3]
    return work
