"""Rigid surfaces: gap and unit normal, from the surface into the body."""

from collections.abc import Mapping
from functools import cached_property
from itertools import pairwise
from typing import Annotated, Any, Literal, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, Field, model_validator
from scipy.interpolate import CubicSpline

from bemcontact.problem.conditions import Condition
from bemcontact.problem.loads import Loads
from bemcontact.problem.tagged_union import ByKind
from bemcontact.problem.validation import Name, Point, Positive, Stated, complain

Array = NDArray[np.float64]


ON_CORNER = 1e-9
"""Distance from a corner, over the extent of line and points, below which a point is on it."""


SAMPLES = 16
"""Of a spline between two of its points, to start from."""
NEWTON_STEPS = 60


class Closest(NamedTuple):
    """Gap (k,) [L] along the unit normals (k, 2), which point from the surface into the body; negative inside it.

    The foot of a point x on the surface is x - gap · normal.
    """

    gap: Array
    normals: Array


class Plane(Stated):
    """A straight surface without end."""

    kind: Literal["plane"] = "plane"
    """The shape of the surface: plane, circle, polyline, spline, or deflected_contour."""
    point: Point
    """Any point [x, y] of the surface."""
    normal: Point
    """The direction [x, y] from the surface into the body, of any length."""

    @model_validator(mode="after")
    def _directed(self) -> Self:
        """Refuse a normal without direction."""
        if not np.hypot(*self.normal) > 0:
            raise complain("the normal [0, 0] has no direction; let it point from the surface into the body")
        return self

    @property
    def unit_normal(self) -> Point:
        """The normal, of length 1."""
        return _of_length_one(self.normal)

    def closest(self, points: Array) -> Closest:
        """Gap and normal at points (k, 2) [L]."""
        normal = np.array(self.unit_normal)
        offset = np.asarray(points, float) - np.array(self.point)
        return Closest(offset @ normal, np.tile(normal, (len(offset), 1)))


class Circle(Stated):
    """A rigid disc with the body outside, or a rigid hole with the body inside."""

    kind: Literal["circle"] = "circle"
    """The shape of the surface: plane, circle, polyline, spline, or deflected_contour."""
    center: Point
    """The centre [x, y]."""
    radius: Positive
    """The radius."""
    body: Literal["outside", "inside"]
    """The side of the circle on which the body is: outside or inside."""

    def closest(self, points: Array) -> Closest:
        """Gap and normal at points (k, 2) [L]."""
        offset = np.asarray(points, float) - np.array(self.center)
        side = 1.0 if self.body == "outside" else -1.0
        return Closest(side * (np.hypot(*offset.T) - self.radius), side * _unit(offset, np.array([0.0, 1.0])))


class Polyline(Stated):
    """Straight pieces from point to point, the first and the last going on without end, the body on the left."""

    kind: Literal["polyline"] = "polyline"
    """The shape of the surface: plane, circle, polyline, spline, or deflected_contour."""
    points: Annotated[tuple[Point, ...], Field(min_length=2)]
    """The corners [x, y] in order; the body is on the left of one who walks along them."""

    @model_validator(mode="after")
    def _simple(self) -> Self:
        """Refuse points that repeat and pieces that fold back on the one before."""
        _ensure_simple(self.points)
        return self

    def closest(self, points: Array) -> Closest:
        """Gap and normal at points (k, 2) [L], of the nearest piece; beyond a corner the normal is radial from it.

        On a corner, up to round-off, it is the bisector of the normals before and after.
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


class Spline(Stated):
    """A smooth curve through points, straight at both ends and going on so without end, the body on the left.

    Both coordinates are natural cubic splines of the length along the chords.
    """

    kind: Literal["spline"] = "spline"
    """The shape of the surface: plane, circle, polyline, spline, or deflected_contour."""
    points: Annotated[tuple[Point, ...], Field(min_length=2)]
    """The points [x, y] in order; the body is on the left of one who walks along them."""

    @model_validator(mode="after")
    def _simple(self) -> Self:
        """Refuse points that repeat, and chords that fold back on the one before."""
        _ensure_simple(self.points)
        return self

    @cached_property
    def curve(self) -> CubicSpline:
        """The points (2,) of the curve by the length along the chords, from zero."""
        points = np.array(self.points)
        return CubicSpline(np.append(0.0, np.hypot(*np.diff(points, axis=0).T).cumsum()), points, bc_type="natural")

    def closest(self, points: Array) -> Closest:
        """Gap and normal at points (k, 2) [L], of the nearest point of the curve or of its straight ends.

        Newton's method starts from the nearest of the samples on the curve, which finds the nearest point unless the
        curve bends more than once between two samples.
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
        """Points and tangents (..., 2) at parameters (...,), which may be beyond the ends."""
        curve = self.curve
        inside = np.clip(t, 0.0, curve.x[-1])
        tangents = curve(inside, 1)
        return curve(inside) + (t - inside)[..., None] * tangents, tangents

    def _along_end(self, points: Array, end: int) -> Array:
        """Parameter (k,) of the nearest point of a straight end: the first (0) or the last (-1)."""
        t, tangent = self.curve.x[end], self.curve(self.curve.x[end], 1)
        along = (points - np.array(self.points[end])) @ tangent / (tangent @ tangent)
        return t + (np.minimum(along, 0.0) if end == 0 else np.maximum(along, 0.0))

    def _on_curve(self, points: Array) -> Array:
        """Parameter (k,) of the nearest point of the curve: Newton between two samples, halving where it strays."""
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


