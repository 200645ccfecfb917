"""Which parts of the edges of two elastic bodies are opposite to each other."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from bemcontact.arrays import Array, BoolArray, IntArray
from bemcontact.problems.body_surface import BodySurface, Feet
from bemcontact.problems.curves import Edge
from bemcontact.problems.visibility import turned_to

SAMPLES = 512
"""Samples of an edge, apart from those opposite to places of the other body: then at most one end of a part is between
two of them."""
SECTIONS = 16
"""Sections into which the part of an edge with such an end is cut at a time."""
CUTS = 12
"""Times that it is cut: then it is as short as round-off."""
HALF = 0.5
"""Difference of fractions of an edge between two samples from which its end is between them."""
INSIDE = 1e-9
"""Distance from an end of the edge, over its length, where the end is looked at."""
SHORTEST = 1e-9
"""Least length of an opposite part over that of its edge: shorter ones are round-off of coordinates and corners."""
ONE = 1e-10
"""Difference of two fractions of an edge up to which they are one sample."""
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

    If bodies are drawn into each other, no farther than this reach: a body may be squeezed in one place only.

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
    others = (surface.edges, surface.first, *surface.loops, *surface.first_loops)
    own = tuple((edge.name, edge.curve, edge.start, edge.end) for edge in edges)
    shapes = (tuple((edge.curve, edge.start, edge.end) for edge in some) for some in others)
    return own, surface.elastic, surface.share, surface.approach, *shapes


@lru_cache(maxsize=KEPT)
def _found_once(sides: _TwoSides, reach: float) -> tuple[OppositePart, ...]:
    """Look for the parts as of `opposite_parts`."""
    most = _largest_gap(sides.edges, sides.surface, reach)
    return tuple(part for edge in sides.edges for part in _parts_of(edge, sides.surface, most))


def _largest_gap(edges: Sequence[Edge], surface: BodySurface, reach: float) -> float:
    """Gap [L] up to which places of edges are opposite to a surface."""
    if not np.isfinite(reach):
        return np.inf
    gaps = (surface.feet(surface.way.back(edge.points(_samples(edge, surface)))).gap for edge in edges)
    return max(min((float(gap.min()) for gap in gaps), default=0.0), 0.0) + reach


def _samples(edge: Edge, surface: BodySurface) -> Array:
    """Fractions (k,) of an edge in equal steps, opposite to places of a surface, and between these."""
    seen = surface.seen_from(edge)
    seen = _apart(np.sort(seen[(seen > INSIDE) & (seen < 1 - INSIDE)]))
    at = np.concatenate([np.arange(SAMPLES) / SAMPLES, seen, (seen[1:] + seen[:-1]) / 2])
    return np.append(_apart(np.sort(at)), 1.0)


def _apart(fractions: Array) -> Array:
    """Ascending fractions (k,) without those that follow another one so closely that both are one."""
    kept = [-1.0]
    for fraction in fractions.tolist():
        if fraction - kept[-1] > ONE:
            kept.append(fraction)
    return np.array(kept[1:])


def _is_blunt(inward: Array, feet: Feet, surface: BodySurface) -> BoolArray:
    """Whether places with normals (k, 2) into their body are turned to both sides of corners of a surface."""
    return np.all(turned_to(inward[:, None], surface.beside(feet)), axis=1)


def _parts_of(edge: Edge, surface: BodySurface, most: float) -> list[OppositePart]:
    """Opposite parts of one edge, up to a gap [L]."""

    def opposite(at: Array) -> tuple[IntArray, Array]:
        inward = surface.way.turned(-edge.normals(at), -1.0)
        feet = surface.pairs(surface.way.back(edge.points(at)), inward)
        turned = turned_to(inward, feet.normals)
        one = ~feet.corner
        if not surface.elastic and feet.corner.any():
            one |= _is_blunt(inward, feet, surface)
        return np.where(turned & one & (feet.gap <= most), feet.edge, -1), feet.fraction

    at = _samples(edge, surface)
    onto, there = opposite(np.clip(at, INSIDE, 1 - INSIDE))  # on a corner of the surface two edges are nearest
    changes = np.flatnonzero((np.diff(onto) != 0) | (abs(np.diff(there)) > HALF))
    own = np.concatenate([changes, changes + 1])
    places = _last(opposite, at[own], at[np.concatenate([changes + 1, changes])], onto[own], there[own])
    ends, starts = np.split(places, 2)
    numbers = [int(onto[0]), *onto[changes + 1].tolist()]
    bounds = zip(numbers, [0.0, *starts.tolist()], [*ends.tolist(), 1.0], strict=True)
    return [
        OppositePart(edge.name, low, high, number)
        for number, low, high in bounds
        if number >= 0 and high - low > SHORTEST
    ]


def _last(
    opposite: Callable[[Array], tuple[IntArray, Array]], start: Array, stop: Array, number: IntArray, there: Array
) -> Array:
    """Last places (k,) from starts (k,) towards stops that are opposite to the edges of numbers, beside fractions.

    A full circle is one edge, whose end is its start.
    """
    rows = np.arange(len(start))
    for _ in range(CUTS if len(rows) else 0):
        places = np.linspace(start, stop, SECTIONS + 1, axis=1)
        onto, fraction = (part.reshape(len(rows), -1) for part in opposite(places[:, 1:-1].ravel()))
        other = (onto != number[:, None]) | (abs(fraction - there[:, None]) > HALF)
        first = np.where(other.any(axis=1), other.argmax(axis=1), SECTIONS - 1)
        start, stop = places[rows, first], places[rows, first + 1]
        if (np.nextafter(start, stop) == stop).all():
            break
    return np.where(start <= SAME, 0.0, np.where(start >= 1 - SAME, 1.0, start))
