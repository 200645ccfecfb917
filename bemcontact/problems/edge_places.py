"""Places on edges: those nearest to points, and those that share a normal with points of another boundary."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from bemcontact.arrays import Array, BoolArray, IntArray, magnitudes
from bemcontact.problems.curves import Edge, Segment, cross, inner, right_of

STEEPEST = 0.5
"""Cosine of the angle between two boundaries from which they may form pairs: small displacements close no wider one."""
TIE = 1e-9
"""Difference of a cosine from it that is round-off: boundaries at exactly this angle form no pairs, on any side."""
CORNER = 1e-6
"""Sine of the angle between two edges from which their joint is a corner."""
STEPS = 20
"""Largest number of Newton's steps to a pair: the largest turns take eleven over half a circle."""
SETTLED = 1e-9
"""Change of the fraction of an edge by one of them after which the next one is round-off."""
LARGEST_TURN = 0.3
"""Largest turn of the normal of an edge by one step [rad]."""
AHEAD = 1e-5
"""Fraction of an edge over which the turn of its normal is measured."""
MET = 1e-12
"""Distance of a point from the normal of its pair, over the length of the edge or a coordinate, that is round-off."""

FLUSH = 1e-9
"""Distance over the length of a straight edge by which others are ahead of it if that is round-off."""
AT_ENDS = 1e-12
"""Distance from both ends of an edge, over its length, of the places that are taken for them: they have its normal."""
PARTS = 8
"""Parts of an edge between whose ends its places are looked at."""


class EdgePlaces(NamedTuple):
    """Places of edges.

    Parameters
    ----------
    edge : (k,) number of the edge
    fraction : (k,) of its length
    points : (k, 2) [L]
    normals : (k, 2) outward unit normals
    """

    edge: IntArray
    fraction: Array
    points: Array
    normals: Array


def places_at(edges: Sequence[Edge], edge: IntArray, fraction: Array) -> EdgePlaces:
    """Places at fractions (k,) of the length of edges with these numbers (k,)."""
    points = np.empty((len(edge), 2))
    for i, on in _by_edge(edge):
        points[on] = edges[i].points(fraction[on])
    return EdgePlaces(edge, fraction, points, normals_at(edges, edge, fraction))


def normals_at(edges: Sequence[Edge], edge: IntArray, fraction: Array) -> Array:
    """Outward unit normals (k, 2) at fractions (k,) of the length of edges with these numbers (k,)."""
    normals = np.empty((len(edge), 2))
    for i, on in _by_edge(edge):
        normals[on] = edges[i].normals(fraction[on])
    return normals


def _by_edge(edge: IntArray) -> Iterator[tuple[int, IntArray | slice]]:
    """Each of the numbers (k,), and where it is."""
    numbers = sorted({*edge.tolist()})
    if len(numbers) == 1:
        yield numbers[0], slice(None)
    else:
        yield from ((i, np.flatnonzero(edge == i)) for i in numbers)


def places_along(edges: Sequence[Edge]) -> EdgePlaces:
    """Both ends of edges and places between them, one edge after the other."""
    at = np.clip(np.linspace(0.0, 1.0, PARTS + 1), AT_ENDS, 1 - AT_ENDS)
    return places_at(edges, np.repeat(np.arange(len(edges)), len(at)), np.tile(at, len(edges)))


def nearest_on(edges: Sequence[Edge], points: Array) -> EdgePlaces:
    """Places of edges that are nearest to points (k, 2) [L]."""
    number, fraction, places = nearest_points(edges, points)
    return EdgePlaces(number, fraction, places, normals_at(edges, number, fraction))


def nearest_points(edges: Sequence[Edge], points: Array) -> tuple[IntArray, Array, Array]:
    """Points (k, 2) of edges that are nearest to points (k, 2) [L], by numbers (k,) of the edges and fractions (k,)."""
    fractions = [edge.curve.nearest(points) for edge in edges]
    places = [edge.points(at) for edge, at in zip(edges, fractions, strict=True)]
    if len(edges) == 1:
        return np.zeros(len(points), int), fractions[0], places[0]
    number = np.array([magnitudes(points - there) for there in places]).argmin(axis=0)
    own = number, np.arange(len(points))
    return number, np.array(fractions)[own], np.array(places)[own]


def curvatures(edges: Sequence[Edge], places: EdgePlaces) -> Array:
    """Curvature (k,) [1/L] of edges at places, positive where the body is convex."""
    found = np.empty(len(places.edge))
    for i, on in _by_edge(places.edge):
        at, curve = places.fraction[on], edges[i].curve
        ahead = np.where(at > 0.5, -AHEAD, AHEAD)
        found[on] = (curve.tangent_angle(at + ahead) - curve.tangent_angle(at)) / (ahead * curve.length)
    return found


def rests_on_flat(edges: Sequence[Edge], others: Sequence[Edge]) -> bool:
    """Whether a straight edge is what is first to touch others, and all others that face these edges are parallel."""
    own = places_along(edges)
    for edge in edges:
        if not isinstance(edge.curve, Segment):
            continue
        frame = np.stack([edge.directions(np.array([0.5]))[0], edge.normals(np.array([0.5]))[0]])
        along, ahead = frame @ own.points[own.normals @ frame[1] > STEEPEST].T
        if ahead.max() - frame[1] @ edge.start > FLUSH * edge.length:
            continue
        facing = list[bool]()
        for other in others:
            places = places_along((other,))
            at, turned = places.points @ frame[0], places.normals @ frame[1] < -STEEPEST
            if turned.any() and at.max() > along.min() and at.min() < along.max():
                facing.append(
                    isinstance(other.curve, Segment) and bool(abs(cross(frame[1], places.normals[0])) <= CORNER)
                )
        if facing and all(facing):
            return True
    return False


