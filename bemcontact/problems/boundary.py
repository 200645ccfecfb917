"""The boundary of the body: closed loops of named edges, counterclockwise outside, clockwise around holes."""

from bisect import bisect
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cached_property, lru_cache
from itertools import islice, pairwise
from math import dist
from typing import ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike
from pydantic import model_validator

from bemcontact.errors import Issue, KeyPath, ProblemError, dotted
from bemcontact.problems.curves import CircularArc, Curve, Edge, EllipticArc, Pair
from bemcontact.problems.geometry import MOST_ELEMENTS, AnyEdge, Arc, LoopSpec, Mirror, Place
from bemcontact.problems.loop_closure import JOINT_TOLERANCE, gap_issues, other_way_round
from bemcontact.problems.loops import loop_issues
from bemcontact.problems.outlines import OutlineError, issue_at, mirror_image, mirrored_loop, plain_loop
from bemcontact.problems.validation import (
    LARGEST_STATED,
    Point,
    Positive,
    SpecModel,
    Text,
    left_out,
    validation_error,
)
from bemcontact.problems.wording import unknown_word

RADIUS_TOLERANCE = 1e-6
"""Relative difference up to which the radii at both ends of an arc agree: users round coordinates."""
ON_EDGE = 1e-3
"""Distance of a point from an edge, relative to its length, up to which the point is on it: users round."""
APART = 1e-10
"""Difference of two fractions of the length of an edge below which no element fits between them: round-off of nodes."""
ROUND_OFF = 1e-12
"""Difference of two fractions of the length of an edge below which they are the same."""
MOST_TRIED = 20
"""Number of arcs that are turned round to see whether that mends a boundary."""
FARTHEST = 1e8
"""Largest coordinate or radius over the size of the body: eight digits are left for the shape."""
BOXES_KEPT = 16
"""Outlines whose bounding boxes are kept, for problems that have other loads."""


