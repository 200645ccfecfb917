"""Rigid surfaces: gap and unit normal, which points from the surface into the body."""

from collections.abc import Mapping
from functools import cached_property
from itertools import pairwise
from typing import Annotated, Any, Literal, NamedTuple, Self, get_args

import numpy as np
from pydantic import BeforeValidator, Field, model_validator
from scipy.interpolate import CubicSpline

from bemcontact.arrays import Array
from bemcontact.problem.conditions import Condition, Loads
from bemcontact.problem.validation import Name, Point, Positive, SpecModel, TaggedUnion, invalid

ON_CORNER = 1e-9
"""Distance of a point from a corner, relative to the extent of line and points, up to which it is on the corner."""
MOST_POINTS = 1000
"""Largest number of points of a line or curve."""
SAMPLES = 16
"""Number of starting points for the nearest point, between two points of a spline."""
NEWTON_STEPS = 60


class Closest(NamedTuple):
    """Gap (k,) [L] and unit normals (k, 2) from the surface into the body; the gap is negative inside the surface.

    The point of the surface that is closest to x is x - gap · normal.
    """

    gap: Array
    normals: Array


class Plane(SpecModel):
    """An infinite straight surface."""

    kind: Literal["plane"] = "plane"
    """The shape of the surface: plane, circle, polyline, spline, or deflected_contour."""
    point: Point
    """Any point [x, y] of the surface."""
    normal: Point
    """The direction [x, y] from the surface into the body, of any length."""

    @model_validator(mode="after")
    def _directed(self) -> Self:
        """Refuse a zero normal."""
        if not np.hypot(*self.normal) > 0:
            raise invalid("the normal [0, 0] has no direction; give the direction from the surface into the body")
        return self

    @property
    def unit_normal(self) -> Point:
        """The normal with length 1."""
        return _of_length_one(self.normal)

    def closest(self, points: Array) -> Closest:
        """Gap and normal at points (k, 2) [L]."""
        normal = np.array(self.unit_normal)
        offset = np.asarray(points, float) - np.array(self.point)
        return Closest(offset @ normal, np.tile(normal, (len(offset), 1)))


class Circle(SpecModel):
    """A rigid disk with the body outside, or a rigid hole with the body inside."""

    kind: Literal["circle"] = "circle"
    """The shape of the surface: plane, circle, polyline, spline, or deflected_contour."""
    center: Point
    """The center [x, y]."""
    radius: Positive
    """The radius."""
    body: Literal["outside", "inside"]
    """The side of the circle with the body: outside or inside."""

    def closest(self, points: Array) -> Closest:
        """Gap and normal at points (k, 2) [L]."""
        offset = np.asarray(points, float) - np.array(self.center)
        side = 1.0 if self.body == "outside" else -1.0
        return Closest(side * (np.hypot(*offset.T) - self.radius), side * _unit(offset, np.array([0.0, 1.0])))


class Polyline(SpecModel):
    """A polygonal line with the body on its left; its first and last segments are infinite."""

    kind: Literal["polyline"] = "polyline"
    """The shape of the surface: plane, circle, polyline, spline, or deflected_contour."""
    points: Annotated[tuple[Point, ...], Field(min_length=2, max_length=MOST_POINTS)]
    """The corners [x, y] in order; the body is on the left of the line."""

    @model_validator(mode="after")
    def _simple(self) -> Self:
        """Refuse repeated points, and segments that fold back on the previous one."""
        _ensure_simple(self.points)
        return self

    def closest(self, points: Array) -> Closest:
        """Gap and normal at points (k, 2) [L] for the nearest segment.

        If a corner is nearest, the normal is radial from the corner. On a corner, up to round-off, the normal is the
        bisector of the normals of both segments.
        """
        points, corners = np.asarray(points, float), np.array(self.points)
        sides = np.diff(corners, axis=0)
        lengths = np.hypot(*sides.T)
        directions = sides / lengths[:, None]
        lefts = np.column_stack([-directions[:, 1], directions[:, 0]])
        along = np.einsum("ksi,si->ks", points[:, None] - corners[:-1], directions)
        low, high = np.zeros(len(sides)), lengths.copy()
        low[0], high[-1] = -np.inf, np.inf
        held = np.clip(along, low, high)
        feet = corners[:-1] + held[:, :, None] * directions
        nearest = np.argmin(np.hypot(*np.moveaxis(points[:, None] - feet, 2, 0)), axis=1)
        rows = np.arange(len(points))
        corner = nearest + (along > high)[rows, nearest]
        at_corner = (held != along)[rows, nearest]
        before, after = lefts[np.clip(corner - 1, 0, len(sides) - 1)], lefts[np.clip(corner, 0, len(sides) - 1)]
        offset = points - feet[rows, nearest]
        side = np.where(np.einsum("ki,ki->k", offset, before + after) < 0, -1.0, 1.0)
        radial = _unit(side[:, None] * offset, before + after)
        normals = np.where(at_corner[:, None], radial, lefts[nearest])
        inner = corners[1:-1]
        distances = np.hypot(*np.moveaxis(points[:, None] - inner, 2, 0))
        size = np.ptp(np.concatenate([points, corners]), axis=0).max(initial=0.0)
        on, which = np.nonzero(distances <= ON_CORNER * size)
        normals[on] = _unit(lefts[which] + lefts[which + 1], lefts[which])
        return Closest(np.einsum("ki,ki->k", offset, normals), normals)


