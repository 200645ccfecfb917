"""The way of bodies to where they touch as drawn: pairs of points are those of bodies that have gone it."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from bemcontact.problems.bodies import SEPARATOR
from bemcontact.problems.body_surface import BodySurface, BodyZone
from bemcontact.problems.curves import Edge, cross
from bemcontact.problems.edge_places import CORNER, STEEPEST, TIE
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


def approached(zones: Mapping[str, BodyZone], bonded: Mapping[str, str] | None = None) -> dict[str, BodyZone]:
    """Zones of bodies that touch other elastic ones, moved there as drawn; `bonded` as of `moved_together`.

    Those that move together have common normals by one share, so that pairs on either side of a bond do not cross.
    """
    touching, found = {name: zone.surface for name, zone in zones.items() if zone.surface.first}, {**zones}
    for signs in moved_together(touching, bonded or {}):
        surfaces = [touching[name] if sign > 0 else touching[name].other_side for name, sign in signs.items()]
        pairs = [_sides(touching[name])[:: int(sign)] for name, sign in signs.items()]
        first = tuple(dict.fromkeys(edge for pair in pairs for edge in pair[0]))
        names = {edge.name for pair in pairs for edge in pair[1]}
        loops = tuple({loop[0].name: loop for surface in surfaces for loop in surface.loops}.values())
        second = tuple(edge for loop in loops for edge in loop if edge.name in names)
        x, y = approach(first, replace(surfaces[0], edges=second, loops=loops, nearest={}))
        shares = [touching[name].share if sign > 0 else 1 - touching[name].share for name, sign in signs.items()]
        for name, sign in signs.items():
            share = touching[name].share if len({*shares}) == 1 else (1 - sign) / 2 + sign * np.mean(shares)
            surface = replace(touching[name], share=float(share))
            found[name] = replace(zones[name], surface=surface).after(Way(sign * x, sign * y))
    return found


def moved_together(
    surfaces: Mapping[str, BodySurface], bonded: Mapping[str, str], *, smooth: bool = False
) -> Iterator[dict[str, float]]:
    """Names of contacts between elastic bodies that are moved by one displacement, with its sign in each.

    What one contact states, several may state, each with some of the edges, whichever side is the first: so all that
    meet on both bodies belong together, or only those that go on `smooth` there, as the faces of a V do not. Bodies
    that bonds hold together are one: `bonded` has one of them for each.
    """
    left = dict.fromkeys(surfaces)
    while left:
        signs = {next(iter(left)): 1.0}
        for _ in left:
            for more, surface in surfaces.items():
                for sign in (1.0, -1.0):
                    mine, its = _sides(surface)[:: int(sign)]
                    pairs = (_sides(surfaces[name])[:: int(other)] for name, other in signs.items())
                    meet = any(
                        _meet(mine, one, bonded, smooth) and _meet(its, two, bonded, smooth) for one, two in pairs
                    )
                    if more not in signs and meet:
                        signs[more] = sign
        for name in signs:
            left.pop(name, None)
        yield signs


def _sides(surface: BodySurface) -> tuple[tuple[Edge, ...], tuple[Edge, ...]]:
    """Edges of both elastic bodies."""
    return surface.first, surface.edges


def _meet(edges: Sequence[Edge], others: Sequence[Edge], bonded: Mapping[str, str], smooth: bool) -> bool:
    """Whether edges and others have one in common, or go on in one another, on one body or on bonded ones."""

    def body(edge: Edge) -> str:
        name = edge.name.partition(SEPARATOR)[0]
        return bonded.get(name, name)

    def goes_on(one: Edge, other: Edge) -> bool:
        before, after = one.normals(np.ones(1))[0], other.normals(np.zeros(1))[0]
        return bool(abs(cross(before, after)) <= CORNER and before @ after > 0) or not smooth

    return any(
        one.name == other.name
        or (
            body(one) == body(other)
            and np.hypot(*np.subtract(one.end, other.start)) <= FLUSH * one.length
            and goes_on(one, other)
        )
        for first, second in ((edges, others), (others, edges))
        for one in first
        for other in second
    )
