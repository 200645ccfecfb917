"""The unbroken pieces of the contact zones, as stretches of the curves that their elements approximate."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bemcontact.arrays import Array, BoolArray
from bemcontact.bem.condense import Body
from bemcontact.bem.contact_points import element_lengths
from bemcontact.problem.curves import Edge

CORNER = 0.2
"""Sine of the angle by which the boundary turns from which a joint of two edges is a corner."""
SAME = 1e-12
"""Difference of two positions over the length of the run below which they are one."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ZoneRun:
    """One unbroken piece of a contact zone; positions on it are arc lengths of its edges from its start [L].

    Parameters
    ----------
    number : that the contact points on it have
    zone : name of its zone
    edges : in the order of the boundary
    closed : whether the last edge ends where the first begins
    arc : (m + 1,) arc length of the elements themselves up to each element end, which is what contact points know
    breakpoints : of each edge, fractions of its length where its elements begin and end
    corner : (k + 1,) whether the boundary turns sharply at each joint of the k edges; false at the ends of an open run
    beside : the edges before and after the piece; none if it is closed
    """

    number: int
    zone: str
    edges: tuple[Edge, ...]
    closed: bool
    arc: Array
    breakpoints: tuple[Array, ...]
    corner: BoolArray
    beside: tuple[Edge, ...]

    @property
    def length(self) -> float:
        """Of all edges [L]."""
        return float(self.joints[-1])

    @cached_property
    def joints(self) -> Array:
        """Positions (k + 1,) where edges begin and end."""
        return np.concatenate([[0.0], np.cumsum([edge.length for edge in self.edges])])

    @cached_property
    def ends(self) -> Array:
        """Positions (m + 1,) of the element ends."""
        parts = zip(self.joints, self.edges, self.breakpoints, strict=False)
        return np.concatenate([[0.0], *(start + edge.length * fractions[1:] for start, edge, fractions in parts)])

    def position(self, arc: float) -> float:
        """Position of a point of the elements, from its arc length; across the seam of a closed run it goes on."""
        turns, rest = divmod(arc, float(self.arc[-1])) if self.closed else (0.0, arc)
        return turns * self.length + float(np.interp(rest, self.arc, self.ends))

    def fractions(self, ends: Array) -> dict[str, tuple[float, ...]]:
        """Fractions of the length of each edge where elements end inside it, from the positions of all ends."""
        stated, same = {}, SAME * self.length
        for edge, start, end in zip(self.edges, self.joints[:-1], self.joints[1:], strict=True):
            inside = ends[(ends > start + same) & (ends < end - same)]
            stated[edge.name] = tuple(((inside - start) / (end - start)).tolist())
        return stated


def zone_runs(body: Body) -> Iterator[ZoneRun]:
    """List the unbroken pieces of all contact zones of a body on its mesh, by their numbers."""
    mesh, points, problem = body.mesh, body.points, body.problem
    lengths, zones = element_lengths(mesh), [*problem.contact_zones]
    middle = points.local == 1  # middle nodes are contact points of one run each, in the order of the boundary
    for number in range(len(points.run_length)):
        own = middle & (points.run[points.point] == number)
        elements = points.element[own]
        names = [mesh.edge_names[i] for i in dict.fromkeys(mesh.edge[elements].tolist())]
        edges = tuple(problem.edge(name) for name in names)
        closed = bool(np.isfinite(points.run_length[number]))
        breakpoints = tuple(edge.breakpoints(problem.mesh.refine) for edge in edges)
        firsts = np.cumsum([0, *(len(fractions) - 1 for fractions in breakpoints[:-1])])
        corner = np.append(np.abs(mesh.turns[elements[firsts]]) >= CORNER, closed)
        corner[[0, -1]] &= closed and corner[0]
        outside = mesh.before[elements[0]], mesh.elements[elements[-1], 2]
        yield ZoneRun(
            number=number,
            zone=zones[points.zone[points.point[own][0]]],
            edges=edges,
            closed=closed,
            arc=np.concatenate([[0.0], np.cumsum(lengths[elements])]),
            breakpoints=breakpoints,
            corner=corner,
            beside=() if closed else tuple(problem.edge(mesh.edge_names[mesh.edge[i]]) for i in outside),
        )
