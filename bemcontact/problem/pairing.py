"""Which parts of the edges of two elastic bodies are opposite to each other."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
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
"""Most times that it is cut: then it is as short as round-off."""
HALF = 0.5
"""Difference of fractions of an edge between two samples from which its end is between them."""
INSIDE = 1e-9
"""Distance from an end of the edge, over its length, where the end is looked at."""
SHORTEST = 1e-6
"""Least length of an opposite part over that of its edge: shorter ones are round-off of coordinates and corners."""
SAME = 1e-12
"""Difference of two fractions of an edge that is round-off."""


KEPT = 64
"""Pairs of sides whose parts are kept."""


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
    return list(_found_once(_TwoSides(_shape(edges, surface), edges, surface), reach))


@dataclass(frozen=True)
class _TwoSides:
    """Edges and a surface, equal to others of the same shape: a problem with another load has the same parts."""

    shape: tuple[object, ...]
    edges: Sequence[Edge] = field(compare=False)
    surface: BodySurface = field(compare=False)


def _shape(edges: Sequence[Edge], surface: BodySurface) -> tuple[object, ...]:
    """All that opposite parts depend on, but for the reach."""
    others = (surface.edges, surface.first, *surface.loops)
    own = tuple((edge.name, edge.curve, edge.start, edge.end) for edge in edges)
    shapes = (tuple((edge.curve, edge.start, edge.end) for edge in some) for some in others)
    return own, surface.elastic, surface.share, *shapes


@lru_cache(maxsize=KEPT)
def _found_once(sides: _TwoSides, reach: float) -> tuple[OppositePart, ...]:
    """Look for the parts as of `opposite_parts`."""
    most = _largest_gap(sides.edges, sides.surface, reach)
    return tuple(part for edge in sides.edges for part in _parts_of(edge, sides.surface, most))


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
        feet = surface.pairs(edge.points(at))
        turned = turned_to(-edge.normals(at), feet.normals)
        one = ~feet.corner
        if not surface.elastic and feet.corner.any():
            one |= _is_blunt(-edge.normals(at), feet, surface)
        return np.where(turned & one & (feet.gap <= most), feet.edge, -1), feet.fraction

    at = np.linspace(0.0, 1.0, SAMPLES + 1)
    onto, there = opposite(np.clip(at, INSIDE, 1 - INSIDE))  # on a corner of the surface two edges are nearest
    changes = np.flatnonzero((np.diff(onto) != 0) | (abs(np.diff(there)) > HALF))
    within = [*zip(at[changes], at[changes + 1], changes, strict=True)]
    within += [(high, low, i + 1) for low, high, i in within]
    begin, end, known = (np.array(part) for part in zip(*within, strict=True)) if within else np.zeros((3, 0))
    known = known.astype(int)
    last = _last(opposite, begin, end, onto[known], there[known]).tolist()
    ends = [*last[: len(changes)], 1.0]
    starts = [(0.0, int(onto[0])), *zip(last[len(changes) :], onto[changes + 1].tolist(), strict=True)]
    return [
        OppositePart(edge.name, low, high, number)
        for (low, number), high in zip(starts, ends, strict=True)
        if number >= 0 and high - low > SHORTEST
    ]


def _last(
    opposite: Callable[[Array], tuple[IntArray, Array]], start: Array, stop: Array, number: IntArray, there: Array
) -> Array:
    """Last places (k,) from starts towards stops that are opposite to edges of numbers, on the side of fractions.

    A full circle is one edge, whose end is its start.
    """
    rows = np.arange(len(start))
    for _ in range(CUTS if len(start) else 0):
        places = np.linspace(start, stop, SECTIONS + 1, axis=1)
        onto, fraction = (part.reshape(len(rows), -1) for part in opposite(places[:, 1:-1].ravel()))
        other = (onto != number[:, None]) | (abs(fraction - there[:, None]) > HALF)
        first = np.where(other.any(axis=1), other.argmax(axis=1), SECTIONS - 1)
        start, stop = places[rows, first], places[rows, first + 1]
        if (np.nextafter(start, stop) == stop).all():
            break
    for edge_end in (1.0, 0.0):
        start = np.where(abs(start - edge_end) <= SAME, edge_end, start)
    return start
