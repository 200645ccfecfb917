"""Rigid surfaces along lines, polylines and splines: gap, normals, and the faces that hold points of a body."""

from collections.abc import Mapping
from functools import cached_property
from itertools import pairwise
from typing import Annotated, ClassVar, Literal, NamedTuple, Self

import numpy as np
import scipy
from pydantic import Field, PrivateAttr, model_validator

from bemcontact.arrays import Array, BoolArray, IntArray, magnitudes
from bemcontact.problems.curves import Curve, cross
from bemcontact.problems.loops import first_meeting
from bemcontact.problems.validation import Point, SpecModel, invalid
from bemcontact.problems.way import AS_DRAWN, Way

ON_CORNER = 1e-9
"""Distance of a point from a corner, relative to the extent of line and points, up to which it is on the corner."""
ALIKE = 1e-9
"""Difference of two unit normals that counts as none."""
MOST_POINTS = 1000
"""Largest number of points of a line or curve."""
SAMPLES = 16
"""Number of starting points for the nearest point, between two points of a spline."""
NEWTON_STEPS = 60
LIES_ON = 0.995
"""Cosine of the angle between the normals of body and face from which the body may come to lie on the face."""
STEEP = 0.05
"""Least cosine of the angle between the normals of body and face with which gaps along the former are computed."""


class Closest(NamedTuple):
    """Gap (k,) [L] and unit normals (k, 2) from the surface into the body; the gap is negative inside the surface.

    The point of the surface that is closest to x is x - gap · normal.
    """

    gap: Array
    normals: Array


class Faces(NamedTuple):
    """Faces of a surface that hold points of the boundary of a body.

    The first of three is that of the boundary before a point, the last one that of the boundary after it. The face in
    the middle holds a corner of the body that stands on it, between two others. Nearly everywhere all three are one
    face.

    Parameters
    ----------
    gap : (k, 3) [L]
    normals : (k, 3, 2) unit vectors along which gap and pressure count
    faces : (k, 3, 2) unit normals of the faces; others than `normals` beside a convex corner that presses on the body
    """

    gap: Array
    normals: Array
    faces: Array

    def put(self, here: BoolArray, column: int, gap: Array, normals: Array, faces: Array) -> None:
        """Put others at some points (k,) in one of the three columns, from values at all points."""
        for own, new in zip(self, (gap, normals, faces), strict=True):
            own[here, column] = new[here]

    def after(self, way: Way, points: Array) -> "Faces":
        """Those of a surface after a way, at points (k, 2) [L], with gaps before it: less the way those there."""
        if way == AS_DRAWN:
            return self
        normals, faces = way.turned(self.normals), way.turned(self.faces)
        return Faces(self.gap + np.einsum("ksx,kx->ks", normals, way.motion_at(points)), normals, faces)


LOADED: Mapping[str, str] = dict.fromkeys(
    ("force", "load", "moment", "displacement"),
    "a rigid surface that is loaded or displaced is a tool: tools: {NAME: {zones: ZONE, force: {y: -400}}}, at the top "
    "level",
)
"""Words that are no keys of a rigid surface or of its zone -> what to write instead."""


class LineSurface(SpecModel):
    """A rigid surface along a line."""

    other_words: ClassVar[Mapping[str, str]] = LOADED

    _way: Way = PrivateAttr(AS_DRAWN)

    @property
    def way(self) -> Way:
        """Motion beside the body after which faces, and with them gaps and normals of contact, are found."""
        private = self.__pydantic_private__  # where `self._way` is, which is looked for in all other places first
        assert private is not None
        return private["_way"]

    def after(self, way: Way) -> Self:
        """Copy after another motion beside the body."""
        moved = self.model_copy()
        moved._way = way
        return moved

    def faces(self, points: Array, inward: Array, reach: Array) -> Faces:
        """Find the faces that hold points (k, 2) [L] of a boundary with normals (k, 2, 2) into the body on either side.

        In a concave corner of the surface each side of a point has the face to which it is turned, although the other
        face may be nearer. A convex corner presses on the body along the normals of the body, as far as they lie
        between those of its faces: a smooth boundary cannot lie on a face that is tilted against it, and touches it
        beside the corner only. It presses on both sides of a re-entrant corner of the body up to the distance `reach`
        (k,) [L].
        """
        points, way = np.asarray(points, float), self.way
        return self.faces_as_drawn(way.back(points), way.turned(inward, -1.0), reach).after(way, points)

    def faces_as_drawn(self, points: Array, inward: Array, reach: Array) -> Faces:
        """Those of the surface where it is drawn."""
        raise NotImplementedError


