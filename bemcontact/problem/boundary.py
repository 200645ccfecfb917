"""The boundary of the body: closed loops of named edges, counterclockwise outside, clockwise around holes.

The loops enclose one body: they do not cross, they have the right orientation, and the holes are inside.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from itertools import islice
from math import dist
from typing import ClassVar, Self

import numpy as np
from pydantic import model_validator

from bemcontact.arrays import Array, BoolArray, IntArray
from bemcontact.errors import Issue, KeyPath, ProblemError, dotted
from bemcontact.problem.closeness import near_miss, sagitta
from bemcontact.problem.closing import JOINT_TOLERANCE, gap_issues, other_way_round
from bemcontact.problem.curves import CircularArc, Curve, Edge, EllipticArc
from bemcontact.problem.geometry import AnyEdge, Arc, Grading, LoopSpec, Place
from bemcontact.problem.validation import LARGEST_STATED, Point, SpecModel, validation_error
from bemcontact.problem.wording import unknown_word

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
TOUCHING = 1e-9
"""Distance of two edges, relative to the size of the body, up to which they touch."""
PAIRS_AT_ONCE = 2**20
"""Pairs of sides whose bounding boxes are compared at once: a few megabytes."""
FARTHEST = 1e8
"""Largest coordinate or radius over the size of the body: eight digits are left for the shape."""


class Boundary(SpecModel):
    """The boundary of the body: an outer loop of edges, and loops around holes."""

    example: ClassVar[str] = "{outer: [{name: bottom, start: [0, 0]}, …]}"

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
            issues = [issue for path, loop in loops for issue in _out_of_range(path, loop, self.size)]
        if not issues:
            issues = [issue for path, loop in loops for issue in _ill_joined(path, loop, self.size)]
        if not issues:
            issues = [*self._with_hints(loop_issues(self.loops, self.loop_paths))]
            for (path, loop), joined in zip(loops, self.loops, strict=True):
                issues += _misplaced_ends(path, loop, joined)
        if issues:
            raise validation_error("Boundary", issues)
        return self

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

    @property
    def meshed(self) -> bool:
        """Whether all edges state their elements."""
        return all(edge.elements is not None for edge in self.edges)

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


def _out_of_range(path: KeyPath, loop: Sequence[AnyEdge], size: float) -> Iterator[Issue]:
    """Issues of a body too small to compute with, and of coordinates and radii that leave no digits for its shape."""
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
            yield Issue(path=(*path, i), message=f"'{edge.name}' has no length; {_remedy_for_no_length(edge)}")
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
        if edge.elements is not None and edge.elements < len(taken) - 1:
            needed = f"the {len(taken) - 2} element ends of '{edge.name}' need at least {len(taken) - 1} elements"
            yield Issue(path=(*path, i, "elements"), message=f"{needed}, found {edge.elements}")


def loop_issues(loops: Sequence[Sequence[Edge]], paths: Sequence[KeyPath]) -> list[Issue]:
    """Issues of the outer loop and the holes: crossings, else orientations, else positions of holes."""
    return [*_crossings(loops, paths)] or [*_orientations(loops, paths)] or [*_nestings(loops, paths)]


def polygon(loop: Sequence[Edge]) -> Array:
    """Corners (k, 2) of a polygon that approximates the loop; the first corner is not repeated."""
    return np.vstack([edge.polyline()[:-1] for edge in loop])


def signed_area(corners: Array) -> float:
    """Area of a polygon (k, 2), positive if it is counterclockwise."""
    x, y = (corners - corners.mean(axis=0)).T
    return float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)) / 2)


def contains(corners: Array, point: Array) -> bool:
    """Whether a point (2,) is inside a polygon (k, 2): a ray to the right crosses it an odd number of times."""
    (x0, y0), (x1, y1) = (corners - point).T, (np.roll(corners, -1, axis=0) - point).T
    straddles = (y0 > 0) != (y1 > 0)
    # The ray crosses a side if the point is on its left for a rising side, on its right for a falling one.
    right = np.where(y1 > y0, 1.0, -1.0) * (x0 * y1 - x1 * y0) > 0
    return bool(np.count_nonzero(straddles & right) % 2)


def _crossings(loops: Sequence[Sequence[Edge]], paths: Sequence[KeyPath]) -> Iterator[Issue]:
    """Issues of edges that meet an earlier edge, or themselves, except at a common end; one for each edge."""
    placed = [(edge, (*path, i)) for loop, path in zip(loops, paths, strict=True) for i, edge in enumerate(loop)]
    lines = [edge.polyline() for edge, _ in placed]
    tolerance = TOUCHING * float(np.hypot(*np.ptp(np.vstack(lines), axis=0)))
    reported: set[int] = set()
    for i, j in _pairs_close_by(lines, tolerance + 2 * max(sagitta(edge) for edge, _ in placed)):
        (one, _), (other, path) = placed[i], placed[j]
        if j in reported:
            continue
        point = first_meeting(lines[i], lines[j], tolerance, itself=i == j)
        if point is None and i != j and dist(one.start, other.start) <= tolerance:
            point = one.start
        if point is None and i != j:
            point = near_miss(one, other)
        if point is not None:
            reported.add(j)
            what = "itself" if i == j else f"'{one.name}'"
            where = f"at ({point[0]:.6g}, {point[1]:.6g})"
            message = f"'{other.name}' crosses or touches {what} {where}; neighbors may meet at their common end only"
            yield Issue(path=path, message=message)


def _pairs_close_by(lines: Sequence[Array], tolerance: float) -> list[tuple[int, int]]:
    """Pairs i <= j of polylines whose bounding boxes overlap."""
    low, high = np.array([line.min(axis=0) for line in lines]), np.array([line.max(axis=0) for line in lines])
    meets = (low[:, None] <= high + tolerance).all(axis=2)
    i, j = np.nonzero(np.triu(meets & meets.T))
    return [*zip(i.tolist(), j.tolist(), strict=True)]


def first_meeting(one: Array, other: Array, tolerance: float, *, itself: bool = False) -> Array | None:
    """First common point (2,) [L] of two polylines (k, 2), (m, 2) except common corners; None if there is none.

    Up to the distance `tolerance` they touch; `itself` tells that both are the same polyline.
    """
    rows = max(PAIRS_AT_ONCE // len(other), 1)
    for begin in range(0, len(one) - 1, rows):
        some = one[begin : begin + rows + 1]
        i, j = _sides_close_by(some, other, 2 * tolerance)
        if itself:
            i, j = i[later := j > i + begin], j[later]
        meets, points = _meetings(some[i], some[i + 1], other[j], other[j + 1], tolerance)
        if meets.any():
            return points[np.argmax(meets)]
    return None


def _sides_close_by(one: Array, other: Array, distance: float) -> tuple[IntArray, IntArray]:
    """Sides (pairs,) of two polylines whose bounding boxes are no farther apart than the distance, in order."""
    near = np.ones((len(one) - 1, len(other) - 1), dtype=bool)
    for x, y in zip(one.T, other.T, strict=True):
        low, high = np.minimum(x[:-1], x[1:]) - distance, np.maximum(x[:-1], x[1:]) + distance
        near &= (low[:, None] <= np.maximum(y[:-1], y[1:])) & (high[:, None] >= np.minimum(y[:-1], y[1:]))
    i, j = np.nonzero(near)
    return i, j


def _meetings(p: Array, p_end: Array, q: Array, q_end: Array, tolerance: float) -> tuple[BoolArray, Array]:
    """Which sides q + u s (m, 2) cross, touch or overlap their sides p + t r (m, 2), and the common points (m, 2)."""
    r, s = p_end - p, q_end - q
    length, lengths = np.hypot(r[:, 0], r[:, 1]), np.hypot(s[:, 0], s[:, 1])
    turn, off = _cross(r, s), _cross(q - p, r)
    parallel = np.abs(turn) <= 1e-12 * length * lengths
    turn = np.where(parallel, 1.0, turn)
    t, u = _cross(q - p, s) / turn, off / turn
    slack, slacks = tolerance / length, tolerance / lengths
    inside = (t >= -slack) & (t <= 1 + slack) & (u >= -slacks) & (u <= 1 + slacks)
    crossing = inside & ~(parallel | _share_a_corner((p, p_end), (q, q_end)))
    first, last = (((end - p) * r).sum(axis=1) / length**2 for end in (q, q_end))
    low, high = np.maximum(np.minimum(first, last), 0), np.minimum(np.maximum(first, last), 1)
    overlapping = parallel & (np.abs(off) <= tolerance * length) & (high - low > slack)
    return crossing | overlapping, p + np.where(parallel, (low + high) / 2, t)[:, None] * r


def _share_a_corner(ends: tuple[Array, Array], others: tuple[Array, Array]) -> BoolArray:
    """Which sides (m,) have exactly the same point as one of the ends."""
    return np.any([(end == other).all(axis=1) for end in ends for other in others], axis=0)


def _cross(a: Array, b: Array) -> Array:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def _orientations(loops: Sequence[Sequence[Edge]], paths: Sequence[KeyPath]) -> Iterator[Issue]:
    """Issues of loops that have the body on their right."""
    for number, (loop, path) in enumerate(zip(loops, paths, strict=True)):
        counterclockwise = signed_area(polygon(loop)) > 0
        if number == 0 and not counterclockwise:
            message = "the outer loop must run counterclockwise, but runs clockwise; "
        elif number > 0 and counterclockwise:
            message = "a hole must run clockwise, but runs counterclockwise; "
        else:
            continue
        yield Issue(path=path, message=message + _how_to_reverse(loop))


def _how_to_reverse(loop: Sequence[Edge]) -> str:
    """Say how to reverse a loop."""
    if len(loop) == 1:
        return "exchange its two angles"
    return "list its edges in the opposite order and exchange the start and end (or the angles) of each"


def _nestings(loops: Sequence[Sequence[Edge]], paths: Sequence[KeyPath]) -> Iterator[Issue]:
    """Issues of holes that are outside the body, or inside another hole."""
    outlines = [polygon(loop) for loop in loops]
    for i in range(1, len(loops)):
        name = loops[i][0].name
        if not contains(outlines[0], outlines[i][0]):
            yield Issue(path=paths[i], message=f"the hole of '{name}' is outside the outer loop; move it inside")
        for j in range(1, len(loops)):
            if i != j and contains(outlines[j], outlines[i][0]):
                message = f"the hole of '{name}' is inside the hole of '{loops[j][0].name}'; leave one of them out"
                yield Issue(path=paths[i], message=message)
