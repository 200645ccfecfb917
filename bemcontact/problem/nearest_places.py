"""Where an edge of the body is nearest to a rigid surface."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from bemcontact.arrays import Array
from bemcontact.problem.bodies import SEPARATOR
from bemcontact.problem.body_surface import AnyShape, AnySurface, BodySurface, BodyZone
from bemcontact.problem.curves import Curve, Edge
from bemcontact.problem.edge_places import STEEPEST, TIE, places_along
from bemcontact.problem.surface_lines import Polyline
from bemcontact.problem.validation import Point
from bemcontact.problem.visibility import turned_to

SAMPLES = 800
"""Samples of an edge."""
FOCUS = 6
"""Times that the samples are made finer about a least gap, each by a fifth."""
ACCURACY = 1e-7
"""Accuracy of a place, over the length of the edge."""
AT_END = 1e-6
"""Distance over the length of an edge up to which a place is an end of it."""
FEW = 200
"""Samples of an edge in the search for the places that are as near as the nearest one."""
FLUSH = 1e-9
"""Distance over the extent of the edges up to which another body touches."""
AS_NEAR = 1e-3
"""Part of the least gap by which that of a place may be larger, for the place to be as near."""
APART = 0.2
"""Ratio of the singular values of normals from which these have two directions."""
NEARLY = 0.01
"""Part of the least gap that may be left at such a place."""


def nearest_places(curve: Curve, surface: AnyShape) -> tuple[float, ...]:
    """Fractions of the length inside an edge where the initial gap is locally least, to `ACCURACY`.

    A smooth surface remembers them: each mesh of a search asks again.
    """
    if isinstance(surface, Polyline):
        return _nearest_places(curve, surface)
    if curve not in surface.nearest:
        surface.nearest[curve] = _nearest_places(curve, surface)
    return surface.nearest[curve]


def _nearest_places(curve: Curve, surface: AnyShape) -> tuple[float, ...]:
    """Find the places among samples, and then among finer ones beside each."""
    at, step = np.union1d(np.linspace(0, 1, SAMPLES + 1), _opposite_places(curve, surface)), 1 / SAMPLES
    gap = gaps(curve, surface, at)
    middle = at[1:-1][(gap[1:-1] <= gap[:-2]) & (gap[1:-1] < gap[2:])]
    ends = np.array([step / 2, 1 - step / 2])[[gap[0] <= gap[1], gap[-1] <= gap[-2]]]
    middle = np.concatenate([middle, ends])
    for _ in range(FOCUS):
        fine = np.clip(middle[:, None] + step * np.linspace(-1, 1, 21), 0, 1)
        middle, step = fine[np.arange(len(fine)), gaps(curve, surface, fine).argmin(axis=1)], step / 5
    return tuple(middle[np.minimum(middle, 1 - middle) > ACCURACY].tolist())


def _opposite_places(curve: Curve, surface: AnyShape) -> Array:
    """Fractions of the length of an edge that are nearest to places of a body: a narrow one is between samples."""
    return curve.nearest(places_along(surface.edges).points) if isinstance(surface, BodySurface) else np.zeros(0)


def gaps(curve: Curve, surface: AnyShape, fractions: Array) -> Array:
    """Initial gap [L] at fractions of the length of an edge, of any shape; beyond its ends that of the ends."""
    return surface.closest(curve.at(np.clip(fractions, 0, 1).ravel())).gap.reshape(fractions.shape)


def approach(edges: Sequence[Edge], surface: BodySurface) -> Point:
    """Displacement [L] of another body that makes it touch edges where it is nearest as drawn.

    It is zero where it touches already, and where no displacement makes it touch at all places that are as near: a pin
    that is drawn in the middle of its hole may come to touch anywhere.
    """
    samples = np.linspace(0, 1, FEW + 1)
    at = [
        np.concatenate([samples, _opposite_places(edge.curve, surface), nearest_places(edge.curve, surface)])
        for edge in edges
    ]
    points = np.vstack([edge.points(own) for edge, own in zip(edges, at, strict=True)])
    outward = np.vstack([edge.normals(own) for edge, own in zip(edges, at, strict=True)])
    feet = surface.feet(points)
    facing = (np.sum(outward * feet.normals, axis=1) < -STEEPEST - TIE) & ((feet.gap > 0) | ~feet.corner)
    gap, normals = feet.gap[facing], feet.normals[facing]
    least = float(gap.min(initial=np.inf))
    if not FLUSH * np.ptp(points, axis=0).max() < abs(least) < np.inf:
        return 0.0, 0.0
    near = gap <= least + AS_NEAR * abs(least)
    moved, _, _, values = np.linalg.lstsq(normals[near], gap[near])
    if values[-1] < APART * values[0]:
        moved = least * normals[gap.argmin()]
    touches = abs(normals[near] @ moved - gap[near]).max() <= NEARLY * abs(least)
    return (float(moved[0]), float(moved[1])) if touches else (0.0, 0.0)


def approached(zones: Mapping[str, BodyZone], edges: Mapping[str, Edge]) -> Iterator[tuple[str, BodyZone]]:
    """Zones of bodies that touch other elastic ones, moved there as drawn: by name, with all edges by name.

    What one contact states, several may state, each with some of the edges, whichever side is the first: so all that
    meet on both bodies are moved by one displacement.
    """
    sides = {
        name: (tuple(edges[edge] for edge in zone.edges), zone.surface.edges)
        for name, zone in zones.items()
        if zone.surface.first
    }
    moved: dict[str, Point] = {}
    for name, (own, other) in sides.items():
        if name in moved:
            continue
        group, signs = {name: (own, other)}, {name: 1.0}
        for _ in sides:
            for more, pair in sides.items():
                for sign, (one, two) in ((1.0, pair), (-1.0, pair[::-1])):
                    met = (_meet(one, its) and _meet(two, theirs) for its, theirs in group.values())
                    if more not in group and any(met):
                        group[more], signs[more] = (one, two), sign
        first, second = (tuple(dict.fromkeys(edge for pair in group.values() for edge in pair[i])) for i in (0, 1))
        x, y = approach(first, replace(zones[name].surface, edges=second, nearest={}))
        moved |= {each: (sign * x, sign * y) for each, sign in signs.items()}
    for name, zone in zones.items():
        yield name, replace(zone, surface=replace(zone.surface, approach=moved.get(name, (0.0, 0.0))))


def _meet(edges: Sequence[Edge], others: Sequence[Edge]) -> bool:
    """Whether edges and others have one in common, or go on in one another, on one body."""
    return any(
        one.name == other.name
        or (one.name.partition(SEPARATOR)[0] == other.name.partition(SEPARATOR)[0] and one.end == other.start)
        for first, second in ((edges, others), (others, edges))
        for one in first
        for other in second
    )


class SurfaceCorner(NamedTuple):
    """Where an edge is nearest to a corner of a polyline.

    Parameters
    ----------
    fraction : of the length of the edge
    turn : angle by which the polyline turns away from the body [rad]
    """

    fraction: float
    turn: float


def surface_corners(edge: Edge, surface: AnySurface, *, at_ends: bool = False) -> Iterator[SurfaceCorner]:
    """Where an edge is nearest to a corner of a polyline, if that is inside or, if wanted, right at an end.

    Also where it is nearest to a corner of another body inside.
    """
    if isinstance(surface, BodySurface):
        yield from _corners_of_body(edge, surface)
    if not isinstance(surface, Polyline):
        return
    for corner, turn in zip(surface.points[1:-1], surface.turns.tolist(), strict=True):
        fraction = edge.curve.fraction_at(corner)
        if AT_END < fraction < 1 - AT_END or (at_ends and _is_opposite(edge, round(fraction), corner)):
            yield SurfaceCorner(fraction, turn)


def _corners_of_body(edge: Edge, surface: BodySurface) -> Iterator[SurfaceCorner]:
    """Where an edge is nearest to a corner of a body, to both sides of which it is turned there."""
    for corner, normals, _ in surface.joints:
        fraction = edge.curve.nearest(corner[None])
        if AT_END < fraction[0] < 1 - AT_END and turned_to(-edge.normals(fraction), normals).all():
            (x, y), (u, v) = normals
            yield SurfaceCorner(float(fraction[0]), float(np.arctan2(x * v - y * u, x * u + y * v)))


def _is_opposite(edge: Edge, end: int, corner: Point) -> bool:
    """Whether a corner is opposite to an end of an edge."""
    at = np.array([float(end)])
    return abs(float((np.array(corner) - edge.points(at)[0]) @ edge.directions(at)[0])) < AT_END * edge.length
