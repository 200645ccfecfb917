"""Places of the second body of a contact inside the first one, on edges that the contact does not have.

Elements of the first side are compared with the surface of the second one, as far as the contact has it: edges of the
second body that are not named, and what is narrower than these elements, would be missed.
"""

from typing import NamedTuple

import numpy as np

from bemcontact.arrays import Array
from bemcontact.bem import reference_element
from bemcontact.bem.surface_gaps import FLUSH, SurfaceGaps
from bemcontact.problems.bodies import named_loops
from bemcontact.problems.body_surface import BodySurface

SAMPLES = np.linspace(0.0, 1.0, 33)
"""Fractions of the edges of a rigid body at which it is compared; of an elastic one these are the nodes."""


class Inside(NamedTuple):
    """A place of the second body inside the first one: depth [L], place (2,) as drawn [L], and its edge."""

    depth: float
    at: Array
    edge: str


def deepest_inside(gaps: SurfaceGaps, zone: str) -> Inside | None:
    """Deepest place on an edge of the second body that no contact of both bodies has; None if there is no such edge.

    A place counts that is outside as drawn. One does not that is nearest to a corner of the first body, beside which it
    may slide, or that is nearer to an end of contact on its own body than both slide.
    """
    problem, surface = gaps.problem, gaps.surfaces[zone]
    if not isinstance(surface, BodySurface) or (first := problem.part_of(problem.edges_of(zone)[0])) == surface.body:
        return None
    places = _places(gaps, zone, surface)
    if not places:
        return None
    edges = [name for name, points, _ in places for _ in points]
    points, moved = (np.concatenate(part) for part in zip(*(item[1:] for item in places), strict=True))
    loops = named_loops(problem.boundary_of(first), first)
    own = tuple(edge for loop in loops for edge in loop)
    feet = BodySurface(body=first, elastic=True, edges=own, loops=loops).feet(points)
    element, xi = gaps.outline.elements_at([edge.name for edge in own], feet.edge, feet.fraction)
    there = np.einsum("ki,kix->kx", reference_element.values(xi), gaps.state.displacement[element])
    depth = -(feet.gap + np.sum(feet.normals * (moved - there), axis=1))
    depth[feet.at_corner | (feet.gap < -FLUSH * problem.size)] = -np.inf
    for corner in surface.ridges:
        depth[np.hypot(*(points - corner).T) <= np.hypot(*(moved - there).T)] = -np.inf
    i = int(depth.argmax())
    return Inside(float(depth[i]), points[i], edges[i])


def _places(gaps: SurfaceGaps, zone: str, surface: BodySurface) -> list[tuple[str, Array, Array]]:
    """Edges of the second body without contact with the first one, places (k, 2) [L] and their displacements (k, 2)."""
    problem, state = gaps.problem, gaps.state
    both, touched = frozenset(problem.sides_of(zone)), set[str]()
    for contact in problem.contacts:
        other = problem.zones[contact].surface
        if frozenset(problem.sides_of(contact)) == both and isinstance(other, BodySurface):
            touched |= {*problem.edges_of(contact)}
            touched |= {other.edges[part.onto].name for part in problem.opposite(contact)}
    found = list[tuple[str, Array, Array]]()
    for edge in (edge for loop in surface.loops for edge in loop if edge.name not in touched):
        if surface.elastic:
            own = np.array(state.edge_names)[state.edge] == edge.name
            found.append((edge.name, state.points[own].reshape(-1, 2), state.displacement[own].reshape(-1, 2)))
        else:
            points = edge.points(SAMPLES)
            found.append((edge.name, points, gaps.tool_motion(zone, points + surface.way.step)))
    return found
