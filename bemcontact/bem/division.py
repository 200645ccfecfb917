"""The division of edges into elements: as the edges state it, and where two elastic bodies face each other, matched.

Contact points of two elastic bodies are pairs: a node of the first body and a place of the second one on their common
normal, which has a node there. So the elements of the second body end at the pairs of those of the first.
"""

from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from bemcontact.arrays import Array
from bemcontact.errors import Issue, ProblemError
from bemcontact.frozen import frozen
from bemcontact.problems.body_surface import BodySurface
from bemcontact.problems.curves import Edge
from bemcontact.problems.pairing import HALF, OppositePart
from bemcontact.problems.problem import Problem

NEAR = 0.3
"""Part of an element up to which one of its ends moves to where an opposite part ends, instead of a new end there."""
BESIDE = 1e-3
"""Distance from an end of some places, over their extent, where a pair is on the same side of a full turn."""
SAME = 1e-9
"""Difference of two fractions of an edge up to which ends of parts are one element end: that of a mesh search."""
LEAST = 1e-12
"""Least element over its edge that is no round-off of its ends."""


class Facing(NamedTuple):
    """An element of an edge, counted along it, and the one on another edge that it faces."""

    edge: str
    element: int
    onto: str
    opposite: int


@frozen
class Division:
    """All elements of a problem.

    Parameters
    ----------
    fractions : (e, 3) of the length of each edge at start, middle and end of its elements
    facing : pairs of elements that face each other, by contact of two elastic bodies
    """

    fractions: Mapping[str, Array]
    facing: Mapping[str, Sequence[Facing]]


class Matched(NamedTuple):
    """A part of an edge of the first body, and the edge that it is opposite to."""

    contact: str
    part: OppositePart
    onto: str
    surface: BodySurface


def divided(problem: Problem) -> Division:
    """Divide all edges of a problem into its elements, each cut as its mesh says."""
    refine, edges = problem.mesh.refine, {edge.name: edge for edge in problem.edges}
    parts = [part for name in (*problem.contacts, *problem.bonded) for part in problem.opposite(name)]
    if not parts:
        return Division(fractions={name: _thirds(edge.breakpoints(refine)) for name, edge in edges.items()}, facing={})
    matched = [*matched_parts(problem)]
    ends = {name: edge.breakpoints(1) for name, edge in edges.items()}
    for name, edge in edges.items():
        places = {end for part in parts if part.edge == name for end in part[1:3]}
        ends[name] = _with_ends(ends[name], sorted(places), edge)
    fractions: dict[str, Array] = {}
    facing: dict[str, list[Facing]] = {item.contact: [] for item in matched}
    for name in in_order(edges, matched):
        onto = [item for item in matched if item.onto == name]
        ends[name], fractions[name], pairs = _matched(ends[name], onto, ends, edges, fractions, refine)
        for contact, pair in pairs:
            facing[contact].append(pair)
    return Division(fractions=fractions, facing=facing)


def matched_parts(problem: Problem) -> Iterator[Matched]:
    """Opposite parts of all contacts of two elastic bodies, and of all bonds."""
    for contact in (*problem.contacts, *problem.bonded):
        surface = (problem.bonds if contact in problem.bonded else problem.zones)[contact].surface
        if isinstance(surface, BodySurface) and surface.elastic:
            for part in problem.opposite(contact):
                yield Matched(contact, part, surface.edges[part.onto].name, surface)


def in_order(edges: Mapping[str, Edge], matched: Sequence[Matched]) -> list[str]:
    """Names of edges, each behind those that its elements follow."""
    before = {name: {item.part.edge for item in matched if item.onto == name} for name in edges}
    order: list[str] = []
    while before:
        ready = [name for name, others in before.items() if not others & before.keys()]
        assert ready, "a check of the problem refuses circles"
        order += ready
        for name in ready:
            del before[name]
    return order


def feet(item: Matched, edge: Edge, at: Array) -> Array:
    """Fractions (k,) of the opposite edge at the pairs of ascending places (k,) of an edge: they descend."""
    curve, inside = item.surface.edges[item.part.onto].curve, BESIDE * (at[-1] - at[0])
    at = np.append(at, [at[0] + inside, at[-1] - inside])
    pairs = item.surface.pairs(edge.points(at), -edge.normals(at))
    there, beside = np.split(curve.nearest(pairs.points), [len(at) - 2])
    for end in (0, -1):
        if abs(there[end] - beside[end]) > HALF:  # the end of a full circle is its start
            there[end] = round(beside[end])
    return there


def _thirds(ends: Array) -> Array:
    """Start, middle and end (..., e, 3) of elements with these ends (..., e + 1)."""
    starts, ends = ends[..., :-1], ends[..., 1:]
    thirds = np.empty((*ends.shape, 3))
    thirds[..., 0], thirds[..., 1], thirds[..., 2] = starts, (starts + ends) / 2, ends
    return thirds


def _with_ends(ends: Array, places: Sequence[float], edge: Edge) -> Array:
    """Element ends (e + 1,) with ends at some places too; a near one that nothing fixes moves there."""
    fixed = {0.0, 1.0, *edge.ends_at, *([] if isinstance(edge.towards, str) else [edge.towards])}
    for place in places:
        i = int(np.abs(ends - place).argmin())
        if abs(ends[i] - place) <= SAME:
            ends = np.concatenate([ends[:i], [place if 0 < i < len(ends) - 1 else ends[i]], ends[i + 1 :]])
            fixed.add(place)
            continue
        at = int(np.searchsorted(ends, place))
        length = ends[at] - ends[at - 1]
        if abs(ends[i] - place) < NEAR * length and not any(abs(ends[i] - other) <= SAME for other in fixed):
            ends = np.concatenate([ends[:i], ends[i + 1 :]])
            at = int(np.searchsorted(ends, place))
        ends = np.insert(ends, at, place)
        fixed.add(place)
    return ends