class SmoothSurface(LineSurface):
    """A surface without corners: one face holds both sides of a point."""

    @cached_property
    def nearest(self) -> dict[tuple[Curve, Way], tuple[float, ...]]:
        """Fractions of curves where they are nearest to it after a way, as far as `nearest_places` looked for them."""
        return {}

    def closest(self, points: Array) -> Closest:
        """Gap and normal at points (k, 2) [L]."""
        raise NotImplementedError

    def held(self, points: Array) -> Closest:
        """Gap and normal of the face that holds both sides of points (k, 2) [L], after the way as of `Faces`."""
        way = self.way
        gap, normals = self.closest(way.back(points))
        if way == AS_DRAWN:
            return Closest(gap, normals)
        normals = way.turned(normals)
        return Closest(gap + np.einsum("kx,kx->k", normals, way.motion_at(points)), normals)

    def faces(self, points: Array, inward: Array | None = None, reach: Array | None = None) -> Faces:
        """The nearest face holds both sides of points (k, 2) [L], whatever the normals of the boundary there."""
        gap, normals = (part[:, None].repeat(3, axis=1) for part in self.held(np.asarray(points, float)))
        return Faces(gap, normals, normals)

    def after(self, way: Way) -> Self:
        """Copy after another motion beside the body; both remember the places that are nearest to either."""
        assert self.nearest is not None  # made before it is shared
        return super().after(way)


