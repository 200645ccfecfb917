"""Edges with both ends, and their curves: length, points and directions by fraction of the arc length."""

from collections.abc import Sequence
from itertools import pairwise
from math import atan2, cos, degrees, fsum, hypot, log, pi, radians, sin
from typing import Protocol

import numpy as np

from bemcontact.arrays import Array
from bemcontact.cached import cached_property
from bemcontact.frozen import frozen_value
from bemcontact.problems.elliptic import second_kind

Pair = tuple[float, float]


class Curve(Protocol):
    """A plane curve parametrized by its arc length."""

    @property
    def length(self) -> float:
        """Arc length [L]."""
        ...

    def at(self, fractions: Array) -> Array:
        """Points (k, 2) at fractions (k,) of the arc length."""
        ...

    def tangent_angle(self, fractions: Array) -> Array:
        """Angle (k,) of the direction of travel to the x axis in radians, continuous along the curve."""
        ...

    def polyline(self) -> Array:
        """Points (k, 2) from start to end of a polyline that approximates the curve."""
        ...

    def fraction_at(self, point: Pair) -> float:
        """Fraction in [0, 1] of the arc length at a point on the curve or near it."""
        ...

    def nearest(self, points: Array) -> Array:
        """Fractions (k,) in [0, 1] of the arc length where the curve is nearest to points (k, 2)."""
        ...


@frozen_value
class Segment:
    """The straight line from start to end."""

    start: Pair
    end: Pair

    @property
    def length(self) -> float:
        """Arc length [L]."""
        return hypot(self.end[0] - self.start[0], self.end[1] - self.start[1])

    def at(self, fractions: Array) -> Array:
        """Points (k, 2) at fractions (k,) of the arc length."""
        (x, y), (x_end, y_end) = self.start, self.end
        points = np.empty((len(fractions), 2))
        points[:, 0] = x + fractions * (x_end - x)
        points[:, 1] = y + fractions * (y_end - y)
        return points

    def tangent_angle(self, fractions: Array) -> Array:
        """Angle (k,) of the direction of travel to the x axis in radians."""
        return np.full(len(fractions), atan2(self.end[1] - self.start[1], self.end[0] - self.start[0]))

    def polyline(self) -> Array:
        """Both ends (2, 2)."""
        return np.array([self.start, self.end])

    def fraction_at(self, point: Pair) -> float:
        """Fraction in [0, 1] of the arc length at the nearest point of the line."""
        if not self.length > 0:
            return 0.0
        along, off = np.subtract(self.end, self.start) / self.length, np.subtract(point, self.start)
        return min(max(float(along @ off) / self.length, 0.0), 1.0)

    def nearest(self, points: Array) -> Array:
        """Fractions (k,) in [0, 1] of the arc length where the line is nearest to points (k, 2)."""
        along = np.subtract(self.end, self.start) / self.length
        return np.clip((points - np.array(self.start)) @ along / self.length, 0.0, 1.0)