def _matched(
    own: Array,
    onto: Sequence[Matched],
    ends: Mapping[str, Array],
    edges: Mapping[str, Edge],
    fractions: Mapping[str, Array],
    refine: int,
) -> tuple[Array, Array, list[tuple[str, Facing]]]:
    """Ends (e + 1,) before they are cut, elements (e, 3) of an edge that follows others, and facing pairs.

    Elements that follow none are cut in equal parts; those that do have their nodes at pairs.
    """
    covered: list[tuple[Array, Array, Matched, int]] = []  # pairs of element ends and of nodes, ascending
    for item in onto:
        name = item.part.edge
        first, last = (int(np.abs(ends[name] - end).argmin()) for end in item.part[1:3])
        theirs = fractions[name][first * refine : last * refine]
        nodes = _snapped(feet(item, edges[name], theirs.ravel())).reshape(-1, 3)[::-1, ::-1]
        places = np.append(nodes[::refine, 0], nodes[-1, 2])
        if (np.diff(places) < -LEAST).any() or (np.diff(nodes, axis=1) <= 0).any():
            raise ProblemError(_crossing(item))
        if (np.diff(places) < LEAST).any():
            raise ProblemError(_too_short(item))
        covered.append((places, nodes, item, last))
    covered.sort(key=lambda part: float(part[0][0]))
    for (places, _, item, _), (others, _, other, _) in pairwise(covered):
        if others[0] < places[-1] - SAME and item.part.edge != other.part.edge:
            raise ProblemError(_overlapping(item, other))
    keep = np.ones(len(own), bool)
    for places, *_ in covered:
        at = np.clip(np.searchsorted(own, places[[0, -1]]), 1, len(own) - 1)
        near = NEAR * (own[at] - own[at - 1])
        keep[1:-1] &= ~((own[1:-1] > places[0] - near[0]) & (own[1:-1] < places[-1] + near[1]))
    starts = [float(places[0]) for places, *_ in covered[1:]] + [np.inf] * bool(covered)
    taken = [
        places[:-1] if start - places[-1] <= SAME else places
        for (places, *_), start in zip(covered, starts, strict=True)
    ]
    away = [np.abs(own[:, None] - places).min(axis=1) > SAME for places in taken]
    every = np.sort(np.concatenate([own[np.all([keep, *away], axis=0)], *taken]))
    pairs = list[tuple[str, Facing]]()
    follows: dict[int, tuple[Array, Matched, int]] = {}
    begins = [int(np.abs(every - places[0]).argmin()) for places, *_ in covered]
    for begin, (places, nodes, item, last) in zip(begins, covered, strict=True):
        every[begin : begin + len(places)] = places
        follows |= {
            begin + i: (nodes[i * refine : (i + 1) * refine], item, last - 1 - i) for i in range(len(places) - 1)
        }
    if covered and (np.diff(every) < LEAST).any():
        raise ProblemError(_too_short(covered[0][2]))
    steps = np.linspace(every[:-1], every[1:], refine + 1, axis=1)
    steps[:, -1] = every[1:]
    elements = _thirds(steps)
    for element in sorted(follows):
        nodes, item, other = follows[element]
        nodes[0, 0], nodes[-1, 2] = every[element], every[element + 1]
        nodes[1:, 0] = nodes[:-1, 2]
        elements[element] = nodes
        pairs += [
            (item.contact, Facing(item.part.edge, other * refine + refine - 1 - i, item.onto, element * refine + i))
            for i in range(refine)
        ]
    return every, elements.reshape(-1, 3), pairs


def _crossing(item: Matched) -> Issue:
    """Issue of a contact with pairs that cross each other, because the edges are far apart there."""
    message = (
        f"'{item.part.edge}' is so far from '{item.onto}' that pairs of their points cross each other; name the edges "
        "that come to touch, or cut the edge where it is far away"
    )
    return Issue(path=("contacts", item.contact, "between"), message=message)


def _overlapping(item: Matched, other: Matched) -> Issue:
    """Issue of two contacts that have pairs on one part of an edge, because edges are far apart there."""
    message = (
        f"'{item.part.edge}' and '{other.part.edge}' are opposite to one part of '{item.onto}', so far from it that "
        "they cannot touch there; name whole bodies in 'between', or cut these edges and name what comes to touch"
    )
    return Issue(path=("contacts", item.contact, "between"), message=message)


def _too_short(item: Matched) -> Issue:
    """Issue of a contact with elements that are too short for the edge that follows them."""
    message = (
        f"elements of '{item.part.edge}' are too short beside the length of '{item.onto}', whose elements follow them; "
        f"cut '{item.onto}' into several edges, one of them hardly longer than '{item.part.edge}'"
    )
    return Issue(path=("contacts", item.contact, "between"), message=message)


def _snapped(fractions: Array) -> Array:
    """Descending fractions of an edge of which the first and the last one are at its ends if they are that near."""
    first, last = fractions[[0, -1]]
    fractions[0], fractions[-1] = 1.0 if first > 1 - SAME else first, 0.0 if last < SAME else last
    return fractions
