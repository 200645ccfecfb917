"""Places on edges: those nearest to points, and those where lines through points meet edges."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from bemcontact.arrays import Array, BoolArray, IntArray
from bemcontact.problem.curves import Edge, cross

STEPS = 30
"""Largest number of Newton's steps to the place where a line meets an edge."""
SETTLED = 1e-15
"""Change of the fraction of an edge that is round-off."""
MET = 1e-12
"""Distance between a line and a place, over the length of the edge or the largest coordinate, that is round-off."""


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
    points, normals = np.empty((2, len(edge), 2))
    for i in sorted({*edge.tolist()}):
        on = edge == i
        points[on], normals[on] = edges[i].points(fraction[on]), edges[i].normals(fraction[on])
    return EdgePlaces(edge, fraction, points, normals)


def nearest_on(edges: Sequence[Edge], points: Array) -> EdgePlaces:
    """Places of edges that are nearest to points (k, 2) [L]."""
    fractions = np.array([edge.curve.nearest(points) for edge in edges])
    places = np.array([edge.points(at) for edge, at in zip(edges, fractions, strict=True)])
    number = np.hypot(*np.moveaxis(points - places, 2, 0)).argmin(axis=0)
    return places_at(edges, number, fractions[number, np.arange(len(points))])


def meeting(edges: Sequence[Edge], start: EdgePlaces, points: Array, along: Array) -> tuple[EdgePlaces, BoolArray]:
    """Places where lines through points (k, 2) with unit directions (k, 2) meet edges; which lines (k,) meet one.

    The search begins at a place near each line. A line that misses its edge is looked for on the others.
    """
    edge, fraction, met = start.edge.copy(), start.fraction.copy(), np.zeros(len(points), bool)
    for other in (None, *range(len(edges))):
        rows = np.flatnonzero(~met)
        if other is not None and len(rows):
            edge[rows], fraction[rows] = other, edges[other].curve.nearest(start.points[rows])
        for i in sorted({*edge[rows].tolist()}):
            on = rows[edge[rows] == i]
            fraction[on], met[on] = _on_edge(edges[i], fraction[on], points[on], along[on])
    found = places_at(edges, edge[met], fraction[met])
    return found, met


def _on_edge(edge: Edge, fraction: Array, points: Array, along: Array) -> tuple[Array, BoolArray]:
    """Fractions (k,) of an edge where lines meet it, by Newton's method, and whether they do."""
    for _ in range(STEPS):
        beside = cross(along, points - edge.points(fraction))
        rate = cross(along, edge.directions(fraction)) * edge.length
        moved = fraction + beside / np.where(rate == 0, np.inf, rate)
        moved = moved % 1.0 if edge.start == edge.end else np.clip(moved, 0.0, 1.0)
        done, fraction = np.all(abs(moved - fraction) <= SETTLED), moved
        if done:
            break
    beside = cross(along, points - edge.points(fraction))
    return fraction, abs(beside) <= MET * max(edge.length, abs(points).max(initial=0.0))