@frozen_value
class CircularArc:
    """center + r (cos θ, sin θ) with θ from start_angle over sweep, in radians, counterclockwise if sweep > 0.

    `radii` are r at both ends; they are equal up to the rounding of the given coordinates.
    """

    center: Pair
    radii: Pair
    start_angle: float
    sweep: float

    @property
    def length(self) -> float:
        """Arc length [L]."""
        return abs(self.sweep) * (self.radii[0] + self.radii[1]) / 2

    def at(self, fractions: Array) -> Array:
        """Points (k, 2) at fractions (k,) of the arc length."""
        theta = self.start_angle + fractions * self.sweep
        radius = self.radii[0] + fractions * (self.radii[1] - self.radii[0])
        points = np.empty((len(theta), 2))
        points[:, 0] = self.center[0] + radius * np.cos(theta)
        points[:, 1] = self.center[1] + radius * np.sin(theta)
        return points

    def tangent_angle(self, fractions: Array) -> Array:
        """Angle (k,) of the direction of travel to the x axis in radians, continuous along the arc."""
        return self.start_angle + fractions * self.sweep + np.copysign(pi / 2, self.sweep)

    def polyline(self) -> Array:
        """Points (k, 2) about one degree apart: the distance between chords and arc is 4e-5 of the radius."""
        return self.at(np.linspace(0, 1, _chords(self.sweep) + 1))

    def fraction_at(self, point: Pair) -> float:
        """Fraction in [0, 1] of the arc length at the point in the same direction from the center."""
        x, y = np.subtract(point, self.center)
        return _part_of_sweep(atan2(y, x), self.start_angle, self.sweep)

    def nearest(self, points: Array) -> Array:
        """Fractions (k,) in [0, 1] of the arc length where the arc is nearest to points (k, 2)."""
        x, y = (points - np.array(self.center)).T
        angle, sweep = np.arctan2(y, x), abs(self.sweep)
        turned = np.mod(angle - self.start_angle if self.sweep > 0 else self.start_angle - angle, 2 * pi)
        turned[turned > (sweep + 2 * pi) / 2] = 0.0
        return np.minimum(turned / sweep, 1.0)


