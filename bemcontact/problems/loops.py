"""Whether loops enclose one body: they do not cross, they have the right orientation, and the holes are inside."""

from collections.abc import Iterator, Sequence
from functools import lru_cache
from math import dist, pi

import numpy as np

from bemcontact.arrays import Array, BoolArray, IntArray
from bemcontact.errors import Issue, KeyPath
from bemcontact.problems.curves import Edge, cross
from bemcontact.problems.near_misses import near_miss, sagitta

TOUCHING = 1e-9
"""Distance of two edges, relative to the size of the body, up to which they touch."""
CUSP = 1e-6
"""Angle [rad] between two neighbors below which one of them folds back on the other."""
PAIRS_AT_ONCE = 2**20
"""Pairs of sides whose bounding boxes are compared at once: a few megabytes."""
KEPT = 16
"""Boundaries of which the issues are kept: in a study those of many problems are the same."""


def loop_issues(loops: Sequence[Sequence[Edge]], paths: Sequence[KeyPath]) -> list[Issue]:
    """Issues of the outer loop and the holes: crossings, else orientations, else positions of holes and cusps."""
    return [*_issues(tuple(map(tuple, loops)), tuple(paths))]


@lru_cache(maxsize=KEPT)
def _issues(loops: tuple[tuple[Edge, ...], ...], paths: tuple[KeyPath, ...]) -> tuple[Issue, ...]:
    """The issues, found once for all problems with these loops."""
    issues = [*_crossings(loops, paths)] or [*_orientations(loops, paths)]
    return tuple(issues or [*_nestings(loops, paths), *_cusps(loops, paths)])


def polygon(loop: Sequence[Edge]) -> Array:
    """Corners (k, 2) of a polygon that approximates the loop; the first corner is not repeated."""
    return np.vstack([edge.polyline()[:-1] for edge in loop])


def signed_area(corners: Array) -> float:
    """Area of a polygon (k, 2), positive if it is counterclockwise."""
    offsets = corners - corners[0]
    return float(cross(offsets[:-1], offsets[1:]).sum()) / 2


def contains(corners: Array, point: Array) -> bool:
    """Whether a point (2,) is inside a polygon (k, 2): a ray to the right crosses it an odd number of times."""
    (x0, y0), (x1, y1) = (corners - point).T, (np.roll(corners, -1, axis=0) - point).T
    straddles = (y0 > 0) != (y1 > 0)
    # The ray crosses a side if the point is on its left for a rising side, on its right for a falling one.
    right = np.where(y1 > y0, 1.0, -1.0) * (x0 * y1 - x1 * y0) > 0
    return bool(np.count_nonzero(straddles & right) % 2)


def winds_once(line: Array, distance: float) -> bool:
    """Whether a closed polyline (k, 2) surely meets itself nowhere: it winds once about the mean of its corners.

    Each side is seen from there under an angle of the same sense. Then two sides that are not neighbors have another
    one between them on either way around. They are no nearer to each other than the least distance of a side from the
    mean times the least sine of an angle, which has to be more than the `distance` [L].
    """
    x, y = (line - line[:-1].sum(axis=0) / (len(line) - 1)).T
    turn = x[:-1] * y[1:] - y[:-1] * x[1:]
    if turn[0] < 0:
        turn, y = -turn, -y
    if not turn.min() > 0 or np.count_nonzero((y[:-1] < 0) & (y[1:] >= 0)) != 1:
        return False
    away = np.hypot(x, y)
    sine, sides = (turn / (away[:-1] * away[1:])).min(), np.hypot(x[1:] - x[:-1], y[1:] - y[:-1])
    return bool(sine * (turn / sides).min() > distance)


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
            same_loop = placed[i][1][:-1] == path[:-1]
            rule = "neighbors may meet at their common end only" if same_loop else "loops must not meet"
            yield Issue(path=path, message=f"'{other.name}' crosses or touches {what} {where}; {rule}")


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
    if not itself and _are_apart(one, other, 2 * tolerance):
        return None
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


def _are_apart(one: Array, other: Array, distance: float) -> bool:
    """Whether the bounding boxes of two polylines are farther apart than the distance."""
    (low, high), (least, most) = ((line.min(axis=0), line.max(axis=0)) for line in (one, other))
    return bool((low > most + distance).any() or (least > high + distance).any())


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
    turn, off = cross(r, s), cross(q - p, r)
    parallel = np.abs(turn) <= 1e-12 * length * lengths
    turn = np.where(parallel, 1.0, turn)
    t, u = cross(q - p, s) / turn, off / turn
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
        where = (*path, 0, "angles") if len(loop) == 1 else path
        yield Issue(path=where, message=message + _how_to_reverse(loop))


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
            message = f"the hole of '{name}' is outside the outer loop; move it inside, or make it one of the bodies"
            yield Issue(path=paths[i], message=message)
        for j in range(1, len(loops)):
            if i != j and contains(outlines[j], outlines[i][0]):
                message = f"the hole of '{name}' is inside the hole of '{loops[j][0].name}'; leave one of them out"
                yield Issue(path=paths[i], message=message)


def _cusps(loops: Sequence[Sequence[Edge]], paths: Sequence[KeyPath]) -> Iterator[Issue]:
    """Issues of neighbors that leave their common end in the same direction: the stress there has no meaning."""
    for loop, path in zip(loops, paths, strict=True):
        for i, (before, edge) in enumerate(zip((loop[-1], *loop[:-1]), loop, strict=True)):
            turn = edge.curve.tangent_angle(np.zeros(1))[0] - before.curve.tangent_angle(np.ones(1))[0]
            if abs(turn % (2 * pi) - pi) < CUSP:
                where = f"({edge.start[0]:.6g}, {edge.start[1]:.6g})"
                message = f"'{before.name}' and '{edge.name}' meet at an angle of 0 at {where}; make the corner wider"
                yield Issue(path=(*path, i), message=message)
