"""The unbroken pieces (runs) of the contact zones along the edges, and the stretches of contact on them."""

from collections.abc import Iterator, Sequence

import numpy as np

from bemcontact.arrays import Array, BoolArray
from bemcontact.assessment.footprint import ContactInterval
from bemcontact.bem.body import Body
from bemcontact.bem.contact_points import ALIKE
from bemcontact.bem.mesh import CORNER
from bemcontact.cached import cached_property
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.solution import ContactSolution
from bemcontact.frozen import frozen, frozen_value
from bemcontact.problems.body_surface import BodyZone
from bemcontact.problems.curves import Edge
from bemcontact.serialization import Pair

SAME = 1e-12
"""Difference of two positions, over the length of the run, below which they are equal."""
POINTS_OF_ELEMENT = 3


@frozen
class ZoneRun:
    """One unbroken piece of a contact zone; positions on it are arc lengths of its edges from its start [L].

    Parameters
    ----------
    number : number of the run at its contact points
    zone : name of its zone
    edges : in the order of the boundary, of which the first and the last may belong to it in part
    closed : whether the last edge ends where the first begins
    arc : (m + 1,) arc length of the elements up to each element end, as contact points have it
    breakpoints : of each edge, fractions of its length where its elements of the piece begin and end
    turn : (k + 1,) angle by which the boundary turns to the left, into the body, at each joint of the k edges [rad];
        zero at the ends of an open run
    beside : the edges before and after the piece; none if it is closed
    off : whether conditions hold its first and its last node off the surface
    """

    number: int
    zone: str
    edges: tuple[Edge, ...]
    closed: bool
    arc: Array
    breakpoints: tuple[Array, ...]
    turn: Array
    beside: tuple[Edge, ...]
    off: tuple[bool, ...] = (False, False)

    @property
    def length(self) -> float:
        """Length of all edges [L]."""
        return float(self.joints[-1])

    @cached_property
    def joints(self) -> Array:
        """Positions (k + 1,) where edges begin and end."""
        lengths = [edge.length * (at[-1] - at[0]) for edge, at in zip(self.edges, self.breakpoints, strict=True)]
        return np.concatenate([[0.0], np.cumsum(lengths)])

    @property
    def corner(self) -> BoolArray:
        """Whether the boundary turns sharply at each joint (k + 1,)."""
        return np.abs(np.sin(self.turn)) >= CORNER

    @cached_property
    def ends(self) -> Array:
        """Positions (m + 1,) of the element ends."""
        parts = zip(self.joints, self.edges, self.breakpoints, strict=False)
        return np.concatenate([[0.0], *(start + edge.length * (at[1:] - at[0]) for start, edge, at in parts)])

    def position(self, arc: float) -> float:
        """Position of a point of the elements from its arc length; it increases across the seam of a closed run."""
        turns, rest = divmod(arc, float(self.arc[-1])) if self.closed else (0.0, arc)
        return turns * self.length + float(np.interp(rest, self.arc, self.ends))

    def point(self, position: float) -> Pair:
        """Place (x, y) [L] of a position."""
        at = position % self.length if self.closed else position
        i = int(np.clip(np.searchsorted(self.joints, at) - 1, 0, len(self.edges) - 1))
        fraction = self.breakpoints[i][0] + (at - self.joints[i]) / self.edges[i].length
        x, y = self.edges[i].points(np.clip([fraction], 0.0, 1.0))[0].tolist()
        return x, y

    def element_at(self, position: float) -> float:
        """Length [L] of the element at a position; where two elements meet, of the longer one."""
        same = 100 * SAME * self.length
        places = images(self, position % self.length if self.closed else position)
        beside = [(self.ends[:-1] <= at + same) & (self.ends[1:] >= at - same) for at in places]
        return float(np.diff(self.ends)[np.any(beside, axis=0)].max(initial=0.0))


def zone_runs(body: Body) -> Iterator[ZoneRun]:
    """List the unbroken pieces of all contact zones of a body on its mesh, by their numbers."""
    mesh, points, problem = body.mesh, body.points, body.problem
    lengths, zones, off, every = mesh.lengths, [*problem.zones], _held_off(body), body.outline.edges
    for number, elements in enumerate(points.elements_of_run):
        if not len(elements):
            continue  # a corner of the body that stands on a face by itself
        breaks = (np.diff(mesh.edge[elements]) != 0) | (np.diff(elements) != 1)
        pieces = np.split(elements, np.flatnonzero(breaks) + 1)
        edges = tuple(every[mesh.edge[piece[0]]] for piece in pieces)
        closed = bool(np.isfinite(points.run_length[number]))
        breakpoints = tuple(np.append(mesh.fractions[piece, 0], mesh.fractions[piece[-1], 2]) for piece in pieces)
        outside = mesh.before[elements[0]], mesh.elements[elements[-1], 2]
        yield ZoneRun(
            number=number,
            zone=zones[points.zone_of_run[number]],
            edges=edges,
            closed=closed,
            arc=np.concatenate([[0.0], np.cumsum(lengths[elements])]),
            breakpoints=breakpoints,
            turn=_turns(edges, closed=closed),
            beside=() if closed else tuple(every[mesh.edge[i]] for i in outside),
            off=tuple(node in off[points.zone_of_run[number]] for node in (int(elements[0]), int(outside[1]))),
        )


