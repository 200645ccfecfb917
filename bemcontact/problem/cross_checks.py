"""Checks of the geometry of a problem as a whole: the mesh on its curves, and the rigid surfaces beside them."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from math import degrees, radians

import numpy as np

from bemcontact.errors import Issue, KeyPath
from bemcontact.problem.boundary import Boundary
from bemcontact.problem.contact_zone import ContactZone
from bemcontact.problem.curves import Edge
from bemcontact.problem.geometry import MOST_ELEMENTS
from bemcontact.problem.rigid_surface import Circle, DeflectedContour, Plane, Polyline, RigidSurface, Shape, Spline

LARGEST_TURNING = radians(60)
"""Largest angle by which a quadratic element may turn: beyond it the element strays visibly from its arc."""

ALONG = 0.5
"""Cosine between two normals above which they point the same way, for an edge that should face its surface."""


def mesh_issues(boundary: Boundary, path: KeyPath, refine: int) -> list[Issue]:
    """Check that elements are neither too many for a dense matrix, nor too few for the curves.

    Parameters
    ----------
    boundary : with the elements of each edge
    path : path of keys to it
    refine : number of parts into which each of them is cut
    """
    total = refine * sum(edge.elements for edge in boundary.edges)
    if total > MOST_ELEMENTS:
        message = f"{total} elements are more than a dense matrix can hold; take at most {MOST_ELEMENTS}"
        return [Issue(path=("mesh", "refine") if refine > 1 else path, message=message)]
    return [
        Issue(path=(*path, *place, "elements"), message=_turns_too_much(edge, refine))
        for edge, place in _placed_edges(boundary)
        if edge.turning(refine) > LARGEST_TURNING * (1 + 1e-9)
    ]


def _placed_edges(boundary: Boundary) -> Iterator[tuple[Edge, KeyPath]]:
    """List all edges with their paths in the boundary."""
    for path, loop in zip(boundary.loop_paths, boundary.loops, strict=True):
        for i, edge in enumerate(loop):
            yield edge, (*path, i)


def _turns_too_much(edge: Edge, refine: int) -> str:
    """Say by how much one element turns, and how many elements there should be."""
    limit = f"{degrees(LARGEST_TURNING):.0f}"
    found = f"too few elements for the bend: one of '{edge.name}' turns by {degrees(edge.turning(refine)):.0f} degrees"
    for elements in range(edge.elements + 1, edge.elements + 200):
        if replace(edge, elements=elements).turning(refine) <= LARGEST_TURNING * (1 + 1e-9):
            return f"{found}, more than {limit}; give it {elements} elements or more"
    return f"{found}, more than {limit}; give it more elements, and grade them towards the bend"


def facing_issues(boundary: Boundary, zones: Mapping[KeyPath, ContactZone]) -> list[Issue]:
    """Check that the normal of each rigid surface points into the body, where they are closest to each other.

    The direction of a deflected contour, which is close to its own body, must nowhere point out of it.

    Parameters
    ----------
    boundary : with the edges of the zones
    zones : contact zones by their path of keys
    """
    edges = {edge.name: edge for edge in boundary.edges}
    issues = []
    for path, zone in zones.items():
        members = [edges[name] for name in zone.edges]
        if isinstance(zone.surface, DeflectedContour):
            cosine, name = max((_outward(edge, zone.surface), edge.name) for edge in members)
        else:
            _, cosine, name = min((*_facing(edge, zone.surface), edge.name) for edge in members)
        if cosine > ALONG:
            issues.append(Issue(path=(*path, "surface"), message=_faces_away(name, zone.surface)))
    return issues


def _facing(edge: Edge, surface: Shape) -> tuple[float, float]:
    """Least distance of an edge from a surface, and the cosine between its outward and the surface's normal there."""
    fractions = np.linspace(0, 1, 8 * edge.elements + 1)
    gap, normals = surface.closest(edge.points(fractions))
    cosine = np.einsum("ki,ki->k", normals, edge.normals(fractions))
    closest = np.argmin(np.abs(gap))
    return float(np.abs(gap[closest])), float(cosine[closest])


def _outward(edge: Edge, surface: DeflectedContour) -> float:
    """Largest cosine between an outward normal and the direction: a contour may be near to any point of the edge."""
    return float((edge.normals(np.linspace(0, 1, 8 * edge.elements + 1)) @ surface.unit_direction).max())


def _faces_away(edge: str, surface: RigidSurface) -> str:
    """Say how the surface is to be turned round."""
    match surface:
        case Plane():
            x, y = surface.normal
            way_out = f"turn the normal round: [{0 - x:g}, {0 - y:g}]"
        case Circle():
            way_out = f"is the body {'inside' if surface.body == 'outside' else 'outside'} the circle?"
        case Polyline() | Spline():
            way_out = "list its points in the opposite order, so that the body is on their left"
        case DeflectedContour():
            x, y = surface.direction
            way_out = f"turn the direction round: [{0 - x:g}, {0 - y:g}], or make the zone smaller"
    rule = "the rigid surface's normal must point from the surface into the body"
    return f"{rule}, but at '{edge}' it points out of it; {way_out}"
