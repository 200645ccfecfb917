"""Stress in a model: affine expressions of cvxpy, and the convex measures of them that bounds are put on.

Von Mises's stress is √3 times the length of a vector that is linear in the components,

    σv² = 3 (½ (σxx - σyy))² + 3 σxy² + (½ (σxx + σyy) - σzz)²,

and so is the largest shear stress in the plane. `expression <= limit` is a second-order cone for each point.
"""

import cvxpy as cp
import numpy as np

from bemcontact.arrays import Array
from bemcontact.checks.attributes import WithHints
from bemcontact.contact.stress_operator import StressOperator
from bemcontact.frozen import frozen

DEVIATOR = np.array([[np.sqrt(0.75), -np.sqrt(0.75), 0, 0], [0, 0, np.sqrt(3.0), 0], [0.5, 0.5, 0, -1]])
"""(3, 4) D: von Mises's stress is |D σ| with σ = (σxx, σyy, σxy, σzz)."""
MEAN = np.array([0.5, 0.5, 0, 0])
RADIUS = np.array([[0.5, -0.5, 0, 0], [0, 0, 1, 0]])
"""(2, 4): |RADIUS σ| is the largest shear stress in the plane."""


@frozen
class ModelStress(WithHints):
    """Stress at k points as expressions of cvxpy, in the user's unit; tension is positive.

    Factors of load cases enter as the parameters of the model. Bound `von_mises`, `in_plane_shear` and `max_shear` from
    above only: they are convex. The components are affine and may have any bound.
    """

    points: Array
    """Points (k, 2) [L] of the undeformed body."""
    scaled: tuple[cp.Expression, ...]
    """σxx, σyy, σxy, σzz, (k,) each, over `scale`."""
    scale: float
    """Pressure [p] that scaled expressions are measured in."""

    @classmethod
    def of(
        cls,
        operator: StressOperator,
        pressure: cp.Expression,
        motions: cp.Expression | None,
        factors: cp.Expression | None,
        scale: float,
    ) -> "ModelStress":
        """The stress of p (n,) [p], a (k,) and factors (c,), expressions in the user's units."""

        def component(i: int) -> cp.Expression:
            loads = operator.loads[:, i] / scale
            value = operator.pressure[:, i] @ (pressure / scale) + loads[:, 0]
            if factors is not None:
                value = value + loads[:, 1:] @ factors
            return value if motions is None else value + (operator.amplitudes[:, i] / scale) @ motions

        return cls(points=operator.points, scaled=tuple(component(i) for i in range(4)), scale=scale)

    def __repr__(self) -> str:
        """One line: number of points."""
        return f"<ModelStress at {len(self.points)} points>"

    @property
    def components(self) -> cp.Expression:
        """σxx, σyy, σxy (k, 3) [p], affine."""
        return self.scale * cp.vstack(self.scaled[:3]).T

    @property
    def zz(self) -> cp.Expression:
        """σzz (k,) [p], affine."""
        return self.scale * self.scaled[3]

    @property
    def von_mises(self) -> cp.Expression:
        """Von Mises's equivalent stress (k,) [p], convex."""
        return self.scale * self.scaled_mises

    @property
    def scaled_mises(self) -> cp.Expression:
        """Von Mises's equivalent stress (k,) over `scale`, convex."""
        return cp.norm(DEVIATOR @ cp.vstack(self.scaled), axis=0)

    @property
    def in_plane_shear(self) -> cp.Expression:
        """Largest shear stress (k,) [p] in the plane, convex."""
        return self.scale * self._radius

    @property
    def max_shear(self) -> cp.Expression:
        """Largest shear stress (k,) [p] in any direction, convex: the largest of three half differences.

        With the mean m and the radius r of the stress in the plane these are r, (m + r - σzz)/2 and (σzz - m + r)/2.
        """
        beside = (MEAN - [0, 0, 0, 1]) @ cp.vstack(self.scaled)
        return self.scale * cp.maximum(self._radius, (self._radius + cp.abs(beside)) / 2)

    @property
    def _radius(self) -> cp.Expression:
        return cp.norm(RADIUS @ cp.vstack(self.scaled), axis=0)