class Boundary(SpecModel):
    """The boundary of the body: an outer loop of edges, and loops around holes."""

    example: ClassVar[str] = "{outer: [{name: bottom, start: [0, 0]}, …]}"
    inside: ClassVar[tuple[str, ...]] = ("in_bodies", "faults")
    other_words: ClassVar[Mapping[str, str]] = dict.fromkeys(
        ("hole", "bore", "inner", "inside"), "holes is a list of holes, each a list of edges, clockwise"
    )

    outer: LoopSpec = left_out()
    """The edges of the outer loop, counterclockwise: the body is on the left."""
    file: Text | None = None
    """In place of the edges a drawing in DXF or a list of points in CSV, in the folder of the problem file."""
    layer: Text | tuple[Text, ...] | None = None
    """The only layer of the drawing that is read, or a list of the layers that are; all of them if left out."""
    scale: Positive | None = None
    """The factor of all coordinates of the drawing."""
    holes: tuple[LoopSpec, ...] = ()
    """The loops of edges around each hole, clockwise: the body is on the left."""
    mirror: Mirror | None = None
    """The line on which the outline is mirrored: the outer edges then begin and end on it, and are half of the outline.
    The other half has the same names with the word mirrored, and so have the holes."""

    @model_validator(mode="after")
    def _encloses_a_body(self) -> Self:
        """Refuse loops that do not enclose a body; a boundary that goes into another problem is not checked again."""
        if self.faults:
            raise validation_error("Boundary", self.faults)
        return self

    @cached_property
    def faults(self) -> tuple[Issue, ...]:
        """Issues of loops that do not enclose a body; later checks rely on earlier ones."""
        if self.outer is None:
            return (self._without_edges(),)
        if issues := [*self._ill_stated()]:
            return (*issues,)
        loops = [*zip(self.loop_paths, self.loop_specs, strict=True)]
        issues = [
            *_repeated_names(loops),
            *(issue for path, loop in loops for issue in _unknown_joints(path, loop)),
        ]
        if not issues:
            issues = [issue for path, loop in loops for issue in _out_of_range(path, loop, self.size)]
        if not issues:
            issues = [issue for path, loop in loops for issue in _ill_joined(path, loop, self.size)]
        if not issues:
            issues = [*self._with_hints(loop_issues(self.loops, self.loop_paths))]
            for (path, loop), joined in zip(loops, self.loops, strict=True):
                issues += _misplaced_ends(path, loop, joined)
        return (*issues,)

    def _with_hints(self, issues: Sequence[Issue]) -> Iterator[Issue]:
        """Add to issues of loops the arc that would mend all of them if it ran the other way round its center."""
        hint = self._hint_of_direction() if issues else ""
        return (Issue(path=issue.path, message=issue.message + hint) for issue in issues)

    def _hint_of_direction(self) -> str:
        """Name the arc that leaves no issue of loops if it runs the other way round; empty if there is none."""
        places = [(number, i) for number, loop in enumerate(self.loop_specs) for i in range(len(loop))]
        changes = ((*place, other_way_round(self.loop_specs[place[0]][place[1]])) for place in places)
        for number, i, other in islice((change for change in changes if change[2]), MOST_TRIED):
            loop = self.loop_specs[number]
            assert other is not None
            joined = _joined([*loop[:i], other[0], *loop[i + 1 :]])
            if not loop_issues([*self.loops[:number], joined, *self.loops[number + 1 :]], self.loop_paths):
                return f"; or does '{loop[i].name}' run the wrong way round its center? Then give {other[1]}"
        return ""

    def _without_edges(self) -> Issue:
        """The issue of a boundary without outer edges."""
        if self.file is None:
            return Issue(path=("outer",), message="missing; give the edges of the outer loop, or a file")
        message = "a drawing is read with a problem file; in Python write boundary: bemcontact.outline('part.dxf')"
        return Issue(path=("file",), message=message)

    def _ill_stated(self) -> Iterator[Issue]:
        """Issues of loops that cannot be written as plain edges."""
        for path, loop in zip(self.loop_paths, (self.outer, *self.holes), strict=False):
            try:
                plain = plain_loop(loop)
                if self.mirror is not None and path == ("outer",):
                    mirrored_loop(plain, self.mirror)
            except OutlineError as error:
                yield issue_at(error, path)

    @cached_property
    def loop_specs(self) -> tuple[tuple[AnyEdge, ...], ...]:
        """All loops as plain edges, the outer one first: without fillets, tangents and mirror."""
        outer, *holes = map(plain_loop, (self.outer, *self.holes))
        if self.mirror is not None:
            outer = mirrored_loop(outer, self.mirror)
            holes += [mirror_image(hole, self.mirror) for hole in holes]
        return (outer, *holes)

    @property
    def loop_paths(self) -> tuple[KeyPath, ...]:
        """Key path of each loop, relative to the boundary; a mirrored hole has that of its original."""
        holes = [("holes", i) for i in range(len(self.holes))]
        return (("outer",), *holes, *(holes if self.mirror is not None else ()))

    @cached_property
    def loops(self) -> tuple[tuple[Edge, ...], ...]:
        """All loops of edges with both ends, the outer one first."""
        return tuple(_joined(loop) for loop in self.loop_specs)

    @cached_property
    def in_bodies(self) -> dict[str, tuple[tuple[Edge, ...], ...]]:
        """The loops with the names of edges in a problem, by body, as far as `named_loops` was asked for them."""
        return {}

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

    def without_elements(self) -> Self:
        """Copy in which no edge states elements."""
        none = {"elements": None, "grading": None, "ends_at": ()}
        outer, *holes = [tuple(edge.model_copy(update=none) for edge in loop) for loop in self.loop_specs]
        return type(self).model_construct(outer=outer, holes=tuple(holes))

    @property
    def edges(self) -> tuple[Edge, ...]:
        """All edges in order of the loops."""
        return tuple(edge for loop in self.loops for edge in loop)

    @property
    def meshed(self) -> bool:
        """Whether all edges state their elements."""
        return all(edge.elements is not None for edge in self.edges)

    @cached_property
    def size(self) -> float:
        """Diameter of the bounding box [L]."""
        return float(np.hypot(*np.ptp(self.box, axis=0)))

    @cached_property
    def box(self) -> tuple[Pair, Pair]:
        """Least and largest coordinates [L]."""
        return _box(tuple(self.edges))


def size_of_edges(edges: Iterable[Edge]) -> float:
    """Diameter of the bounding box of edges [L]."""
    return float(np.hypot(*np.ptp(_box(tuple(edges)), axis=0)))


def in_box(edges: Iterable[Edge], point: ArrayLike) -> bool:
    """Whether a point (2,) [L] is in the bounding box of edges."""
    least, largest = np.array(_box(tuple(edges)))
    return bool(((least < point) & (point < largest)).all())


@lru_cache(maxsize=BOXES_KEPT)
def _box(edges: tuple[Edge, ...]) -> tuple[Pair, Pair]:
    """Least and largest coordinates of edges [L]; no array, so that boundaries can be compared."""
    points = np.vstack([edge.polyline() for edge in edges])
    (left, low), (right, high) = points.min(axis=0).tolist(), points.max(axis=0).tolist()
    return (left, low), (right, high)


def _with_ends(edge: AnyEdge, ends: Sequence[float] | None) -> AnyEdge:
    """Copy of an edge with all its element ends given."""
    if ends is None:
        return edge
    inner = tuple(map(float, ends))
    if len(inner) < MOST_ELEMENTS and all(0 < end < 1 for end in inner):  # else the copy is refused
        return edge.model_copy(update={"elements": len(inner) + 1, "grading": None, "ends_at": inner})
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