@frozen_value
class EllipticArc:
    """center + rotation · (a cos t, b sin t), t from start_angle over sweep: eccentric angles in radians."""

    center: Pair
    semi_axes: Pair
    rotation: float
    start_angle: float
    sweep: float

    @property
    def radii(self) -> Pair:
        """Both semi-axes [L]."""
        return self.semi_axes

    @property
    def length(self) -> float:
        """Arc length [L], by the incomplete elliptic integral of the second kind."""
        first, last = self._at_ends
        return abs(last - first)

    def at(self, fractions: Array) -> Array:
        """Points (k, 2) at fractions (k,) of the arc length."""
        return self._at_eccentric_angle(self._eccentric_angle(fractions))

    def tangent_angle(self, fractions: Array) -> Array:
        """Angle (k,) of the direction of travel to the x axis in radians, continuous along the arc."""
        a, b = self.semi_axes
        t = self._eccentric_angle(fractions)
        # The polar angle of the normal (b cos t, a sin t) differs from t by less than a quarter turn.
        difference = np.arctan2((a - b) * np.sin(t) * np.cos(t), b * np.cos(t) ** 2 + a * np.sin(t) ** 2)
        return t + difference + self.rotation + np.copysign(pi / 2, self.sweep)

    def polyline(self) -> Array:
        """Points (k, 2) about one degree of eccentric angle apart."""
        return self._at_eccentric_angle(self.start_angle + np.linspace(0, 1, _chords(self.sweep) + 1) * self.sweep)

    def fraction_at(self, point: Pair) -> float:
        """Fraction in [0, 1] of the arc length at the point with the same eccentric angle."""
        (a, b), (x, y) = self.semi_axes, np.subtract(point, self.center)
        c, s = cos(self.rotation), sin(self.rotation)
        part = _part_of_sweep(atan2((c * y - s * x) / b, (c * x + s * y) / a), self.start_angle, self.sweep)
        first, here, last = self._arc_length(self.start_angle + np.array([0.0, part, 1.0]) * self.sweep)
        return float(here - first) / float(last - first) if last != first else 0.0

    def nearest(self, points: Array) -> Array:
        """Fractions (k,) in [0, 1] of the arc length where the arc is nearest to points (k, 2)."""
        (a, b), c, s = self.semi_axes, cos(self.rotation), sin(self.rotation)
        x, y = np.array([[c, s], [-s, c]]) @ (points - np.array(self.center)).T
        angles = self.start_angle + np.linspace(0, 1, _chords(self.sweep) + 1) * self.sweep
        away = np.hypot(x[:, None] - a * np.cos(angles), y[:, None] - b * np.sin(angles))
        step, ends = abs(self.sweep) / (len(angles) - 1), np.sort(self.start_angle + np.array([0.0, self.sweep]))
        t = angles[away.argmin(axis=1)]
        low, high = np.maximum(t - step, ends[0]), np.minimum(t + step, ends[1])
        for _ in range(60):
            slope = (a * np.cos(t) - x) * -a * np.sin(t) + (b * np.sin(t) - y) * b * np.cos(t)
            low, high = np.where(slope <= 0, t, low), np.where(slope >= 0, t, high)
            bend = a * a * np.sin(t) ** 2 + b * b * np.cos(t) ** 2
            bend -= (a * np.cos(t) - x) * a * np.cos(t) + (b * np.sin(t) - y) * b * np.sin(t)
            moved = t - slope / np.where(bend > 0, bend, np.inf)
            moved = np.where((moved >= low) & (moved <= high) & (bend > 0), moved, (low + high) / 2)
            done, t = np.all(np.abs(moved - t) <= 1e-15 * max(abs(ends[0]), abs(ends[1]), 1.0)), moved
            if done:
                break
        first, last = self._at_ends
        return np.clip((self._arc_length(t) - first) / (last - first), 0.0, 1.0)

    def _at_eccentric_angle(self, t: Array) -> Array:
        """Points (k, 2) at eccentric angles t (k,)."""
        a, b = self.semi_axes
        x, y = a * np.cos(t), b * np.sin(t)
        c, s = cos(self.rotation), sin(self.rotation)
        return np.array(self.center) + np.column_stack([c * x - s * y, s * x + c * y])

    def _arc_length(self, t: Array) -> Array:
        """Arc length from a fixed point to eccentric angle t."""
        a, b = self.semi_axes
        return a * second_kind(t - pi / 2, b / a) if a > b else b * second_kind(t, a / b)

    @cached_property
    def _at_ends(self) -> Pair:
        """Arc length from a fixed point to both ends."""
        first, last = self._arc_length(self.start_angle + np.array([0.0, self.sweep])).tolist()
        return first, last

    @cached_property
    def _table(self) -> tuple[Array, Array]:
        """Arc length, ascending, at eccentric angles about one degree apart."""
        t = np.sort(self.start_angle + np.linspace(0, 1, _chords(self.sweep) + 1) * self.sweep)
        return self._arc_length(t), t

    def _near(self, wanted: Array) -> Array:
        """Eccentric angles (k,) near those with arc lengths (k,), by cubic interpolation in a table."""
        length, t = self._table
        i = np.clip(np.searchsorted(length, wanted, side="right") - 1, 0, len(t) - 2)
        step = length[i + 1] - length[i]
        x = np.clip((wanted - length[i]) / step, 0.0, 1.0)
        before, after = (step / self._speed(t[j]) for j in (i, i + 1))
        rise = t[i + 1] - t[i]
        t_near = t[i] + x * (before + x * (3 * rise - 2 * before - after + x * (before + after - 2 * rise)))
        return np.clip(t_near, t[i], t[i + 1])

    def _speed(self, t: Array) -> Array:
        return np.hypot(self.semi_axes[0] * np.sin(t), self.semi_axes[1] * np.cos(t))

    def _eccentric_angle(self, fractions: Array) -> Array:
        """Invert the arc length by Newton's method, with bisection if a step leaves the bracket."""
        ends = self.start_angle + np.array([0.0, self.sweep])
        low, high = np.full(len(fractions), ends.min()), np.full(len(fractions), ends.max())
        first, last = self._at_ends
        wanted = first + fractions * (last - first)
        round_off = 4 * np.finfo(float).eps * max(abs(first), abs(last))
        t = self._near(wanted)
        for _ in range(60):
            excess = self._arc_length(t) - wanted
            if np.all(np.abs(excess) <= round_off):
                break
            low, high = np.where(excess < 0, t, low), np.where(excess > 0, t, high)
            step = t - excess / self._speed(t)
            t = np.where((step >= low) & (step <= high), step, (low + high) / 2)
        return t