def _says_something(value: Any) -> Any:
    """Refuse a condition of the contour that states nothing: here, it may be meant to take a load away."""
    if isinstance(value, Mapping) and all(part == {} for part in value.values()):
        raise complain(
            "it states nothing; give traction: {x: 0, y: 0} if nothing acts there while the contour is deflected, or "
            "leave the edge out, which then keeps the condition of the problem"
        )
    return value


OtherCondition = Annotated[Condition, BeforeValidator(_says_something)]
"""A condition in place of the problem's own."""


class DeflectedContour(Stated):
    """The contour that the body itself is deflected to by other loads, touching nothing.

    The gap is measured between the two places of one material point, along a fixed direction d: ε = -u·d, where u is
    the displacement under the other loads. Those are the conditions of the problem with those given here in place of
    what they have for the same edges, and the loads on the volume given here; those of the problem do not act.
    """

    kind: Literal["deflected_contour"] = "deflected_contour"
    """The shape of the surface: plane, circle, polyline, spline, or deflected_contour."""
    conditions: Annotated[dict[Name, OtherCondition], Field(default_factory=dict)]
    """What is prescribed on edges instead of the problem's own conditions there, by edge name; others are kept."""
    loads: Loads = Loads()
    """Loads on the volume that deflect the contour; none if left out, whatever the problem has."""
    direction: Point
    """The direction [x, y] in which the gap is measured, from the surface into the body, of any length."""

    @model_validator(mode="after")
    def _deflected(self) -> Self:
        """Refuse a direction that is none, and a contour of the very problem."""
        if not np.hypot(*self.direction) > 0:
            raise complain("the direction [0, 0] is none; let it point from the surface into the body")
        if not self.conditions and self.loads == Loads():
            raise complain("nothing says what deflects the contour; give conditions that differ from the problem's")
        return self

    @property
    def unit_direction(self) -> Point:
        """The direction, of length 1."""
        return _of_length_one(self.direction)

    def behind(self, displacement: Array) -> Closest:
        """Gap and normal at points that the other loads displace by (k, 2) [L]."""
        direction = np.array(self.unit_direction)
        return Closest(-(displacement @ direction), np.tile(direction, (len(displacement), 1)))


def _ensure_simple(points: tuple[Point, ...]) -> None:
    """Refuse points that repeat and pieces that fold back on the one before."""
    sides = np.diff(np.array(points), axis=0)
    for i, side in enumerate(sides):
        if not np.hypot(*side) > 0:
            raise complain(f"points {i} and {i + 1} are the same: {list(points[i])}; leave one out")
    for i, (side, after) in enumerate(pairwise(sides)):
        if side @ after <= -(1 - 1e-12) * np.hypot(*side) * np.hypot(*after):
            raise complain(f"the line folds back on itself at point {i + 1}: {list(points[i + 1])}")


def _of_length_one(vector: Point) -> Point:
    length = float(np.hypot(*vector))
    return vector[0] / length, vector[1] / length


def _unit(vectors: Array, otherwise: Array) -> Array:
    """Unit vectors along vectors (k, 2); along `otherwise` where they vanish."""
    length = np.hypot(vectors[:, 0], vectors[:, 1])[:, None]
    vectors = np.where(length > 0, vectors, otherwise)
    return vectors / np.hypot(vectors[:, 0], vectors[:, 1])[:, None]


Shape = Plane | Circle | Polyline | Spline
"""A rigid surface that has a gap at any point of the plane."""
RigidSurface = Shape | DeflectedContour
"""The surface that the body may touch."""
StatedSurface = Annotated[
    RigidSurface,
    ByKind(
        what="a rigid surface",
        kinds={
            "plane": Plane,
            "circle": Circle,
            "polyline": Polyline,
            "spline": Spline,
            "deflected_contour": DeflectedContour,
        },
    ),
]
"""A rigid surface as it is written; `kind` says which."""
