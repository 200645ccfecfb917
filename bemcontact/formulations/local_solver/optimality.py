"""Claims checked from the data: first-order conditions, rays, certificates; nothing is believed from the factors."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bemcontact.arrays import Array, BoolArray
from bemcontact.formulations.local_solver.dead_point import CriticalCone
from bemcontact.formulations.local_solver.progress import Progress
from bemcontact.formulations.local_solver.statement import EPS, Statement, largest

WEAK = 10.0
"""Multipliers below this many optimality tolerances are treated as zero in the critical cone."""


@dataclass(frozen=True, kw_only=True)
class FirstOrder:
    """First-order conditions at a point, in scaled units.

    Parameters
    ----------
    holds : bool
        Feasible, stationary, multipliers of the right sign and only on active constraints, all within tolerance.
    strong, weak : bool arrays (n + m,)
        Active constraints: equalities and those with a multiplier, and the others.
    sides : (n + m,) int8 array
        Which bound each active constraint is at (2: equality).
    size : (n + m,) array
        Absolute multipliers.
    """

    holds: bool
    strong: BoolArray
    weak: BoolArray
    sides: NDArray[np.int8]
    size: Array

    def cone(self, statement: Statement) -> CriticalCone:
        """The critical cone, its normals turned inwards."""
        n = statement.c.size
        free, weak = (~self.strong[:n]).nonzero()[0], self.weak.nonzero()[0]
        inwards = np.where(self.sides[weak] == 1, -1.0, 1.0)
        fixed, rows = weak[weak < n], weak[weak >= n] - n
        normals = np.zeros((weak.size, free.size))
        normals[np.arange(fixed.size), free.searchsorted(fixed)] = 1.0
        normals[fixed.size :] = statement.A[rows][:, free]
        return CriticalCone(free=free, equal=statement.A[self.strong[n:]][:, free], weak=inwards[:, None] * normals)

    def stricter(self, along: Array, blocking: int) -> "FirstOrder":
        """With a direction shut out on which the objective does not fall as far as it leads.

        Small multipliers that make it rise count; if none does, the constraint that blocks it at once is active too.
        """
        leaving = self.weak & (self.sides * along < 0.0) & (self.size > 0.0)
        sides, weak = self.sides.copy(), self.weak & ~leaving
        if not leaving.any():
            leaving[blocking], weak[blocking] = weak[blocking], not weak[blocking]
            sides[blocking] = -1 if along[blocking] < 0.0 else 1
        return replace(self, strong=self.strong | leaving, weak=weak, sides=sides)


def first_order(progress: Progress, multipliers: Array, zero: Array) -> FirstOrder:
    """Recompute the first-order conditions at the point from the data, each component against its own `zero` (n,)."""
    statement, x = progress.statement, progress.x
    n = x.size
    values = statement.values(x)
    slack = 2.0 * progress.slack
    feasible = np.count_nonzero(statement.violation(values) <= slack) == slack.size
    stationary = largest(progress.gradient - statement.transposed(multipliers)) <= 2.0 * progress.zero
    zeros = np.full(values.size, progress.zero)
    zeros[:n] = zero
    size = np.abs(multipliers)
    sides = statement.sides_reached(values, slack)
    held = sides != 0
    wrong = np.where(held, sides * multipliers, size)
    wrong[statement.equality] = 0.0
    held[n:] &= np.logical_or.reduce(statement.A, axis=1)  # a row of zeros holds nothing
    strong = held & (statement.equality | (size > WEAK * zeros))
    return FirstOrder(
        holds=feasible and stationary and np.count_nonzero(wrong <= 2.0 * zeros) == zeros.size,
        strong=strong,
        weak=held & ~strong,
        sides=sides,
        size=size,
    )


def cleaned_ray(progress: Progress, ray: Array) -> Array | None:
    """The ray, with rounding removed, if it is one: recession direction along which the objective falls without end."""
    statement, values = progress.statement, progress.values
    if (values < progress.lowest).any() or (values > progress.highest).any():
        return None
    d = np.where(np.abs(ray) > 1e-13 * np.abs(ray).max(initial=0.0), ray, 0.0)
    d = d / np.linalg.norm(d)
    along = statement.values(d)
    within = np.concatenate([np.zeros(d.size), 1e-10 * (statement.absolute[2] @ np.abs(d))])
    falls = np.isfinite(statement.lower) & (along < -within)
    rises = np.isfinite(statement.upper) & (along > within)
    if falls.any() or rises.any():
        return None
    curvature = float(d @ statement.H @ d)
    slope = float(progress.gradient @ d)
    zero = statement.rounding(d)
    no_rows = statement.A[:0]
    level = progress.level(d, progress.fine_zero(d[:0], no_rows, no_rows.T))
    return d if curvature < -zero or (curvature <= zero and slope < -level) else None


def separates(statement: Statement, certificate: Array) -> bool:
    """Whether [I; A]ᵀy = 0 while y lower (y > 0) and y upper (y < 0) sum to more than zero: no x is feasible."""
    y = certificate
    used = y != 0.0
    bounds = np.where(y > 0.0, statement.lower, statement.upper)[used]
    if not np.all(np.isfinite(bounds)):
        return False
    terms = y[used] * bounds
    cancels = np.abs(statement.transposed(y)) <= _noise(statement, y)
    return bool(np.all(cancels)) and float(terms.sum()) > 1e-10 * float(np.abs(terms).sum())


def _noise(statement: Statement, y: Array) -> Array:
    """What each component of [I; A]ᵀy could be by rounding: of its own terms, and of its column's entries (n,)."""
    n, A = statement.c.size, statement.absolute[2]
    size = np.abs(y)
    of_terms = 1e-11 * max(10, n) * (size[:n] + size[n:] @ A)
    return np.maximum(of_terms, 4.0 * EPS * A.max(axis=0, initial=0.0) * float(size[n:].sum()))


def certified(statement: Statement, certificate: Array) -> Array | None:
    """The certificate if it separates, its bound multipliers recomputed so that [I; A]ᵀy = 0 to the last digits."""
    n = statement.c.size
    y = np.where(np.abs(certificate) > 1e-11 * largest(certificate), certificate, 0.0)
    y[:n] = 0.0
    y[:n] = -statement.transposed(y)
    y[:n][np.abs(y[:n]) <= _noise(statement, np.concatenate([np.zeros(n), y[n:]]))] = 0.0
    return y if separates(statement, y) else None
