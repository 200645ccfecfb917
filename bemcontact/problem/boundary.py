"""The boundary of the body: closed loops of named edges, counterclockwise outside, clockwise around holes."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from math import dist, pi
from typing import Self

import numpy as np
from pydantic import model_validator

from bemcontact.errors import Issue, KeyPath, ProblemError, dotted
from bemcontact.problem.curves import CircularArc, Curve, Edge
from bemcontact.problem.geometry import AnyEdge, Arc, Grading, Line, LoopSpec, Place
from bemcontact.problem.loops import loop_issues
from bemcontact.problem.validation import Point, SpecModel, unknown_word, validation_error

RADIUS_TOLERANCE = 1e-6
"""Relative difference up to which the radii at both ends of an arc agree: users round coordinates."""
JOINT_TOLERANCE = 1e-9
"""Distance of two edge ends, relative to the size of the body, up to which they are one point."""
ON_EDGE = 1e-3
"""Distance of a point from an edge, relative to its length, up to which the point is on it: users round."""
APART = 5e-7
"""Difference of two fractions of the length of an edge below which no element fits between them."""
ROUND_OFF = 1e-12
"""Difference of two fractions of the length of an edge below which they are the same."""


class Boundary(SpecModel):
    """The boundary of the body: an outer loop of edges, and loops around holes."""

    outer: LoopSpec
    """The edges of the outer loop, counterclockwise: the body is on the left."""
    holes: tuple[LoopSpec, ...] = ()
    """The loops of edges around each hole, clockwise: the body is on the left."""

    @model_validator(mode="after")
    def _encloses_a_body(self) -> Self:
        """Refuse loops that do not enclose a body; later checks rely on earlier ones."""
        loops = [*zip(self.loop_paths, self.loop_specs, strict=True)]
        issues = [
            *_repeated_names(loops),
            *(issue for path, loop in loops for issue in _unknown_joints(path, loop)),
        ]
        if not issues:
            issues = [issue for path, loop in loops for issue in _ill_joined(path, loop, self.size)]
        if not issues:
            issues = loop_issues(self.loops, self.loop_paths)
            for (path, loop), joined in zip(loops, self.loops, strict=True):
                issues += _misplaced_ends(path, loop, joined)
        if issues:
            raise validation_error("Boundary", issues)
        return self

    @property
    def loop_specs(self) -> tuple[tuple[AnyEdge, ...], ...]:
        """All loops as the user gave them, the outer one first."""
        return (self.outer, *self.holes)

    @property
    def loop_paths(self) -> tuple[KeyPath, ...]:
        """Key path of each loop, relative to the boundary."""
        return (("outer",), *(("holes", i) for i in range(len(self.holes))))

    @cached_property
    def loops(self) -> tuple[tuple[Edge, ...], ...]:
        """All loops of edges with both ends, the outer one first."""
        return tuple(_joined(loop) for loop in self.loop_specs)

    def with_element_ends(self, ends: Mapping[str, Sequence[float]]) -> Self:
        """Copy with all element ends of some edges given, see `Problem`; the curves are not checked again."""
        known = [edge.name for edge in self.edges]
        if unknown := [name for name in ends if name not in known]:
            raise ProblemError(Issue(path=(), message=unknown_word("edge", unknown[0], known)))
        outer, *holes = [tuple(_with_ends(edge, ends.get(edge.name)) for edge in loop) for loop in self.loop_specs]
        changed = type(self).model_construct(outer=outer, holes=tuple(holes))
        issues = [
            issue
            for path, loop, joined in zip(self.loop_paths, changed.loop_specs, changed.loops, strict=True)
            for issue in _misplaced_ends(path, loop, joined)
        ]
        if issues:
            raise ProblemError(issues)
        return changed

    @property
    def edges(self) -> tuple[Edge, ...]:
        """All edges in order of the loops."""
        return tuple(edge for loop in self.loops for edge in loop)

    @cached_property
    def size(self) -> float:
        """Diameter of the bounding box [L]."""
        points = np.vstack([edge.polyline() for edge in self.edges])
        return float(np.hypot(*np.ptp(points, axis=0)))


def _with_ends(edge: AnyEdge, ends: Sequence[float] | None) -> AnyEdge:
    """Copy of an edge with all its element ends given."""
    if ends is None:
        return edge
    inner = tuple(map(float, ends))
    return type(edge)(**{**edge.model_dump(), "elements": len(inner) + 1, "grading": None, "ends_at": inner})


def _repeated_names(loops: Iterable[tuple[KeyPath, Sequence[AnyEdge]]]) -> Iterator[Issue]:
    """Issues of edges with the same name."""
    first: dict[str, KeyPath] = {}
    for path, loop in loops:
        for i, edge in enumerate(loop):
            if edge.name in first:
                message = (
                    f"the edge {dotted(first[edge.name])} has the name '{edge.name}' too; give each edge its own name"
                )
                yield Issue(path=(*path, i, "name"), message=message)
            first.setdefault(edge.name, (*path, i))


def _unknown_joints(path: KeyPath, loop: Sequence[AnyEdge]) -> Iterator[Issue]:
    """Issues of joints for which neither edge gives the point."""
    for i, edge in enumerate(loop):
        before = loop[i - 1]
        if before.own_ends()[1] is None and edge.own_ends()[0] is None:
            message = f"both the start of '{edge.name}' and the end of '{before.name}' are missing; give one of them"
            yield Issue(path=(*path, i), message=message)


def _ill_joined(path: KeyPath, loop: Sequence[AnyEdge], size: float) -> Iterator[Issue]:
    """Issues of gaps between edges, edges without length, and arcs whose ends are not on one circle."""
    for i, (edge, joined) in enumerate(zip(loop, _joined(loop), strict=True)):
        before, start = loop[i - 1], edge.own_ends()[0]
        end = before.own_ends()[1]
        if start and end and dist(start, end) > JOINT_TOLERANCE * size:
            yield Issue(path=(*path, i, *_start_key(edge)), message=_gap(edge, before, start, end))
        elif joined.length <= JOINT_TOLERANCE * size:
            yield Issue(path=(*path, i), message=f"'{edge.name}' has no length; {_remedy_for_no_length(edge)}")
        elif isinstance(joined.curve, CircularArc):
            first, last = joined.curve.radii
            if abs(first - last) > RADIUS_TOLERANCE * max(first, last):
                distances = f"its start has the distance {first:.9g} from the center, its end {last:.9g}"
                message = f"'{edge.name}' is not a circular arc: {distances}; correct one point or the center"
                yield Issue(path=(*path, i), message=message)


def _gap(edge: AnyEdge, before: AnyEdge, start: Point, end: Point) -> str:
    """Describe the gap between an edge and the previous one."""
    where = f"'{edge.name}' starts at {_coordinates(start)}, but '{before.name}' before it ends at {_coordinates(end)}"
    remedy = "leave the start out to join them" if edge.has_coordinates() else "correct one of them"
    if not edge.has_coordinates() and before.has_coordinates():
        remedy = f"leave the end of '{before.name}' out to join them"
    suspects = dict.fromkeys(f"'{item.name}'" for item in (before, edge) if _maybe_in_radians(item))
    hint = f"; angles are in degrees, but those of {' and '.join(suspects)} may be in radians" if suspects else ""
    return f"the loop is open: {where}, {dist(start, end):.6g} away; {remedy}{hint}"


def _maybe_in_radians(edge: AnyEdge) -> bool:
    """Whether the angles differ by at most a full turn (rounded) in radians."""
    angles = None if isinstance(edge, Line) else edge.angles
    return angles is not None and abs(angles[1] - angles[0]) <= 2.01 * pi


def _start_key(edge: AnyEdge) -> KeyPath:
    """Key that gives the start of an edge."""
    return ("start",) if edge.has_coordinates() else ("angles",)


def _remedy_for_no_length(edge: AnyEdge) -> str:
    if isinstance(edge, Arc):
        return "for a full circle give radius and angles: [0, 360]"
    return "its ends are the same point; correct one of them"


def _coordinates(point: Point) -> str:
    return f"({point[0]:.9g}, {point[1]:.9g})"


def _joint(before: AnyEdge, edge: AnyEdge) -> Point:
    """Common point of two edges; given coordinates take precedence over computed ones."""
    end, start = before.own_ends()[1], edge.own_ends()[0]
    if start is None or (end is not None and before.has_coordinates()):
        start = end
    if start is None:
        raise ProblemError(f"both the start of '{edge.name}' and the end of '{before.name}' are missing; give one")
    return start


def _joined(loop: Sequence[AnyEdge]) -> tuple[Edge, ...]:
    """Edges of a loop with both ends."""
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
    """Fraction of the arc length at a place: a fraction or a point."""
    return curve.fraction_at(place) if isinstance(place, tuple) else place


def _misplaced_ends(path: KeyPath, loop: Sequence[AnyEdge], joined: Sequence[Edge]) -> Iterator[Issue]:
    """Issues of element ends that are off the edge, at its ends, repeated, or more than the elements."""
    for i, (edge, shape) in enumerate(zip(loop, joined, strict=True)):
        taken = [0.0, 1.0]
        for key, place in edge.places:
            fraction = _fraction(shape.curve, place)
            if isinstance(place, tuple):
                (nearest,) = shape.points(np.array([fraction]))
                if (off := dist(place, nearest)) > ON_EDGE * shape.length:
                    message = (
                        f"the point {_coordinates(place)} is {off:.3g} away from '{edge.name}'; move it to the edge"
                    )
                    yield Issue(path=(*path, i, *key), message=message)
                    continue
            if (off := min(abs(fraction - other) for other in taken)) < APART:
                where = "here already" if off < ROUND_OFF else f"{off * shape.length:.2g} away, which is too near"
                message = f"an element of '{edge.name}' ends {where}; leave this place out, or take another one"
                yield Issue(path=(*path, i, *key), message=message)
            taken.append(fraction)
        if edge.elements < len(taken) - 1:
            needed = f"the {len(taken) - 2} element ends of '{edge.name}' need at least {len(taken) - 1} elements"
            yield Issue(path=(*path, i, "elements"), message=f"{needed}, found {edge.elements}")
