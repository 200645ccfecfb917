"""Edges that touch although their polylines do not."""

from math import cos

import numpy as np

from bemcontact.arrays import Array
from bemcontact.problems.curves import CircularArc, Edge, EllipticArc


def sagitta(edge: Edge) -> float:
    """Largest distance of the polyline of an edge from its curve [L]: chords turn by at most one degree."""
    if not isinstance(edge.curve, CircularArc | EllipticArc):
        return 0.0
    chord = abs(edge.curve.sweep) / (len(edge.polyline()) - 1)
    return max(edge.curve.radii) * (1 - cos(chord / 2))


def near_miss(one: Edge, other: Edge) -> Array | None:
    """Point (2,) of two edges that are as close as their polylines are to the curves; None if they are not.

    Edges that share an end, such as a fillet and its line, come as close as that without a mistake.
    """
    between = 1.01 * (sagitta(one) + sagitta(other))
    if not between or {one.start, one.end} & {other.start, other.end}:
        return None
    lines = one.polyline(), other.polyline()
    distance, point = min(_nearest(*lines), _nearest(*lines[::-1]), key=lambda found: found[0])
    return point if distance <= between else None


def _nearest(corners: Array, line: Array) -> tuple[float, Array]:
    """Least distance of the corners (k, 2) from the sides of a polyline (m, 2), and that corner (2,)."""
    sides = np.diff(line, axis=0)
    offset = corners[:, None] - line[:-1]
    along = np.einsum("kmi,mi->km", offset, sides) / np.einsum("mi,mi->m", sides, sides)
    feet = offset - np.clip(along, 0, 1)[:, :, None] * sides
    distance = np.hypot(feet[..., 0], feet[..., 1]).min(axis=1)
    closest = int(np.argmin(distance))
    return float(distance[closest]), corners[closest]