@frozen_value
class Edge:
    """A named edge of the boundary with both ends, and its division into elements.

    Parameters
    ----------
    name : name of the edge
    curve : shape of the edge
    start, end : ends [L]; exactly equal to those of the neighboring edges
    elements : number of elements, None if the mesh is still to be found
    ratio : ratio of the longest element to the shortest, in geometric progression
    towards : place of the short elements: "start", "end", "both", "middle", or a fraction of the arc length
    ends_at : fractions of the arc length at which elements end besides 0 and 1, ascending
    """

    name: str
    curve: Curve
    start: Pair
    end: Pair
    elements: int | None
    ratio: float = 1.0
    towards: str | float = "start"
    ends_at: tuple[float, ...] = ()

    @property
    def length(self) -> float:
        """Arc length [L]."""
        return self.curve.length

    def points(self, fractions: Array) -> Array:
        """Points (k, 2) [L] at fractions (k,) in [0, 1] of the arc length; exactly the ends at 0 and 1."""
        fractions = np.asarray(fractions, float)
        points = self.curve.at(fractions)
        points[fractions == 0] = self.start
        points[fractions == 1] = self.end
        return points

    def directions(self, fractions: Array) -> Array:
        """Unit tangents (k, 2) at fractions (k,) of the arc length; the body is on their left."""
        angle = self.curve.tangent_angle(np.asarray(fractions, float))
        directions = np.empty((len(angle), 2))
        np.cos(angle, out=directions[:, 0])
        np.sin(angle, out=directions[:, 1])
        return directions

    def normals(self, fractions: Array) -> Array:
        """Outward unit normals (k, 2) at fractions (k,) of the arc length."""
        return right_of(self.directions(fractions))

    @cached_property
    def _coarse_breakpoints(self) -> Array:
        assert self.elements is not None, f"no mesh was found for edge '{self.name}' yet"
        ends = graded_ends(self.elements, self.ratio, self.towards, self.ends_at)
        ends.setflags(write=False)
        return ends

    def breakpoints(self, refine: int = 1) -> Array:
        """Fractions (elements · refine + 1,) of the element ends, with each element cut into `refine` equal parts."""
        coarse = self._coarse_breakpoints
        if refine == 1:
            return coarse
        parts = np.arange(refine) / refine
        fine = coarse[:-1, None] + np.diff(coarse)[:, None] * parts
        return np.append(fine.ravel(), 1.0)

    def turning(self, refine: int = 1) -> float:
        """Largest angle in radians by which one element turns."""
        return float(np.abs(np.diff(self.curve.tangent_angle(self.breakpoints(refine)))).max())

    def polyline(self) -> Array:
        """Points (k, 2) from start to end of a polyline that approximates the edge."""
        points = self.curve.polyline()
        points[0], points[-1] = self.start, self.end
        return points


def _part_of_sweep(angle: float, start: float, sweep: float) -> float:
    """Part in [0, 1] of a sweep at an angle in radians; for angles outside the sweep, its nearer end."""
    turned = (angle - start if sweep > 0 else start - angle) % (2 * pi)
    if turned > (abs(sweep) + 2 * pi) / 2:
        turned = 0.0
    return min(turned / abs(sweep), 1.0)


def _chords(sweep: float) -> int:
    """Number of chords of at most one degree for a sweep in radians."""
    return int(degrees(abs(sweep))) + 1


def right_of(directions: Array) -> Array:
    """Vectors (k, 2) a quarter turn clockwise from directions (k, 2)."""
    normals = directions[:, ::-1].copy()
    normals[:, 1] *= -1
    return normals


def cross(one: Array, other: Array) -> Array:
    """Component z of the cross product of vectors (..., 2)."""
    return one[..., 0] * other[..., 1] - one[..., 1] * other[..., 0]


def inner(one: Array, other: Array) -> Array:
    """Inner product of vectors (..., 2)."""
    return one[..., 0] * other[..., 0] + one[..., 1] * other[..., 1]


def unit_vector(angle: float) -> Pair:
    """(cos, sin) of an angle in degrees, exact at multiples of 90 degrees."""
    quarter, rest = divmod(angle, 90.0)
    if rest == 0:
        return [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)][int(quarter) % 4]
    return cos(radians(angle)), sin(radians(angle))