class NormalWeight(NamedTuple):
    """Weight of the normals of a boundary in common ones: none at its corners, where it has two, and little beside.

    Parameters
    ----------
    most : the largest weight
    corners : (j, 3) x, y of corners [L], and the distance [L] from which they do not matter
    """

    most: float
    corners: Array

    def at(self, points: Array) -> Array:
        """Weight (k,) at points (k, 2) [L]."""
        if not len(self.corners):
            return np.full(len(points), self.most)
        away = magnitudes(points[:, None] - self.corners[:, :2]) / self.corners[:, 2]
        return self.most * np.prod(1 - (1 - np.minimum(away, 1.0) ** 2) ** 4, axis=1)


def bent_joints(edges: Sequence[Edge], others: Sequence[Edge]) -> Array:
    """Corners (j, 3) between two edges both of which face other edges there, with the length of the shorter edge."""
    found = []
    for before in edges:
        for after in edges:
            normals = np.concatenate([before.normals(np.ones(1)), after.normals(np.zeros(1))])
            if before.end == after.start and abs(cross(*normals)) > CORNER:
                facing = nearest_on(others, np.array([before.end])).normals
                if (normals @ facing[0] < -STEEPEST - TIE).all():
                    found.append((*before.end, min(before.length, after.length)))
    return np.array(found).reshape(-1, 3)


def paired_on(
    edges: Sequence[Edge], start: EdgePlaces, points: Array, own: Array, weights: tuple[NormalWeight, NormalWeight]
) -> tuple[EdgePlaces, Array, BoolArray]:
    """Places that form pairs with points (k, 2) [L]: each point is on the common normal of both boundaries there.

    The common normal is the mean of the normal `own` (k, 2) into the body of the point and of that of the place, with
    the weights of both boundaries. The search begins at a place near the pair. Where no place on its edge forms one,
    the other edges are looked at.

    Returns
    -------
    the places (j,), the common normals (j, 2), and which points (k,) have a pair
    """
    edge, fraction, met = start.edge.copy(), start.fraction.copy(), np.zeros(len(points), bool)
    weighted, other_weight = weights[0].at(points)[:, None] * own, weights[1]
    for other in (None, *range(len(edges))):
        rows = np.flatnonzero(~met if other is None else ~met & (start.edge != other))
        if other is not None and len(rows):
            edge[rows], fraction[rows] = other, edges[other].curve.nearest(start.points[rows])
        for i, some in _by_edge(edge[rows]) if len(rows) else ():
            on = rows[some]
            fraction[on], on_normal = _on_edge(edges[i], fraction[on], points[on], weighted[on], other_weight)
            met[on] = on_normal & (inner(own[on], edges[i].normals(fraction[on])) > 0)
    found = places_at(edges, edge[met], fraction[met])
    return found, _common(weighted[met], found.normals, other_weight.at(found.points)), met


def _common(own: Array, other: Array, weight: Array) -> Array:
    """Common unit normals (k, 2) of weighted ones and of others with weights; the latter where both are opposite."""
    mean = own + weight[:, None] * other
    size = magnitudes(mean)[:, None]
    if size.all():
        return mean / size
    return np.where(size > 0, mean / np.where(size > 0, size, 1.0), other)


def _on_edge(edge: Edge, fraction: Array, points: Array, own: Array, weight: NormalWeight) -> tuple[Array, BoolArray]:
    """Fractions (k,) of pairs on an edge by Newton's method, and which of them are pairs."""
    fraction, left, length = fraction.copy(), np.arange(len(points)), edge.length
    for _ in range(STEPS):
        at, mine = fraction[left], own[left]
        ahead, k = np.where(at > 0.5, -AHEAD, AHEAD), len(at)
        both = np.concatenate([at, at + ahead])
        places, along = edge.points(both), edge.directions(both)
        normals, offset, weights = right_of(along), points[left] - places[:k], weight.at(places)
        common = _common(mine, normals[:k], weights[:k])
        turn = cross(common, _common(mine, normals[k:], weights[k:])) / ahead
        rate = cross(common, along[:k]) * length + turn * inner(common, offset)
        most = LARGEST_TURN * AHEAD / np.maximum(abs(cross(normals[:k], normals[k:])), LARGEST_TURN * AHEAD)
        rate[rate == 0] = np.inf
        step = np.minimum(np.maximum(cross(common, offset) / rate, -most), most)
        moved = (at + step) % 1.0 if edge.start == edge.end else np.minimum(np.maximum(at + step, 0.0), 1.0)
        fraction[left] = moved
        left = left[abs(moved - at) > SETTLED]
        if not len(left):
            break
    places = edge.points(fraction)
    off = cross(_common(own, edge.normals(fraction), weight.at(places)), points - places)
    return fraction, abs(off) <= MET * max(edge.length, abs(points).max(initial=0.0))