class Polyline(LineSurface):
    """A polygonal line with the body on its left; its first and last segments are infinite."""

    kind: Literal["polyline"] = "polyline"
    """The shape of the surface: plane, circle, polyline, spline, or deflected_contour."""
    points: Annotated[tuple[Point, ...], Field(min_length=2, max_length=MOST_POINTS)]
    """The corners [x, y] in order; the body is on the left of the line."""

    @model_validator(mode="after")
    def _simple(self) -> Self:
        """Refuse repeated points, segments that fold back, and a line that meets itself."""
        _ensure_simple(self.points)
        _ensure_apart(np.array(self.points))
        return self

    @cached_property
    def sides(self) -> "_Sides":
        """The segments as arrays."""
        corners = np.array(self.points)
        steps = np.diff(corners, axis=0)
        lengths = np.hypot(*steps.T)
        directions = steps / lengths[:, None]
        low, high = np.zeros(len(lengths)), lengths.copy()
        low[0], high[-1] = -np.inf, np.inf
        return _Sides(corners, directions, np.column_stack([-directions[:, 1], directions[:, 0]]), low, high)

    def closest(self, points: Array) -> Closest:
        """Gap and normal at points (k, 2) [L] for the nearest segment.

        If a corner is nearest, the normal is radial from the corner. On a corner, up to round-off, the normal is the
        bisector of the normals of both segments.
        """
        points = np.asarray(points, float)
        return self._closest(points, self._nearest(points))

    def _closest(self, points: Array, place: "_Place") -> Closest:
        """Gap and normal as of `closest`, at points whose nearest place is known."""
        (corners, _, lefts, _, _), (nearest, corner, feet) = self.sides, place
        before, after = lefts[np.clip(corner - 1, 0, len(lefts) - 1)], lefts[np.clip(corner, 0, len(lefts) - 1)]
        offset = points - feet
        side = np.where(np.einsum("ki,ki->k", offset, before + after) < 0, -1.0, 1.0)
        radial = unit_vectors(side[:, None] * offset, before + after)
        normals = np.where((corner >= 0)[:, None], radial, lefts[nearest])
        if len(corners) > 2:
            which, distance = self._nearest_corner(points)
            on = distance <= ON_CORNER * self._extent(points)
            normals[on] = unit_vectors(lefts[which] + lefts[which + 1], lefts[which])[on]
        return Closest(np.einsum("ki,ki->k", offset, normals), normals)

    def faces_as_drawn(self, points: Array, inward: Array, reach: Array) -> Faces:
        """Those of a line with corners at points (k, 2) [L]."""
        place = self._nearest(points)
        gap, normals = (np.repeat(part[:, None], 3, axis=1) for part in self._closest(points, place))
        if len(self.points) == 2:
            return Faces(gap, normals, normals)
        self._hold_in_grooves(points, place, inward, gap, normals)
        held = Faces(gap, normals, normals.copy())
        self._press_on_ridges(points, place.segment, inward, reach, held)
        return held

    def _hold_in_grooves(self, points: Array, place: "_Place", inward: Array, gap: Array, normals: Array) -> None:
        """Put the face to which each side is turned: that of the nearest segment, or of one that rises beside it."""
        # At a corner of the body the other face counts beyond the corner of the surface too. If a corner of the body
        # stands on the nearest face, between two others, the face in the middle holds it.
        (corners, directions, lefts, low, high), (nearest, corner, _) = self.sides, place
        last = len(lefts) - 1
        facing = np.clip(nearest[:, None] + np.array([0, -1, 1]), 0, last)
        offset = points[:, None] - corners[facing]
        along = np.einsum("ksi,ksi->ks", offset, directions[facing])
        rising = np.column_stack([nearest >= 0, *((nearest > 0, nearest < last) & self._concave_beside(nearest))])
        turn = cross(inward[:, 0], inward[:, 1])[:, None]
        rising &= (along >= low[facing]) | (np.arange(3) == 0) | ((turn > 0) & (np.arange(3) == 2))
        rising &= (along <= high[facing]) | (np.arange(3) == 0) | ((turn > 0) & (np.arange(3) == 1))
        held = np.flatnonzero((corner < 0) | self._concave[np.clip(corner - 1, 0, last - 1)])
        turned = np.einsum("kai,ksi->kas", inward, lefts[facing]) + np.array([ALIKE, 0.0, 0.0])
        choice = np.where(rising[:, None], turned, -np.inf).argmax(axis=2)[held]
        stands = (choice > 0).all(axis=1) & (turn[held, 0] > 0)
        for column, chosen in enumerate((choice[:, 0], np.where(stands, 0, choice[:, 0]), choice[:, 1])):
            normals[held, column] = lefts[facing[held, chosen]]
            gap[held, column] = np.einsum("ki,ki->k", offset[held, chosen], normals[held, column])

    def _press_on_ridges(self, points: Array, nearest: IntArray, inward: Array, reach: Array, held: Faces) -> None:
        """Put the normals of the body where a convex corner of the surface presses on it.

        `nearest` (k,) is the segment that is nearest to each point.
        """
        ridges, distances = self._ridges_beside(points, nearest)
        if not np.isfinite(distances).any():
            return
        turn, lefts = cross(inward[:, 0], inward[:, 1]), self.sides.lefts
        own, straight = pressed_normals(inward, turn, held)
        within = [_dot(between_normals(own[:, 1], lefts[i + 1], lefts[i]), own[:, 1]) for i in ridges.T]
        within = np.where(np.isfinite(distances), np.transpose(within), -np.inf)
        near = distances <= np.where(turn < 0, reach, 0.0)[:, None] + ON_CORNER * self._extent(points)
        flat, smooth = np.asarray(near.any(axis=1)), straight & np.isfinite(distances).any(axis=1)
        chosen = np.where(flat, distances.argmin(axis=1), within.argmax(axis=1))
        which = ridges[np.arange(len(points)), chosen]
        before, after, offset = lefts[which], lefts[which + 1], points - self.sides.corners[which + 1]
        among = smooth & ~flat & is_tilted(own, held.normals)
        seen = sees_ridge(points, nearest, points - offset, own[:, 1], held.normals[:, 1], among)
        for column in range(3):
            pressing, gap, on, there = ridge_beside(
                offset, own[:, column], held.normals[:, column], before, after, seen
            )
            held.put(smooth & ~flat & there, column, gap, pressing, on)
            held.put(flat, column, _dot(offset, pressing), pressing, pressing)

    def _ridges_beside(self, points: Array, nearest: IntArray) -> tuple[IntArray, Array]:
        """Inner corners (k, 2), counted from 0, at the ends of the nearest segment; distance [L], infinite of others.

        Others are those that are not convex.
        """
        ends = np.stack([nearest, nearest + 1], axis=1)
        distances = magnitudes(points[:, None] - self.sides.corners[ends])
        distances[~np.pad(~self._concave, 1)[ends]] = np.inf
        return np.clip(ends - 1, 0, len(self.points) - 3), distances

    def beyond_ends(self, points: Array) -> BoolArray:
        """Whether the surface is nearest to points (k, 2) [L] where it goes on straight beyond its ends."""
        (corners, directions, _, _, high), (nearest, _, feet) = self.sides, self._nearest(np.asarray(points, float))
        along = np.einsum("ki,ki->k", feet - corners[nearest], directions[nearest])
        slack, last = ON_CORNER * self._extent(points), len(high) - 1
        length = float(np.hypot(*(corners[-1] - corners[-2])))
        return ((nearest == 0) & (along < -slack)) | ((nearest == last) & (along > length + slack))

    @cached_property
    def turns(self) -> Array:
        """Angle [rad] by which the line turns away from the body at each of its inner corners (s - 1,)."""
        before, after = self.sides.directions[:-1], self.sides.directions[1:]
        return np.arctan2(-cross(before, after), _dot(before, after))

    @cached_property
    def _concave(self) -> BoolArray:
        """Whether the line turns towards the body at each of its inner corners."""
        return self.turns < 0

    def _concave_beside(self, segment: IntArray) -> BoolArray:
        """Whether the line turns towards the body (2, k) where each segment (k,) starts, and where it ends."""
        last = len(self._concave) - 1
        return self._concave[np.clip([segment - 1, segment], 0, last)]

    def _nearest(self, points: Array) -> "_Place":
        """Places of the line that are nearest to points (k, 2).

        A point that is opposite to the end of a segment up to round-off is opposite to the segment: the direction from
        the corner to a point close to it would be that of round-off.
        """
        corners, directions, _, low, high = self.sides
        slack = ON_CORNER * self._extent(points)
        along = np.einsum("ksi,si->ks", points[:, None] - corners[:-1], directions)
        held = np.clip(along, low, high)
        feet = corners[:-1] + held[:, :, None] * directions
        beyond, rows = np.abs(held - along) > slack, np.arange(len(points))
        nearest = np.argmin(magnitudes(points[:, None] - feet) + slack * beyond, axis=1)
        corner = np.where(beyond[rows, nearest], nearest + (along > high)[rows, nearest], -1)
        return _Place(nearest, corner, feet[rows, nearest])

    def _nearest_corner(self, points: Array) -> tuple[IntArray, Array]:
        """Nearest inner corner (k,), counted from 0, and its distance (k,) [L]."""
        distances = magnitudes(np.asarray(points)[:, None] - self.sides.corners[1:-1])
        which = distances.argmin(axis=1)
        return which, distances[np.arange(len(which)), which]

    def _extent(self, points: Array) -> float:
        """Extent of line and points [L], the scale of round-off."""
        return float(np.ptp(np.concatenate([points, self.sides.corners]), axis=0).max(initial=0.0))


