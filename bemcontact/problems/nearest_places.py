"""Where an edge of the body is nearest to a surface."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from bemcontact.arrays import Array
from bemcontact.problems.body_surface import AnyShape, AnySurface, BodySurface
from bemcontact.problems.curves import Curve, Edge
from bemcontact.problems.edge_places import places_along
from bemcontact.problems.surface_lines import Polyline
from bemcontact.problems.validation import Point
from bemcontact.problems.visibility import turned_to

SAMPLES = 800
"""Samples of an edge."""
FOCUS = 6
"""Times that the samples are made finer about a least gap, each by a fifth."""
ACCURACY = 1e-7
"""Accuracy of a place, over the length of the edge."""
ROUND_OFF = 1e-14
"""Difference of two gaps over the largest coordinate that is none: along a parallel surface no place is nearest."""
AT_END = 1e-6
"""Distance over the length of an edge up to which a place is an end of it."""


def nearest_places(curve: Curve, surface: AnyShape) -> tuple[float, ...]:
    """Fractions of the length inside an edge where the gap of a surface after its way is locally least, to `ACCURACY`.

    A smooth surface remembers them: each mesh of a search asks again.
    """
    if isinstance(surface, Polyline):
        return _nearest_places(curve, surface)
    key = curve, surface.way
    if (found := surface.nearest.get(key)) is None:
        found = surface.nearest[key] = _nearest_places(curve, surface)
    return found


def _nearest_places(curve: Curve, surface: AnyShape) -> tuple[float, ...]:
    """Find the places among samples, and then among finer ones beside each."""
    at, step = np.union1d(np.linspace(0, 1, SAMPLES + 1), opposite_places(curve, surface)), 1 / SAMPLES
    gap, same = gaps(curve, surface, at), ROUND_OFF * float(np.abs(curve.at(at)).max())
    falls, rises = np.diff(gap) < -same, np.diff(gap) > same
    middle = at[1:-1][(falls[:-1] & ~falls[1:]) | (~rises[:-1] & rises[1:])]  # both ends of what is parallel
    inside = np.array([~falls[0] & rises[:2].any(), ~rises[-1] & falls[-2:].any()])
    ends = np.array([step / 2, 1 - step / 2])[inside]
    middle = np.concatenate([middle, ends])
    for _ in range(FOCUS):
        fine = np.clip(middle[:, None] + step * np.linspace(-1, 1, 21), 0, 1)
        gap = gaps(curve, surface, fine)
        least = gap <= gap.min(axis=1, keepdims=True) + same
        first, last = least.argmax(axis=1), least.shape[1] - 1 - least[:, ::-1].argmax(axis=1)
        middle, step = fine[np.arange(len(fine)), (first + last) // 2], step / 5
    return tuple(middle[np.minimum(middle, 1 - middle) > ACCURACY].tolist())


def opposite_places(curve: Curve, surface: AnyShape) -> Array:
    """Fractions of the length of an edge that are nearest to places of a body: a narrow one is between samples."""
    return (
        curve.nearest(surface.way.forth(places_along(surface.edges).points))
        if isinstance(surface, BodySurface)
        else np.zeros(0)
    )


def gaps(curve: Curve, surface: AnyShape, fractions: Array) -> Array:
    """Gap [L] after its way at fractions of the length of an edge, of any shape; beyond its ends that of the ends."""
    places = surface.way.back(curve.at(np.clip(fractions, 0, 1).ravel()))
    return surface.closest(places).gap.reshape(fractions.shape)


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
    corners = surface.way.forth(np.array(surface.points)[1:-1])
    for (x, y), turn in zip(corners.tolist(), surface.turns.tolist(), strict=True):
        fraction = edge.curve.fraction_at((x, y))
        if AT_END < fraction < 1 - AT_END or (at_ends and _is_opposite(edge, round(fraction), (x, y))):
            yield SurfaceCorner(fraction, turn)


def _corners_of_body(edge: Edge, surface: BodySurface) -> Iterator[SurfaceCorner]:
    """Where an edge is nearest to a corner of a body, to both sides of which it is turned there."""
    for corner, normals, _ in surface.joints:
        fraction = edge.curve.nearest(surface.way.forth(corner[None]))
        inward = surface.way.turned(-edge.normals(fraction), -1.0)
        if AT_END < fraction[0] < 1 - AT_END and turned_to(inward, normals).all():
            (x, y), (u, v) = normals
            yield SurfaceCorner(float(fraction[0]), float(np.arctan2(x * v - y * u, x * u + y * v)))


def _is_opposite(edge: Edge, end: int, corner: Point) -> bool:
    """Whether a corner is opposite to an end of an edge."""
    at = np.array([float(end)])
    return abs(float((np.array(corner) - edge.points(at)[0]) @ edge.directions(at)[0])) < AT_END * edge.length
