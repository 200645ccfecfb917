"""The outline of the body: closed loops of named edges, the outer one anticlockwise, holes clockwise."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from math import dist, pi
from typing import Self

import numpy as np
from pydantic import model_validator

from bemcontact.errors import Complaint, Path, ProblemError, dotted
from bemcontact.problem.curves import CircularArc, Curve, Edge
from bemcontact.problem.geometry import AnyEdge, Arc, Grading, Line, Place, StatedLoop
from bemcontact.problem.loops import loop_complaints
from bemcontact.problem.validation import Point, Stated, unknown_word, validation_error

RADIUS_TOLERANCE = 1e-6
"""Relative difference of the two radii of an arc given by its ends: coordinates are written with a few digits."""
JOINT_TOLERANCE = 1e-9
"""Distance of two edge ends, over the size of the body, below which they are one point."""
ON_EDGE = 1e-3
"""Distance of a place from its edge over the length of the edge up to which it is on it: people round coordinates."""
APART = 5e-7
"""Difference of two fractions of the length of an edge below which no element has room between them."""

ROUND_OFF = 1e-12
"""Difference of two fractions of the length of an edge below which they are one place."""


class Boundary(Stated):
    """The outline of the body.

    Raises
    ------
    ProblemError
        If a loop is open, crosses itself or another one, runs the wrong way round, or an edge has no length.
    """

    outer: StatedLoop
    """The edges of the outer loop, anticlockwise: the body is on the left."""
    holes: tuple[StatedLoop, ...] = ()
    """The loops of edges around each hole, clockwise: the body is on the left."""

    @model_validator(mode="after")
    def _bounds_a_body(self) -> Self:
        """Refuse loops that bound no body; a later check needs what an earlier one makes sure of."""
        stated = [*zip(self.loop_paths, self.stated_loops, strict=True)]
        complaints = [
            *_doubled_names(stated),
            *(complaint for path, loop in stated for complaint in _unknown_joints(path, loop)),
        ]
        if not complaints:
            complaints = [complaint for path, loop in stated for complaint in _ill_joined(path, loop, self.size)]
        if not complaints:
            complaints = loop_complaints(self.loops, self.loop_paths)
            for (path, loop), joined in zip(stated, self.loops, strict=True):
                complaints += _misplaced_ends(path, loop, joined)
        if complaints:
            raise validation_error("Boundary", complaints)
        return self

    @property
    def stated_loops(self) -> tuple[tuple[AnyEdge, ...], ...]:
        """All loops as they were written, the outer one first."""
        return (self.outer, *self.holes)

    @property
    def loop_paths(self) -> tuple[Path, ...]:
        """Path of keys from here to each loop."""
        return (("outer",), *(("holes", i) for i in range(len(self.holes))))

    @cached_property
    def loops(self) -> tuple[tuple[Edge, ...], ...]:
        """All loops with both ends of their edges known, the outer one first."""
        return tuple(_joined(loop) for loop in self.stated_loops)

    def with_element_ends(self, ends: Mapping[str, Sequence[float]]) -> Self:
        """State all element ends of some edges; else as of `Problem`. The curves, checked already, stay as they are."""
        known = [edge.name for edge in self.edges]
        if unknown := [name for name in ends if name not in known]:
            raise ProblemError(Complaint(path=(), message=unknown_word("edge", unknown[0], known)))
        outer, *holes = [tuple(_with_ends(edge, ends.get(edge.name)) for edge in loop) for loop in self.stated_loops]
        changed = type(self).model_construct(outer=outer, holes=tuple(holes))
        complaints = [
            complaint
            for path, loop, joined in zip(self.loop_paths, changed.stated_loops, changed.loops, strict=True)
            for complaint in _misplaced_ends(path, loop, joined)
        ]
        if complaints:
            raise ProblemError(complaints)
        return changed

    @property
    def edges(self) -> tuple[Edge, ...]:
        """All edges, loop by loop."""
        return tuple(edge for loop in self.loops for edge in loop)

    @cached_property
    def size(self) -> float:
        """Diameter of the bounding box [L]."""
        points = np.vstack([edge.polyline() for edge in self.edges])
        return float(np.hypot(*np.ptp(points, axis=0)))


def _with_ends(edge: AnyEdge, ends: Sequence[float] | None) -> AnyEdge:
    """Give an edge all its element ends, or leave it."""
    if ends is None:
        return edge
    inner = tuple(map(float, ends))
    return type(edge)(**{**edge.model_dump(), "elements": len(inner) + 1, "grading": None, "ends_at": inner})


def _doubled_names(loops: Iterable[tuple[Path, Sequence[AnyEdge]]]) -> Iterator[Complaint]:
    """Find edges that share a name."""
    first: dict[str, Path] = {}
    for path, loop in loops:
        for i, edge in enumerate(loop):
            if edge.name in first:
                message = f"the name '{edge.name}' is taken by {dotted(first[edge.name])}; give each edge its own"
                yield Complaint(path=(*path, i, "name"), message=message)
            first.setdefault(edge.name, (*path, i))


def _unknown_joints(path: Path, loop: Sequence[AnyEdge]) -> Iterator[Complaint]:
    """Find joints where neither edge says where it is."""
    for i, edge in enumerate(loop):
        before = loop[i - 1]
        if before.own_ends()[1] is None and edge.own_ends()[0] is None:
            message = f"neither the start of '{edge.name}' nor the end of '{before.name}' before it is given; give one"
            yield Complaint(path=(*path, i), message=message)


def _ill_joined(path: Path, loop: Sequence[AnyEdge], size: float) -> Iterator[Complaint]:
    """Find gaps between edges, edges without length, and arcs whose ends are not on one circle."""
    for i, (edge, joined) in enumerate(zip(loop, _joined(loop), strict=True)):
        before, start = loop[i - 1], edge.own_ends()[0]
        end = before.own_ends()[1]
        if start and end and dist(start, end) > JOINT_TOLERANCE * size:
            yield Complaint(path=(*path, i, *_start_key(edge)), message=_gap(edge, before, start, end))
        elif joined.length <= JOINT_TOLERANCE * size:
            yield Complaint(path=(*path, i), message=f"'{edge.name}' has no length; {_way_out_of_no_length(edge)}")
        elif isinstance(joined.curve, CircularArc):
            first, last = joined.curve.radii
            if abs(first - last) > RADIUS_TOLERANCE * max(first, last):
                distances = f"the start is {first:.9g} from the center, but the end {last:.9g}"
                message = f"'{edge.name}' is no circular arc: {distances}; correct one point or the center"
                yield Complaint(path=(*path, i), message=message)


def _gap(edge: AnyEdge, before: AnyEdge, start: Point, end: Point) -> str:
    """Say how far an edge begins from where the one before ends."""
    where = f"'{edge.name}' starts at {_written(start)}, but '{before.name}' before it ends at {_written(end)}"
    way_out = "leave the start out to join them" if edge.states_points() else "correct one of them"
    if not edge.states_points() and before.states_points():
        way_out = f"leave the end of '{before.name}' out to join them"
    suspects = dict.fromkeys(f"'{item.name}'" for item in (before, edge) if _maybe_in_radians(item))
    hint = f"; angles are in degrees: are those of {' and '.join(suspects)} in radians?" if suspects else ""
    return f"the loop is open: {where}, {dist(start, end):.6g} away; {way_out}{hint}"


def _maybe_in_radians(edge: AnyEdge) -> bool:
    """Tell whether angles are so close together that they would be at most a full turn (rounded) in radians."""
    angles = None if isinstance(edge, Line) else edge.angles
    return angles is not None and abs(angles[1] - angles[0]) <= 2.01 * pi


def _start_key(edge: AnyEdge) -> Path:
    """Key that says where an edge starts."""
    return ("start",) if edge.states_points() else ("angles",)


def _way_out_of_no_length(edge: AnyEdge) -> str:
    if isinstance(edge, Arc):
        return "for a full circle give radius and angles: [0, 360]"
    return "its ends are the same point"


def _written(point: Point) -> str:
    return f"({point[0]:.9g}, {point[1]:.9g})"


def _joint(before: AnyEdge, edge: AnyEdge) -> Point:
    """Where two edges meet; coordinates that were written win over computed ones."""
    end, start = before.own_ends()[1], edge.own_ends()[0]
    if start is None or (end is not None and before.states_points()):
        start = end
    if start is None:
        raise ProblemError(f"nothing says where '{before.name}' ends and '{edge.name}' begins")
    return start


def _joined(loop: Sequence[AnyEdge]) -> tuple[Edge, ...]:
    """Give each edge of a loop its two ends."""
    joints = [_joint(loop[i - 1], edge) for i, edge in enumerate(loop)]
    edges = []
    for i, edge in enumerate(loop):
        start, end = joints[i], joints[(i + 1) % len(loop)]
        curve = edge.curve(start, end)
        grading = edge.grading or Grading(ratio=1.0, towards="start")
        towards = grading.towards
        edges.append(
            Edge(
                name=edge.name,
                curve=curve,
                start=start,
                end=end,
                elements=edge.elements,
                ratio=grading.ratio,
                towards=towards if isinstance(towards, str) else _fraction(curve, towards),
                ends_at=tuple(sorted(_fraction(curve, place) for place in edge.ends_at)),
            )
        )
    return tuple(edges)


def _fraction(curve: Curve, place: Place) -> float:
    """Fraction of the arc length at a place that is a fraction already, or a point."""
    return curve.fraction_at(place) if isinstance(place, tuple) else place


def _misplaced_ends(path: Path, loop: Sequence[AnyEdge], joined: Sequence[Edge]) -> Iterator[Complaint]:
    """Find element ends that are asked for beside their edge, at its ends, twice, or too many."""
    for i, (edge, shape) in enumerate(zip(loop, joined, strict=True)):
        taken = [0.0, 1.0]
        for key, place in edge.places:
            fraction = _fraction(shape.curve, place)
            if isinstance(place, tuple):
                (nearest,) = shape.points(np.array([fraction]))
                if (off := dist(place, nearest)) > ON_EDGE * shape.length:
                    message = f"the point {_written(place)} is {off:.3g} away from '{edge.name}'; take one on the edge"
                    yield Complaint(path=(*path, i, *key), message=message)
                    continue
            if (off := min(abs(fraction - other) for other in taken)) < APART:
                where = (
                    "there anyway" if off < ROUND_OFF else f"{off * shape.length:.2g} beside it, too near for another"
                )
                message = f"an element of '{edge.name}' ends {where}; leave it out, or take another place"
                yield Complaint(path=(*path, i, *key), message=message)
            taken.append(fraction)
        if edge.elements < len(taken) - 1:
            message = f"'{edge.name}' cannot end elements at {len(taken) - 2} places with fewer than {len(taken) - 1}"
            yield Complaint(path=(*path, i, "elements"), message=f"{message} elements; found {edge.elements}")