class _Place(NamedTuple):
    """Nearest segment (k,), its corner that is nearest or -1 (k,), and the nearest point of the line (k, 2)."""

    segment: IntArray
    corner: IntArray
    point: Array


class _Sides(NamedTuple):
    """Corners (s + 1, 2), directions and left normals (s, 2) of segments, and their range (s,) of arc length [L]."""

    corners: Array
    directions: Array
    lefts: Array
    low: Array
    high: Array


class Spline(SmoothSurface):
    """A smooth curve through points with the body on its left; it continues straight beyond both ends.

    Both coordinates are natural cubic splines of the length along the chords.
    """

    kind: Literal["spline"] = "spline"
    """The shape of the surface: plane, circle, polyline, spline, or deflected_contour."""
    points: Annotated[tuple[Point, ...], Field(min_length=2, max_length=MOST_POINTS)]
    """The points [x, y] in order; the body is on the left of the curve."""

    @model_validator(mode="after")
    def _simple(self) -> Self:
        """Refuse repeated points, chords that fold back, and a curve that meets itself."""
        _ensure_simple(self.points)
        _ensure_apart(self.curve(self.samples))
        return self

    @cached_property
    def curve(self) -> "scipy.interpolate.CubicSpline":
        """Points (2,) of the curve by the length along the chords, which starts at zero."""
        points = np.array(self.points)
        return scipy.interpolate.CubicSpline(
            np.append(0.0, np.hypot(*np.diff(points, axis=0).T).cumsum()), points, bc_type="natural"
        )

    @cached_property
    def samples(self) -> Array:
        """Lengths along the chords, some between two points."""
        knots = [np.linspace(a, b, SAMPLES, endpoint=False) for a, b in pairwise(self.curve.x)]
        return np.append(np.concatenate(knots), self.curve.x[-1])

    @cached_property
    def bulges(self) -> tuple[Array, Array]:
        """How far (s,) [L] the curve leaves each chord beyond the arc that its neighbors bend to, and where (s, 2) [L].

        An arc leaves its chord by an eighth of its length times its turn. Twice that is allowed for the smaller turn at
        its ends; beside a flat part, or where the turns have different signs, there is nothing that the points bend to.
        """
        chords = np.diff(np.array(self.points), axis=0)
        length = np.hypot(*chords.T)
        turns = np.arctan2(cross(chords[:-1], chords[1:]), _dot(chords[:-1], chords[1:]))
        before, after = np.append(turns[:1], turns), np.append(turns, turns[-1:])
        bend = np.where(before * after > 0, np.minimum(abs(before), abs(after)), 0.0) if len(turns) else np.zeros(1)
        places = self.curve(self.samples[:-1].reshape(len(length), SAMPLES))
        away = abs(cross(places - np.array(self.points)[:-1, None], (chords / length[:, None])[:, None]))
        farthest = away.argmax(axis=1)
        rows = np.arange(len(length))
        return away[rows, farthest] - bend * length / 4, places[rows, farthest]

    def closest(self, points: Array) -> Closest:
        """Gap and normal at points (k, 2) [L] for the nearest point of the curve or of its straight ends.

        Newton's method starts from the nearest sample on the curve. It finds the nearest point unless the curve bends
        more than once between two samples.
        """
        points = np.asarray(points, float)
        foot, tangent = self._at(self._nearest(points))
        normals = np.column_stack([-tangent[:, 1], tangent[:, 0]]) / np.hypot(*tangent.T)[:, None]
        return Closest(np.einsum("ki,ki->k", points - foot, normals), normals)

    def beyond_ends(self, points: Array) -> BoolArray:
        """Whether the surface is nearest to points (k, 2) [L] where it goes on straight beyond its ends."""
        t, length = self._nearest(np.asarray(points, float)), self.curve.x[-1]
        return (t < -ON_CORNER * length) | (t > (1 + ON_CORNER) * length)

    def _nearest(self, points: Array) -> Array:
        """Parameters (k,) of the nearest points, beyond the ends on the straight continuations."""
        t = np.stack([self._along_end(points, 0), self._on_curve(points), self._along_end(points, -1)], axis=1)
        feet, _ = self._at(t)
        nearest = np.argmin(magnitudes(points[:, None] - feet), axis=1)
        return t[np.arange(len(points)), nearest]

    def _at(self, t: Array) -> tuple[Array, Array]:
        """Points and tangents (..., 2) at parameters (...,), also beyond the ends."""
        curve = self.curve
        inside = np.clip(t, 0.0, curve.x[-1])
        tangents = curve(inside, 1)
        return curve(inside) + (t - inside)[..., None] * tangents, tangents

    def _along_end(self, points: Array, end: int) -> Array:
        """Parameters (k,) of the nearest points on a straight end: the first (0) or the last (-1)."""
        t, tangent = self.curve.x[end], self.curve(self.curve.x[end], 1)
        along = (points - np.array(self.points[end])) @ tangent / (tangent @ tangent)
        return t + (np.minimum(along, 0.0) if end == 0 else np.maximum(along, 0.0))

    def _on_curve(self, points: Array) -> Array:
        """Parameters (k,) of the nearest points on the curve, by Newton's method with bisection between two samples."""
        curve, samples = self.curve, self.samples
        squares = ((points[:, None] - curve(samples)) ** 2).sum(axis=2)
        i = np.argmin(squares, axis=1)
        low, high, t = samples[np.maximum(i - 1, 0)], samples[np.minimum(i + 1, len(samples) - 1)], samples[i]
        for _ in range(NEWTON_STEPS):
            off, tangent = curve(t) - points, curve(t, 1)
            slope = np.einsum("ki,ki->k", off, tangent)
            low, high = np.where(slope <= 0, t, low), np.where(slope >= 0, t, high)
            bend = np.einsum("ki,ki->k", tangent, tangent) + np.einsum("ki,ki->k", off, curve(t, 2))
            step = t - slope / np.where(bend > 0, bend, np.inf)
            t_next = np.where((step > low) & (step < high) & (bend > 0), step, (low + high) / 2)
            if np.all(np.abs(t_next - t) <= 1e-15 * curve.x[-1]):
                break
            t = t_next
        return t


