"""Which edges of a body can see a rigid surface: contact with no edges named."""

from collections.abc import Collection, Sequence
from typing import NamedTuple

import numpy as np

from bemcontact.arrays import Array, BoolArray
from bemcontact.problems.body_surface import AnyShape, BodySurface, BodyZone
from bemcontact.problems.contact_zone import ContactZone
from bemcontact.problems.curves import Edge, cross
from bemcontact.problems.edge_places import AT_ENDS, places_along
from bemcontact.problems.rigid_surface import DeflectedContour

TURNED = 0.05
"""Cosine between the inward normal of a place and the normal of a surface above which the place is turned to it: a side
that stands on the surface at a right angle is not, nor is it by the kinks of a mesh."""
SAMPLES = 33
"""Number of places of an edge; from those between its ends the surface is looked for."""
ON_THE_WAY = 1e-6
"""Distance of a line of sight from a place and from sides, over the size of the body, that is round-off."""


def turned_to(inward: Array, normals: Array) -> BoolArray:
    """Whether places with inward normals (..., 2) are turned to a surface with unit normals (..., 2) there."""
    return np.sum(inward * normals, axis=-1) > TURNED


def zone_edges(boundary: Sequence[Edge], zone: ContactZone | BodyZone, prescribed: Collection[str]) -> tuple[str, ...]:
    """Names of the edges of a zone; if it names none, those that can see its surface and have no condition."""
    if zone.edges is not None or isinstance(zone, BodyZone) or isinstance(zone.surface, DeflectedContour):
        return zone.edges or ()
    return tuple(name for name in edges_that_see(boundary, zone.surface) if name not in prescribed)


def edges_that_see(boundary: Sequence[Edge], surface: AnyShape) -> tuple[str, ...]:
    """Names of the edges that can touch a surface: from one of their places it is seen past the rest of the body.

    A place sees the surface if it is turned to it and the boundary does not cross the line to the nearest point of the
    surface. So a place behind the surface sees it unless the body is behind it in all its thickness there. The side of
    a body may be narrow beside an edge: places that are opposite to it are among those of the edge.
    """
    side = places_along(surface.edges).points if isinstance(surface, BodySurface) else np.zeros((0, 2))
    fractions = np.linspace(0, 1, SAMPLES)
    outline = [edge.points(fractions) for edge in boundary]
    starts, ends = [line[:-1] for line in outline], [line[1:] for line in outline]
    sides = _OutlineSides(np.concatenate(starts), np.concatenate(ends))
    size = float(np.hypot(*np.ptp(np.concatenate(outline), axis=0)))
    seeing = []
    for edge, line in zip(boundary, outline, strict=True):
        opposite = edge.curve.nearest(side).clip(AT_ENDS, 1 - AT_ENDS)
        places = np.concatenate([line[1:-1], edge.points(opposite)])
        gap, normals = surface.closest(places)
        turned = turned_to(-edge.normals(np.append(fractions[1:-1], opposite)), normals)
        feet = places - gap[:, None] * normals
        if not _blocked(places[turned], feet[turned], sides, ON_THE_WAY * size).all():
            seeing.append(edge.name)
    return tuple(seeing)


class _OutlineSides(NamedTuple):
    """Straight pieces of the boundary, from starts (k, 2) to ends (k, 2) [L]."""

    starts: Array
    ends: Array


def _blocked(places: Array, feet: Array, sides: _OutlineSides, near: float) -> BoolArray:
    """Whether a side crosses the line from each place (q, 2), and farther than `near` from it, to its foot (q, 2)."""
    way, along = feet - places, sides.ends - sides.starts
    offset = sides.starts - places[:, None]
    turn = cross(way[:, None], along)
    with np.errstate(divide="ignore", invalid="ignore"):
        on_way, on_side = cross(offset, along) / turn, cross(offset, way[:, None]) / turn
        away = near / np.hypot(*way.T)[:, None]
    between = (on_way > away) & (on_way < 1 + away)
    return np.any(between & (on_side >= -ON_THE_WAY) & (on_side <= 1 + ON_THE_WAY), axis=1)
