"""The way of bodies to where they touch as drawn: pairs of points are those of bodies that have gone it."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from bemcontact.problems.bodies import SEPARATOR
from bemcontact.problems.body_surface import BodySurface, BodyZone
from bemcontact.problems.curves import Edge
from bemcontact.problems.edge_places import STEEPEST, TIE
from bemcontact.problems.nearest_places import nearest_places, opposite_places
from bemcontact.problems.validation import Point
from bemcontact.problems.way import Way

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


def approach(edges: Sequence[Edge], surface: BodySurface) -> Point:
    """Displacement [L] of another body that makes it touch edges where it is nearest as drawn.

    It is zero where it touches already, and where no displacement makes it touch at all places that are as near: a pin
    that is drawn in the middle of its hole may come to touch anywhere.
    """
    samples = np.linspace(0, 1, FEW + 1)
    at = [
        np.concatenate([samples, opposite_places(edge.curve, surface), nearest_places(edge.curve, surface)])
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


def approached(zones: Mapping[str, BodyZone]) -> dict[str, BodyZone]:
    """Zones of bodies that touch other elastic ones, moved there as drawn."""
    touching = {name: zone.surface for name, zone in zones.items() if zone.surface.first}
    ways: dict[str, Way] = {}
    for signs in moved_together(touching):
        pairs = [_sides(touching[name])[:: int(sign)] for name, sign in signs.items()]
        first, second = (tuple(dict.fromkeys(edge for pair in pairs for edge in pair[i])) for i in (0, 1))
        x, y = approach(first, replace(touching[next(iter(signs))], edges=second, nearest={}))
        ways |= {name: Way(sign * x, sign * y) for name, sign in signs.items()}
    return {name: zone.after(ways[name]) if name in ways else zone for name, zone in zones.items()}


def moved_together(surfaces: Mapping[str, BodySurface]) -> Iterator[dict[str, float]]:
    """Names of contacts between elastic bodies that are moved by one displacement, with its sign in each.

    What one contact states, several may state, each with some of the edges, whichever side is the first: so all that
    meet on both bodies belong together.
    """
    left = dict.fromkeys(surfaces)
    while left:
        signs = {next(iter(left)): 1.0}
        for _ in left:
            for more, surface in surfaces.items():
                for sign in (1.0, -1.0):
                    mine, its = _sides(surface)[:: int(sign)]
                    pairs = (_sides(surfaces[name])[:: int(other)] for name, other in signs.items())
                    if more not in signs and any(_meet(mine, one) and _meet(its, two) for one, two in pairs):
                        signs[more] = sign
        for name in signs:
            left.pop(name, None)
        yield signs


def _sides(surface: BodySurface) -> tuple[tuple[Edge, ...], tuple[Edge, ...]]:
    """Edges of both elastic bodies."""
    return surface.first, surface.edges


def _meet(edges: Sequence[Edge], others: Sequence[Edge]) -> bool:
    """Whether edges and others have one in common, or go on in one another, on one body."""
    return any(
        one.name == other.name
        or (one.name.partition(SEPARATOR)[0] == other.name.partition(SEPARATOR)[0] and one.end == other.start)
        for first, second in ((edges, others), (others, edges))
        for one in first
        for other in second
    )