def _ensure_simple(points: tuple[Point, ...]) -> None:
    """Refuse repeated neighbors, and segments that fold back on the previous one."""
    sides = np.diff(np.array(points), axis=0)
    for i, side in enumerate(sides):
        if not np.hypot(*side) > 0:
            raise invalid(f"points {i} and {i + 1} are the same: {list(points[i])}; leave one of them out")
    for i, (side, after) in enumerate(pairwise(sides)):
        if side @ after <= -(1 - 1e-12) * np.hypot(*side) * np.hypot(*after):
            raise invalid(f"the line folds back on itself at point {i + 1}: {list(points[i + 1])}; correct it")


def _ensure_apart(line: Array) -> None:
    """Refuse a line (k, 2) that meets itself, or goes on straight beyond its ends so that it does."""
    turns = np.unwrap(np.arctan2(*np.diff(line, axis=0).T[::-1]))
    if np.ptp(turns) < np.pi - ON_CORNER:
        return  # neither the line nor its ends can come back
    extent = float(np.ptp(line, axis=0).max())
    tolerance, reach = ON_CORNER * extent, 3 * extent
    if (point := first_meeting(line, line, tolerance, itself=True)) is None:
        point = _first_repeated(line, tolerance)
    if point is not None:
        raise invalid(
            f"the line crosses or touches itself at {_coordinates(point)}; it must not; check the order of its points"
        )
    for end, before, rest, name in ((0, 1, line[1:], "first"), (-1, -2, line[:-1], "last")):
        away = line[end] - line[before]
        beyond = np.array([line[end], line[end] + reach * away / np.hypot(*away)])
        if (point := first_meeting(beyond, rest, tolerance)) is not None:
            raise invalid(
                f"the line goes on straight beyond its {name} point, and meets itself at {_coordinates(point)}; add a "
                "point that leads away from there"
            )


