"""Smooth curves through points, parametrized by their arc length."""

import numpy as np
import scipy

from bemcontact.arrays import Array, magnitudes
from bemcontact.cached import cached_property
from bemcontact.frozen import frozen_value
from bemcontact.problems.curves import Pair

ORDER = 16
"""Gauss points for the arc length between two points of the curve."""
SAMPLES = 16
"""Pieces of a polyline between two points."""


@frozen_value
class SplineCurve:
    """A curve whose coordinates are cubic splines of the length along the chords.

    Parameters
    ----------
    points : through which it runs [L]; a curve that ends where it begins is closed, and smooth there
    start_direction, end_direction : of travel at the ends, of any length; without one the curvature is zero there
    """

    points: tuple[Pair, ...]
    start_direction: Pair | None = None
    end_direction: Pair | None = None

    @property
    def closed(self) -> bool:
        """Whether it ends where it begins, with no direction of its own there."""
        return self.points[0] == self.points[-1] and self.start_direction is None and self.end_direction is None

    @cached_property
    def _spline(self) -> "scipy.interpolate.CubicSpline":
        """Points (k, 2) by the length along the chords."""
        points = np.array(self.points)
        ends = [
            (2, np.zeros(2)) if direction is None else (1, np.array(direction) / np.hypot(*direction))
            for direction in (self.start_direction, self.end_direction)
        ]
        along = np.append(0.0, np.hypot(*np.diff(points, axis=0).T).cumsum())
        return scipy.interpolate.CubicSpline(along, points, bc_type="periodic" if self.closed else tuple(ends))

    @cached_property
    def _lengths(self) -> Array:
        """Arc length at each of the points."""
        knots = self._spline.x
        return np.append(0.0, self._between(knots[:-1], knots[1:]).cumsum())

    def _between(self, low: Array, high: Array) -> Array:
        """Arc length between two parameters in one piece of the spline."""
        x, weights = np.polynomial.legendre.leggauss(ORDER)
        half = (high - low) / 2
        velocity = self._spline((low + high)[..., None] / 2 + half[..., None] * x, 1)
        return half * (np.hypot(velocity[..., 0], velocity[..., 1]) @ weights)

    def _arc_length(self, parameter: Array) -> Array:
        """Arc length from the start to parameters (k,)."""
        knots = self._spline.x
        piece = np.clip(np.searchsorted(knots, parameter, side="right") - 1, 0, len(knots) - 2)
        return self._lengths[piece] + self._between(knots[piece], parameter)

    def _parameter(self, fractions: Array) -> Array:
        """Parameters (k,) at fractions of the arc length, by Newton's method in brackets."""
        knots, wanted = self._spline.x, np.asarray(fractions, float) * self.length
        piece = np.clip(np.searchsorted(self._lengths, wanted, side="right") - 1, 0, len(knots) - 2)
        low, high = knots[piece], knots[piece + 1]
        t = low + (high - low) * (wanted - self._lengths[piece]) / np.diff(self._lengths)[piece]
        for _ in range(60):
            excess = self._arc_length(t) - wanted
            if np.all(abs(excess) <= 4 * np.finfo(float).eps * self.length):
                break
            low, high = np.where(excess < 0, t, low), np.where(excess > 0, t, high)
            step = t - excess / np.hypot(*self._spline(t, 1).T)
            t = np.where((step >= low) & (step <= high), step, (low + high) / 2)
        return t

    @property
    def length(self) -> float:
        """Arc length [L]."""
        return float(self._lengths[-1])

    def at(self, fractions: Array) -> Array:
        """Points (k, 2) at fractions (k,) of the arc length."""
        return self._spline(self._parameter(fractions))

    @cached_property
    def _turned(self) -> tuple[Array, Array]:
        """Parameters, and the angle of the direction of travel there, continuous along the curve."""
        knots = self._spline.x
        t = np.append(np.linspace(knots[:-1], knots[1:], SAMPLES, endpoint=False).T.ravel(), knots[-1])
        velocity = self._spline(t, 1)
        return t, np.unwrap(np.arctan2(velocity[:, 1], velocity[:, 0]))

    def tangent_angle(self, fractions: Array) -> Array:
        """Angle (k,) of the direction of travel to the x axis in radians, continuous along the curve."""
        t, (known, angles) = self._parameter(fractions), self._turned
        velocity = self._spline(t, 1)
        angle, near = np.arctan2(velocity[:, 1], velocity[:, 0]), np.interp(t, known, angles)
        return angle + 2 * np.pi * np.round((near - angle) / (2 * np.pi))

    def polyline(self) -> Array:
        """Points (k, 2) from start to end of a polyline that approximates the curve."""
        return self._spline(self._turned[0])

    def fraction_at(self, point: Pair) -> float:
        """Fraction in [0, 1] of the arc length at the nearest point of the curve."""
        return float(self.nearest(np.array([point]))[0])

    def nearest(self, points: Array) -> Array:
        """Fractions (k,) in [0, 1] of the arc length where the curve is nearest to points (k, 2)."""
        t, _ = self._turned
        first = magnitudes(points[:, None] - self._spline(t)).argmin(axis=1)
        low, high, found = t[np.maximum(first - 1, 0)], t[np.minimum(first + 1, len(t) - 1)], t[first]
        for _ in range(60):
            offset, velocity, bend = self._spline(found) - points, self._spline(found, 1), self._spline(found, 2)
            slope = np.sum(offset * velocity, axis=1)
            low, high = np.where(slope <= 0, found, low), np.where(slope >= 0, found, high)
            curve = np.sum(velocity**2, axis=1) + np.sum(offset * bend, axis=1)
            step = found - slope / np.where(curve > 0, curve, np.inf)
            step = np.where((step >= low) & (step <= high) & (curve > 0), step, (low + high) / 2)
            done, found = np.all(abs(step - found) <= 1e-15 * t[-1]), step
            if done:
                break
        return np.clip(self._arc_length(found) / self.length, 0.0, 1.0)