class Spline(SpecModel):
    """A smooth curve through points with the body on its left; it continues straight beyond both ends.

    Both coordinates are natural cubic splines of the length along the chords.
    """

    kind: Literal["spline"] = "spline"
    """The shape of the surface: plane, circle, polyline, spline, or deflected_contour."""
    points: Annotated[tuple[Point, ...], Field(min_length=2, max_length=MOST_POINTS)]
    """The points [x, y] in order; the body is on the left of the curve."""

    @model_validator(mode="after")
    def _simple(self) -> Self:
        """Refuse repeated points, and chords that fold back on the previous one."""
        _ensure_simple(self.points)
        return self

    @cached_property
    def curve(self) -> CubicSpline:
        """Points (2,) of the curve by the length along the chords, which starts at zero."""
        points = np.array(self.points)
        return CubicSpline(np.append(0.0, np.hypot(*np.diff(points, axis=0).T).cumsum()), points, bc_type="natural")

    def closest(self, points: Array) -> Closest:
        """Gap and normal at points (k, 2) [L] for the nearest point of the curve or of its straight ends.

        Newton's method starts from the nearest sample on the curve. It finds the nearest point unless the curve bends
        more than once between two samples.
        """
        points = np.asarray(points, float)
        t = np.stack([self._along_end(points, 0), self._on_curve(points), self._along_end(points, -1)], axis=1)
        feet, tangents = self._at(t)
        nearest = np.argmin(np.hypot(*np.moveaxis(points[:, None] - feet, 2, 0)), axis=1)
        rows = np.arange(len(points))
        foot, tangent = feet[rows, nearest], tangents[rows, nearest]
        normals = np.column_stack([-tangent[:, 1], tangent[:, 0]]) / np.hypot(*tangent.T)[:, None]
        return Closest(np.einsum("ki,ki->k", points - foot, normals), normals)

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
        curve = self.curve
        knots = np.concatenate([np.linspace(a, b, SAMPLES, endpoint=False) for a, b in pairwise(curve.x)])
        samples = np.append(knots, curve.x[-1])
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


def _not_empty(value: Any) -> Any:
    """Refuse an empty condition of a contour, which may be meant to remove a load."""
    if isinstance(value, Mapping) and all(part == {} for part in value.values()):
        raise invalid(
            "the condition is empty; give traction: {x: 0, y: 0} to remove the load of the problem, or leave the edge "
            "out to keep it"
        )
    return value


OtherCondition = Annotated[Condition, BeforeValidator(_not_empty)]
"""A condition that replaces that of the problem."""


class DeflectedContour(SpecModel):
    """The contour of the body itself, deflected by other loads without contact.

    The initial gap of a material point is its displacement against a fixed direction d: ε = -u·d, where u is the
    displacement under the other loads. These are the conditions of the problem, with those given here in place of the
    conditions of the same edges, and the volume loads given here. The volume loads of the problem do not act.
    """

    kind: Literal["deflected_contour"] = "deflected_contour"
    """The shape of the surface: plane, circle, polyline, spline, or deflected_contour."""
    conditions: Annotated[dict[Name, OtherCondition], Field(default_factory=dict)]
    """The conditions that replace those of the problem, by edge name; other edges keep their conditions."""
    loads: Loads = Loads()
    """The loads on the volume that deflect the contour. The volume loads of the problem do not act on it."""
    direction: Point
    """The direction [x, y] in which the gap is measured, from the surface into the body, of any length."""

    @model_validator(mode="after")
    def _deflected(self) -> Self:
        """Refuse a zero direction, and a contour without loads of its own."""
        if not np.hypot(*self.direction) > 0:
            raise invalid("the direction [0, 0] has no direction; give the direction from the surface into the body")
        if not self.conditions and self.loads == Loads():
            raise invalid("the contour has no loads of its own; give conditions or loads that deflect it")
        return self

    @property
    def unit_direction(self) -> Point:
        """The direction with length 1."""
        return _of_length_one(self.direction)

    def behind(self, displacement: Array) -> Closest:
        """Gap and normal at points whose displacement (k, 2) [L] under the other loads is given."""
        direction = np.array(self.unit_direction)
        return Closest(-(displacement @ direction), np.tile(direction, (len(displacement), 1)))


def _ensure_simple(points: tuple[Point, ...]) -> None:
    """Refuse repeated points, and segments that fold back on the previous one."""
    sides = np.diff(np.array(points), axis=0)
    for i, side in enumerate(sides):
        if not np.hypot(*side) > 0:
            raise invalid(f"points {i} and {i + 1} are the same: {list(points[i])}; leave one of them out")
    for i, (side, after) in enumerate(pairwise(sides)):
        if side @ after <= -(1 - 1e-12) * np.hypot(*side) * np.hypot(*after):
            raise invalid(f"the line folds back on itself at point {i + 1}: {list(points[i + 1])}; correct it")


def _of_length_one(vector: Point) -> Point:
    length = float(np.hypot(*vector))
    return vector[0] / length, vector[1] / length


def _unit(vectors: Array, otherwise: Array) -> Array:
    """Unit vectors (k, 2) along vectors (k, 2); along `otherwise` where they are zero."""
    length = np.hypot(vectors[:, 0], vectors[:, 1])[:, None]
    vectors = np.where(length > 0, vectors, otherwise)
    return vectors / np.hypot(vectors[:, 0], vectors[:, 1])[:, None]


Shape = Plane | Circle | Polyline | Spline
"""A rigid surface that has a gap at any point of the plane."""
RigidSurface = Shape | DeflectedContour
"""The surface that the body may touch."""
SurfaceSpec = Annotated[RigidSurface, TaggedUnion(what="a rigid surface", members=get_args(RigidSurface))]
"""A rigid surface whose class is chosen by the key `kind`."""