def _first_repeated(line: Array, tolerance: float) -> Array | None:
    """First point (2,) of a line (k, 2) to which it returns; None if there is none."""
    for i, point in enumerate(line[:-2]):
        if np.hypot(*(line[i + 2 :] - point).T).min() <= tolerance:
            return point
    return None


def _coordinates(point: Array) -> str:
    return f"({point[0]:.6g}, {point[1]:.6g})"


def pressed_normals(inward: Array, turn: Array, held: Faces) -> tuple[Array, BoolArray]:
    """Normals (k, 3, 2) of the body against which corners press, and whether (k,) a smooth side of it is pressed.

    At a corner of the body of which one side lies on a face it is that side.
    """
    own = np.where((turn < 0)[:, None, None], inward[:, [0, 0, 1]], inward.sum(axis=1, keepdims=True))
    lies = np.einsum("kai,kai->ka", inward, held.normals[:, [0, 2]]) > LIES_ON
    ends = (turn > 0) & (lies[:, 0] != lies[:, 1])
    own[ends] = inward[ends, lies[ends].argmax(axis=1), None]
    return unit_vectors(own.reshape(-1, 2), own.reshape(-1, 2)).reshape(own.shape), (turn == 0) | ends


class RidgeGap(NamedTuple):
    """What a convex corner of a surface means for places of a smooth boundary beside it.

    Parameters
    ----------
    normals : (k, 2) of the boundary, as far as they lie between those of both faces
    gap : (k,) along these normals [L]
    faces : (k, 2) normals of the faces that the places meet in this direction
    counts : (k,) whether this is the gap, and not the distance: the face beside a place is tilted against the boundary,
        which cannot come to lie on it
    """

    normals: Array
    gap: Array
    faces: Array
    counts: BoolArray