def _held_off(body: Body) -> dict[int, set[int]]:
    """Nodes of each zone that conditions hold off the surface, by its number.

    Those beside a tool that is free, or another elastic body, may come to touch.
    """
    held, gap, zones = body.points.held, body.held_gaps, [*body.problem.zones.values()]
    off = {number: set[int]() for number in range(len(zones))}
    if held is not None:
        rigid = np.array([not (isinstance(zone, BodyZone) and zone.surface.elastic) for zone in zones])
        open_ = (gap > ALIKE * body.mesh.size) & np.isfinite(gap) & rigid[held.zone]
        for zone, node in zip(held.zone[open_].tolist(), held.node[open_].tolist(), strict=True):
            off[zone].add(node)
    return off


def _turns(edges: Sequence[Edge], *, closed: bool) -> Array:
    """Angle by which the boundary turns to the left where each edge begins and the last one ends [rad]."""
    begins, ends = (np.array([edge.directions(np.array([at]))[0] for edge in edges]) for at in (0.0, 1.0))
    before, after = np.vstack([ends[-1:], ends]), np.vstack([begins, begins[:1]])
    turns = np.arctan2(before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0], np.sum(before * after, axis=1))
    turns[[0, -1]] *= closed
    return turns


@frozen_value
class Stretch:
    """A stretch of contact on a run.

    Parameters
    ----------
    start, end : positions [L]; on a closed run the end may be beyond its length
    start_free, end_free : whether contact ends there by itself, and not at the end of the run or at a corner
    points : number of points in contact
    """

    start: float
    end: float
    start_free: bool
    end_free: bool
    points: int

    @property
    def narrow(self) -> bool:
        """Whether fewer points are in contact than one element has, so that the places of its ends are not known."""
        return self.points < POINTS_OF_ELEMENT


def contact_stretches(
    run: ZoneRun, contact: CondensedContact, solution: ContactSolution, intervals: Sequence[ContactInterval]
) -> Iterator[Stretch]:
    """List the stretches of contact on a run of the mesh of a condensed problem, from its contact intervals.

    An end is free unless contact goes on to the last point of the run or to a corner. A single point stands for a
    stretch that reaches half-way to the points beside it, so that a mesh fitted to that shows more of them.
    """
    arcs, touching = _points(run, contact, solution)
    same = SAME * run.arc[-1]
    for interval in intervals:
        if interval.run != run.number or (run.closed and interval.end_arc - interval.start_arc >= run.arc[-1] - same):
            continue
        inside = np.flatnonzero(touching & (arcs >= interval.start_arc - same) & (arcs <= interval.end_arc + same))
        first, last = int(inside[0]), int(inside[-1])
        start_arc, end_arc = interval.start_arc, interval.end_arc
        if first == last:
            start_arc = min(start_arc, (arcs[first] + arcs[max(first - 1, 0)]) / 2)
            end_arc = max(end_arc, (arcs[last] + arcs[min(last + 1, len(arcs) - 1)]) / 2)
        corners = first < last  # a single point at a corner does not decide on which side contact is
        # where the last point is no end of contact, points beyond are held off the surface or not turned to it
        at_start = first == 0 and not run.off[0] and arcs[first] <= run.arc[1] + same
        start, start_free = _end(run, start_arc, arcs[first], 0.0 if at_start else None, corners)
        at_end = last == len(arcs) - 1 and not run.off[1] and arcs[last] >= run.arc[-2] - same
        end, end_free = _end(run, end_arc, arcs[last], run.length if at_end else None, corners)
        yield Stretch(start=start, end=end, start_free=start_free, end_free=end_free, points=last - first + 1)


def _points(run: ZoneRun, contact: CondensedContact, solution: ContactSolution) -> tuple[Array, BoolArray]:
    """Arc lengths of the points of a run in order, and which of them touch; of a closed run all several times over."""
    own = contact.points_of_run(run.number)
    touching = contact.pressed(solution.pressure, solution.displacement)
    arcs, touching = contact.arc_position[own], touching[own]
    if not run.closed:
        return arcs, touching
    turns = run.arc[-1] * np.array([-1, 0, 1, 2])
    return (turns[:, None] + arcs).ravel(), np.tile(touching, len(turns))


def _end(run: ZoneRun, arc: float, outermost: float, limit: float | None, at_corners: bool) -> tuple[float, bool]:
    """Position of an end of contact, and whether it is free, from the outermost point that touches."""
    if limit is not None and not run.closed:
        return limit, False
    position = run.position(outermost)
    corners = run.joints[run.corner]
    turned = position % run.length if run.closed else position
    if at_corners and corners.size and np.abs(corners - turned).min() <= SAME * 100 * run.length:
        return position, False
    return run.position(arc), True


def images(run: ZoneRun, position: float) -> list[float]:
    """The position, and on a closed run the same one a turn before and after."""
    return [position, position - run.length, position + run.length] if run.closed else [position]


def contact_beside(run: ZoneRun, stretches: Sequence[Stretch], position: float) -> tuple[int, float]:
    """Side (-1 before, 1 after) and length of the longer contact beside a position of a run; 1 and 0 without."""
    best = (1, 0.0)
    for item in stretches:
        for at in images(run, position):
            if item.start - 1e-9 * run.length <= at <= item.end + 1e-9 * run.length:
                best = max(best, (-1, at - item.start), (1, item.end - at), key=lambda pair: pair[1])
    return best