def graded_ends(elements: int, ratio: float, towards: str | float, places: Sequence[float] = ()) -> Array:
    """Element ends (elements + 1,) from 0 to 1 with lengths from `graded_lengths`, some of them at given places.

    The nearest free end moves to each place, and the others move in proportion. Places ascend, are inside (0, 1), and
    are fewer than the elements. A place `towards` which elements are graded is one of the ends.
    """
    fixed = [*places] if isinstance(towards, str) else sorted({*places, towards})
    if len(fixed) == elements - 1:
        return np.array([0.0, *fixed, 1.0])
    ends = np.concatenate([[0.0], np.cumsum(graded_lengths(elements, ratio, towards))])
    ends[-1] = 1.0
    return moved_onto(ends, fixed)


def graded_lengths(elements: int, ratio: float, towards: str | float) -> Array:
    """Lengths (elements,) with sum 1 in geometric progression, longest : shortest = ratio.

    Parameters
    ----------
    elements : number of elements, at least 1; at least 2 for a place
    ratio : ratio of the longest length to the shortest. On both sides of a place, lengths grow by the same factor; the
        side with more elements has this ratio
    towards : place of the short elements: "start", "end", "both", "middle", or a fraction inside (0, 1)
    """
    if not isinstance(towards, str):
        return _lengths_about(elements, ratio, towards)
    step = np.arange(elements)
    if towards == "end":
        step = step[::-1]
    if towards in ("both", "middle"):
        step = np.minimum(step, step[::-1])
    if towards == "middle":
        step = step.max() - step
    lengths = ratio ** (step / max(step.max(), 1))
    return lengths / fsum(lengths)


def _lengths_about(elements: int, ratio: float, place: float) -> Array:
    """Lengths (elements,) that shrink towards a place; the two elements at the place have about the same length."""

    def sides(before: int) -> tuple[Array, Array]:
        growth = ratio ** (1 / max(before - 1, elements - before - 1, 1))
        left, right = growth ** np.arange(before)[::-1], growth ** np.arange(elements - before)
        return left * (place / fsum(left)), right * ((1 - place) / fsum(right))

    def mismatch(before: int) -> float:
        left, right = sides(before)
        return abs(log(left[-1] / right[0]))

    return np.concatenate(sides(min(range(1, elements), key=mismatch)))


def moved_onto(ends: Array, places: Sequence[float]) -> Array:
    """Move ascending element ends (m + 1,) so that some are exactly at given places, and the others in proportion.

    The first and the last end stay. Places ascend, are between them, and are fewer than m.
    """
    if not places:
        return ends
    last = len(ends) - 1
    chosen = [0, *(_nearest(ends, places) if len(places) < last - 1 else range(1, last)), last]
    onto = [ends[0], *places, ends[-1]]
    moved = [
        low + (ends[i:j] - ends[i]) * ((high - low) / (ends[j] - ends[i]))
        for (i, j), (low, high) in zip(pairwise(chosen), pairwise(onto), strict=True)
    ]
    return np.append(np.concatenate(moved), ends[-1])


def _nearest(ends: Array, places: Sequence[float]) -> list[int]:
    """Index of a different end for each place, in order, with the smallest sum of squared distances."""
    inner = np.arange(1, len(ends) - 1)
    total, before = np.zeros(len(inner)), []
    for number, place in enumerate(places):
        if number:  # the best end for the previous place among the earlier ends
            least = np.minimum.accumulate(total)
            cheapest = np.maximum.accumulate(np.where(total == least, inner, 0))
            before.append(np.append(0, cheapest[:-1]))
            total = np.append(np.inf, least[:-1])
        total = total + (ends[inner] - place) ** 2
    chosen = [int(inner[np.argmin(total)])]
    for earlier in reversed(before):
        chosen.append(int(earlier[chosen[-1] - 1]))
    return chosen[::-1]
