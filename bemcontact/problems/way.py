"""The rigid motion of a surface beside a body, after which contact finds its faces."""

from typing import NamedTuple

import numpy as np

from bemcontact.arrays import Array
from bemcontact.problems.validation import Point


class Way(NamedTuple):
    """A surface is turned about a point, and then displaced.

    Parameters
    ----------
    x, y : displacement of the point [L]
    turn : [rad]
    about : the point as drawn [L]
    """

    x: float = 0.0
    y: float = 0.0
    turn: float = 0.0
    about: Point = (0.0, 0.0)

    @property
    def step(self) -> Array:
        """Displacement (2,) of the point [L]."""
        return np.array([self.x, self.y])

    def back(self, points: Array) -> Array:
        """Places (..., 2) as drawn that come to points (..., 2) [L]."""
        if self == AS_DRAWN:
            return points
        drawn = points - self.step
        return drawn if self.turn == 0 else self.turned(drawn - self.about, -1.0) + self.about

    def forth(self, points: Array) -> Array:
        """Where places (..., 2) as drawn come to [L]."""
        there = points if self.turn == 0 else self.turned(points - self.about) + self.about
        return there + self.step

    def turned(self, vectors: Array, sense: float = 1.0) -> Array:
        """Vectors (..., 2) after the turn, or before it with a `sense` of -1."""
        if self.turn == 0:
            return vectors
        cosine, sine = np.cos(self.turn), sense * np.sin(self.turn)
        return vectors @ np.array([[cosine, sine], [-sine, cosine]])

    def motion_of(self, points: Array) -> Array:
        """Displacement (..., 2) [L] of places (..., 2) as drawn, linear in the turn."""
        lever = points - self.about
        return self.step + self.turn * np.stack([-lever[..., 1], lever[..., 0]], axis=-1)

    def motion_at(self, points: Array) -> Array:
        """Displacement (..., 2) [L] by which points (..., 2) are come to, linear in the turn."""
        return self.motion_of(points - self.step)


AS_DRAWN = Way()
"""No motion."""