def is_tilted(body: Array, held: Array) -> BoolArray:
    """Whether a side of places (k,), with normals (k, 3, 2) into the body, is tilted against the face that holds it."""
    return (np.einsum("kai,kai->ka", held, body) < LIES_ON).any(axis=1)


def sees_ridge(points: Array, face: IntArray, ridge: Array, body: Array, held: Array, among: BoolArray) -> BoolArray:
    """Whether places (k,) of a body come nearer to a ridge, at (k, 2) for each, than any place that lies on their face.

    It is found `among` (k,) some of them, since it takes long, and said of the others.

    Where the body is parallel to a face between a place and the ridge, it comes to lie on this face there first, as a
    roller does on a flat one: the ridge presses on nothing behind. `face` (k,) numbers the nearest faces, `body` (k, 2)
    are the normals into the body, and `held` (k, 2) those of the faces.
    """
    away, seen = np.hypot(*(points - ridge).T), np.ones(len(points), bool)
    beside = abs(cross(points - ridge, held)) > ON_CORNER * float(np.ptp(points, axis=0).max(initial=0.0))
    lies = beside & (_dot(held, body) >= LIES_ON)
    for number in np.unique(face[among]).tolist():
        flat, own = points[lies & (face == number)], np.flatnonzero(among & (face == number))
        if not len(flat):
            continue
        nearest = magnitudes(flat[:, None] - ridge[own]).min(axis=0)
        seen[own] = away[own] <= nearest
    return seen


def ridge_beside(offset: Array, body: Array, held: Array, before: Array, after: Array, seen: BoolArray) -> RidgeGap:
    """Gap along the boundary's own normals beside a convex corner.

    `offset` (k, 2) [L] is from the corner, `body` (k, 2) the normals into the body, `held` (k, 2) those of the nearest
    places of the surface, `before` and `after` (k, 2) those of both faces; the surface turns clockwise at the corner.
    `seen` (k,) is that of `sees_ridge`.
    """
    normals, tilt = between_normals(body, after, before), _dot(held, body)
    along = np.stack([_dot(offset, face) / np.maximum(_dot(normals, face), STEEP) for face in (before, after)])
    gap, faces = along.max(axis=0), np.where((along[0] >= along[1])[:, None], before, after)
    opens = gap >= abs(cross(offset, body) * cross(held, body)) / 2
    inside = _dot(normals, body) >= 1 - ALIKE
    tilted = seen & (tilt < LIES_ON) & (_dot(normals, body) >= LIES_ON)
    return RidgeGap(normals, gap, faces, tilted | (inside & opens & (abs(cross(held, body)) > ALIKE)))


def _dot(a: Array, b: Array) -> Array:
    return np.einsum("ki,ki->k", a, b)


def between_normals(vectors: Array, first: Array, last: Array) -> Array:
    """Unit vectors along vectors (k, 2), or the nearer of two unit normals where these are not on either side."""
    inside = (cross(first, vectors) >= 0) & (cross(vectors, last) >= 0)
    nearer = np.einsum("ki,ki->k", vectors, first) > np.einsum("ki,ki->k", vectors, last)
    return np.where(inside[:, None], unit_vectors(vectors, last), np.where(nearer[:, None], first, last))


def unit_vectors(vectors: Array, otherwise: Array) -> Array:
    """Unit vectors (k, 2) along vectors (k, 2); along `otherwise` where they are zero."""
    length = np.hypot(vectors[:, 0], vectors[:, 1])[:, None]
    vectors = np.where(length > 0, vectors, otherwise)
    return vectors / np.hypot(vectors[:, 0], vectors[:, 1])[:, None]