def _out_of_range(path: KeyPath, loop: Sequence[AnyEdge], size: float) -> Iterator[Issue]:
    """Issues of a body too small to compute with, and of coordinates and radii that leave no digits for its shape."""
    if size == 0:
        yield Issue(path=path, message="all points of the boundary coincide, so that there is no body; correct them")
        return
    if size < 1 / LARGEST_STATED:
        message = f"the body has the size {size:.3g}, which is too small to compute with; choose another unit of length"
        yield Issue(path=path, message=message)
        return
    for i, joined in enumerate(_joined(loop)):
        curve = joined.curve
        round_parts = (curve.center, curve.radii) if isinstance(curve, CircularArc | EllipticArc) else ()
        if issue := far_issue((*path, i), (joined.start, joined.end, *round_parts), size):
            yield issue


def far_issue(path: KeyPath, lengths: object, size: float) -> Issue | None:
    """Issue of coordinates or radii that are too large beside the size of the body; None if they are not."""
    largest = float(np.abs(np.asarray(lengths, float)).max())
    if largest <= FARTHEST * size:
        return None
    what = f"coordinates or radii of {largest:.3g} beside a body of the size {size:.3g} leave too few digits"
    return Issue(path=path, message=f"{what}; move the origin to the body, or take a line or plane for a wide arc")


def _ill_joined(path: KeyPath, loop: Sequence[AnyEdge], size: float) -> Iterator[Issue]:
    """Issues of gaps between edges, edges without length, and arcs whose ends are not on one circle."""
    if gaps := [*gap_issues(path, loop, size)]:
        yield from gaps
        return
    for i, (edge, joined) in enumerate(zip(loop, _joined(loop), strict=True)):
        if joined.length <= JOINT_TOLERANCE * size:
            message = f"'{edge.name}' has no length; {_remedy_for_no_length(edge)}"
            if joined.start != joined.end:
                beside = f"too short beside a body of the size {size:.3g}; make it longer, or leave it out"
                message = f"'{edge.name}' has the length {joined.length:.3g}, which is {beside}"
            yield Issue(path=(*path, i), message=message)
        elif isinstance(joined.curve, CircularArc):
            first, last = joined.curve.radii
            if abs(first - last) > RADIUS_TOLERANCE * max(first, last):
                distances = f"its start has the distance {first:.9g} from the center, its end {last:.9g}"
                message = f"'{edge.name}' is not a circular arc: {distances}; correct one point or the center"
                yield Issue(path=(*path, i), message=message)


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
        ratio, towards = (edge.grading.ratio, edge.grading.towards) if edge.grading else (1.0, "start")
        edges.append(
            Edge(
                name=edge.name,
                curve=curve,
                start=start,
                end=end,
                elements=edge.elements,
                ratio=ratio,
                towards=towards if isinstance(towards, str) else _fraction(curve, towards),
                ends_at=tuple(sorted(_fraction(curve, place) for place in edge.ends_at)),
            )
        )
    return tuple(edges)


def _fraction(curve: Curve, place: Place) -> float:
    """Fraction of the arc length at a place: a fraction or a point."""
    return curve.fraction_at(place) if isinstance(place, tuple) else place


def _well_placed(edge: AnyEdge) -> bool:
    """Whether element ends of an edge are fractions that are far enough from each other, and not too many."""
    places = [place for _, place in edge.places if not isinstance(place, tuple)]
    if len(places) < len(edge.places):
        return False
    apart = min(after - before for before, after in pairwise(sorted([0.0, *places, 1.0])))
    return apart >= APART and (edge.elements is None or edge.elements > len(places))


def _misplaced_ends(path: KeyPath, loop: Sequence[AnyEdge], joined: Sequence[Edge]) -> Iterator[Issue]:
    """Issues of element ends that are off the edge, at its ends, repeated, or more than the elements."""
    for i, (edge, shape) in enumerate(zip(loop, joined, strict=True)):
        if _well_placed(edge):
            continue
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
            at = bisect(taken, fraction)
            if (off := min(abs(fraction - other) for other in taken[max(at - 1, 0) : at + 1])) < APART:
                where = "here already" if off < ROUND_OFF else f"{off * shape.length:.2g} away, which is too near"
                message = f"an element of '{edge.name}' ends {where}; leave this place out, or take another one"
                yield Issue(path=(*path, i, *key), message=message)
            taken.insert(at, fraction)
        if edge.elements is not None and edge.elements < len(taken) - 1:
            needed = f"the {len(taken) - 2} element ends of '{edge.name}' need at least {len(taken) - 1} elements"
            yield Issue(path=(*path, i, "elements"), message=f"{needed}, found {edge.elements}")
