"""Which parts of the edges of two elastic bodies are opposite to each other."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from bemcontact.arrays import Array, BoolArray, IntArray
from bemcontact.problem.body_surface import BodySurface, Feet
from bemcontact.problem.curves import Edge
from bemcontact.problem.visibility import turned_to

SAMPLES = 512
"""Samples of an edge between which it has at most one end of an opposite part."""
SECTIONS = 16
"""Sections into which the part of an edge with such an end is cut at a time."""
CUTS = 15
"""Times that it is cut: then it is as short as round-off."""
HALF = 0.5
"""Difference of fractions of an edge between two samples from which its end is between them."""
INSIDE = 1e-9
"""Distance from an end of the edge, over its length, where the end is looked at."""
SHORTEST = 1e-6
"""Least length of an opposite part over that of its edge: shorter ones are round-off of coordinates and corners."""
SAME = 1e-12
"""Difference of two fractions of an edge that is round-off."""


class OppositePart(NamedTuple):
    """A part of an edge of the first body that forms pairs with one edge of the second body.

    Parameters
    ----------
    edge : name of the edge
    low, high : fractions of its length between which it is
    onto : number of the opposite edge in the surface
    """

    edge: str
    low: float
    high: float
    onto: int


def opposite_parts(edges: Sequence[Edge], surface: BodySurface, reach: float = np.inf) -> list[OppositePart]:
    """Parts of edges opposite to a surface, in order, no farther from it than the nearest place and a reach [L].

    A place is opposite to the surface if it is turned to it and forms a pair with a place there. That of a rigid
    surface may be a corner both sides of which the place is turned to.
    """
    most = _largest_gap(edges, surface, reach)
    return [part for edge in edges for part in _parts_of(edge, surface, most)]


def _largest_gap(edges: Sequence[Edge], surface: BodySurface, reach: float) -> float:
    """Gap [L] up to which places of edges are opposite to a surface."""
    if not np.isfinite(reach):
        return np.inf
    at = np.linspace(0.0, 1.0, SAMPLES + 1)
    return min((float(surface.feet(edge.points(at)).gap.min()) for edge in edges), default=0.0) + reach


def _is_blunt(inward: Array, feet: Feet, surface: BodySurface) -> BoolArray:
    """Whether places with normals (k, 2) into their body are turned to both sides of corners of a surface."""
    return np.all(turned_to(inward[:, None], surface.beside(feet)), axis=1)


def _parts_of(edge: Edge, surface: BodySurface, most: float) -> list[OppositePart]:
    """Opposite parts of one edge, up to a gap [L]."""

    def opposite(at: Array) -> tuple[IntArray, Array]:
        feet = surface.pairs(edge.points(at), -edge.normals(at))
        turned = turned_to(-edge.normals(at), feet.normals)
        one = ~feet.corner
        if not surface.elastic and feet.corner.any():
            one |= _is_blunt(-edge.normals(at), feet, surface)
        return np.where(turned & one & (feet.gap <= most), feet.edge, -1), feet.fraction

    at = np.linspace(0.0, 1.0, SAMPLES + 1)
    onto, there = opposite(np.clip(at, INSIDE, 1 - INSIDE))  # on a corner of the surface two edges are nearest
    changes = np.flatnonzero((np.diff(onto) != 0) | (abs(np.diff(there)) > HALF))
    starts, ends = [(0.0, int(onto[0]))], []
    for i in changes.tolist():
        low, high = float(at[i]), float(at[i + 1])
        ends.append(_last(opposite, low, high, int(onto[i]), float(there[i])))
        starts.append((_last(opposite, high, low, int(onto[i + 1]), float(there[i + 1])), int(onto[i + 1])))
    ends.append(1.0)
    return [
        OppositePart(edge.name, low, high, number)
        for (low, number), high in zip(starts, ends, strict=True)
        if number >= 0 and high - low > SHORTEST
    ]


def _last(
    opposite: Callable[[Array], tuple[IntArray, Array]], start: float, stop: float, number: int, there: float
) -> float:
    """Last place from a start towards a stop that is opposite to the edge of a number, on the side of a fraction.

    A full circle is one edge, whose end is its start.
    """
    for _ in range(CUTS):
        places = np.linspace(start, stop, SECTIONS + 1)
        onto, fraction = opposite(places[1:-1])
        other = np.append((onto != number) | (abs(fraction - there) > HALF), True)
        first = int(other.argmax())
        start, stop = places[first], places[first + 1]
    ends = (edge_end for edge_end in (0.0, 1.0) if abs(start - edge_end) <= SAME)
    return next(ends, start)
