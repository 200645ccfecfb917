"""The working set, and the constraint that leaves it (pricing).

The shortest right inverse of its rows is updated when it changes by one constraint. Bounds of the working set fix their
variables; only rows need algebra. With W the rows on the variables that are free,

    W N = I,   N = Wᵀ(WWᵀ)⁻¹:

Nᵀg are the multipliers of the rows in the least-squares sense, and g - Wᵀ Nᵀg holds the multipliers of the fixed
variables and the reduced gradient of the free ones. When a constraint enters or leaves, N changes by a matrix of rank
one (Greville, SIAM Review 2 (1960) 15-22).
"""

from math import sqrt

import numpy as np
import scipy
from numpy.typing import NDArray

from bemcontact.arrays import Array, BoolArray, fine_remainders
from bemcontact.formulations.local_solver.factorizations import (
    dot,
    independent_rows,
    orthogonal,
    over_triangle,
    unit_rows,
)
from bemcontact.formulations.local_solver.progress import FINE, SearchState
from bemcontact.formulations.local_solver.right_inverse import RightInverse
from bemcontact.formulations.local_solver.statement import EPS, Sides, Statement

EQUALITY = 2
TEMPORARY, FLAT = -1, -2
"""Numbers of rows that are no constraints and only fix a direction; FLAT if its slope and curvature are zero."""

DEPENDENT = 1e-9
"""A normal counts as dependent if its relative distance from the span of the others is smaller."""

ALIKE = 1e-12
"""Limit, in place of `DEPENDENT`, for a constraint that enters after it blocked a step, if N has all its digits."""

FEW_DIGITS = 1e-12
"""Relative rounding of a component of a point on rows beyond which remainders are computed with twice the digits."""

FEW, MOST = 400, 0.75
"""Number of constraints up to which products with all rows are as fast as with some, and the part of the rows that is
held up to which they are: some rows are copied for the product."""

EXACT, BLUNT = 1e-15, 1e-10
"""Product of a unit direction with the rows that it does not change: up to the first it needs no correction, and from
the second N has lost digits."""

SHARP, BLURRED, WORN = 1e-12, 1e-8, 1e-6
"""Relative size of a refinement above which refinements are needed, above which two are, and above which N is computed
again: each refinement multiplies the error by this size."""


class WorkingSet:
    """The constraints that are held, changed in place by `add` and `drop`.

    It starts from the wanted `sides` (n + m,): 0 free, -1 lower, +1 upper, 2 equality. Dependent rows are left out;
    those marked in `first` (n + m,) are kept before others. Without `complete` there is no `null_space`.

    Attributes
    ----------
    sides, held : (n + m,) sides that are held, and whether each is
    free : (n,) 1 for a variable that is not fixed by a bound, else 0
    number : how many constraints are held, temporary ones included
    W, inverse : (r, n) normals of the rows held, on all variables, and their right inverse N
    null_space : (n, k) orthonormal directions that change nothing held at the start; later changes leave them alone
    ids : (r,) constraint of each row of W; `TEMPORARY` or `FLAT` for one that is none
    signs : (n + r,) -1 for a variable or row at its lower bound, +1 at its upper, 0 for any other
    temporary : how many rows of W are no constraints
    sharp : whether N still has all its digits
    """

    def __init__(
        self, statement: Statement, sides: Sides, first: BoolArray | None = None, *, complete: bool = True
    ) -> None:
        n, A = statement.c.size, statement.A
        self.statement = statement
        self.sides = sides.copy()
        self.held = sides != 0
        self.free = (~self.held[:n]).astype(float)
        self._W = np.zeros((n, n))
        self._ids, self._signs = np.zeros(n, dtype=np.intp), np.zeros(2 * n)
        free, rows = self.free.nonzero()[0], sides[n:].nonzero()[0]
        kept, columns, self.null_space = rows[:0], np.zeros((free.size, 0)), np.zeros((n, free.size))
        self.null_space[free, np.arange(free.size)] = 1.0
        if rows.size and free.size:
            normals, length = unit_rows(A[rows][:, free])
            Y, null_space, T, independent = orthogonal(normals, DEPENDENT, complete=complete)
            if first is not None and independent.size < rows.size:
                chosen = independent_rows(normals, first[n + rows], DEPENDENT)
                Y, null_space, T, independent = orthogonal(normals[chosen], 0.0, complete=complete)
                independent = chosen[independent]
            kept, self.null_space = rows[independent], np.zeros((n, null_space.shape[1]))
            self.null_space[free] = null_space
            columns = over_triangle(Y, T, transposed=True) / length[independent]
        if kept.size < rows.size:
            self.sides[n + rows], self.held[n + rows] = 0, False
            self.sides[n + kept], self.held[n + kept] = sides[n + kept], True
        r = kept.size
        self.number = n - free.size + r
        self.temporary, self.sharp = 0, True
        self.inverse = RightInverse(n, free, columns)
        signs = self.sides * (self.sides != EQUALITY)
        self._signs[:n] = signs[:n]
        if r:
            self._ids[:r], self._W[:r], self._signs[n : n + r] = n + kept, A[kept], signs[n + kept]
        self._resize(r)

    def _resize(self, rows: int) -> None:
        """Set the views on the leading rows of W."""
        self.size, self.W, self.ids = rows, self._W[:rows], self._ids[:rows]
        self.signs = self._signs[: self.free.size + rows]

    @property
    def N(self) -> Array:
        """Right inverse of W (n, r), zero in the rows of fixed variables."""
        return self.inverse.whole

    def values(self, direction: Array) -> Array:
        """[d; A d] of a direction that changes nothing held."""
        A = self.statement.A
        m, n = A.shape
        if self.size - self.temporary < MOST * m or n + m <= FEW:
            return self.statement.values(direction)
        values = np.zeros(n + m)
        values[:n] = direction
        others = np.flatnonzero(~self.held[n:])
        values[n + others] = A[others].dot(direction)
        return values

    @property
    def numbers(self) -> NDArray[np.intp]:
        """The constraint of each place (n + r,): the variables, then `ids`."""
        return np.concatenate([np.arange(self.free.size), self.ids])

    def multipliers(self, gradient: Array, *, refined: bool = False) -> Array:
        """Multipliers (n + r,) of the fixed variables, with the reduced gradient of the free ones, then of the rows.

        They are refined with the data if N has lost digits, or if that is asked for.
        """
        if self.size == 0:
            return gradient
        n, of_rows = gradient.size, self.inverse.against(gradient)
        multipliers = np.empty(n + self.size)
        rest = multipliers[:n]
        np.subtract(gradient, of_rows.dot(self.W), rest)
        if refined or not self.sharp:
            of_rows = self._refine(of_rows, gradient, rest)
        multipliers[n:] = of_rows
        return multipliers

    def refined(self, multipliers: Array) -> Array:
        """Multipliers (n + r,) after one more refinement; the change shows the rounding that they had."""
        n = self.free.size
        if self.size == 0:
            return multipliers
        correction = self.inverse.against(multipliers[:n])
        return multipliers + np.concatenate([-correction.dot(self.W), correction])

    def reduced(self, gradient: Array) -> Array:
        """The gradient (n,) without its part along the normals held, which rounding of a null space would let pass."""
        return self.multipliers(gradient)[: gradient.size] * self.free

    def of_all(self, multipliers: Array) -> Array:
        """Multipliers of all constraints (n + m,) from those of the working set (n + r,)."""
        n, of_rows = self.free.size, multipliers[self.free.size :]
        of_all = np.zeros(self.held.size)
        of_all[:n] = multipliers[:n] * self.held[:n]
        real = self.ids >= 0 if self.temporary else slice(None)
        of_all[self.ids[real]] = of_rows[real]
        return of_all

    def components(self, vector: Array) -> Array:
        """Products (n + m,) of a vector with the directions that move one constraint by one and no other held."""
        n, of_rows = self.free.size, self.inverse.against(vector)
        components = np.zeros(self.held.size)
        components[:n] = (vector - of_rows.dot(self.W)) * self.held[:n]
        components[self.ids] = of_rows
        return components

    def _refine(self, of_rows: Array, gradient: Array, rest: Array) -> Array:
        """Multipliers of the rows after a refinement, from a new N if the correction is too large.

        The `rest` of the gradient without its part along the rows is changed too.
        """
        correction = self.inverse.against(rest)
        size, whole = dot(correction, correction), dot(of_rows, of_rows)
        if size > WORN**2 * whole:
            self._renew()
            of_rows = self.inverse.against(gradient)
            np.subtract(gradient, of_rows.dot(self.W), rest)
            correction = self.inverse.against(rest)
        elif size > BLURRED**2 * whole:
            rest -= correction.dot(self.W)
            of_rows = of_rows + correction
            correction = self.inverse.against(rest)
        rest -= correction.dot(self.W)
        return of_rows + correction

    def _renew(self) -> None:
        """Compute N again from the rows, without accumulated rounding: O(n³)."""
        free = np.flatnonzero(self.free)
        Y, _, T, order = orthogonal(self.W[:, free], 0.0, complete=False)
        if order.size == self.size:
            self.inverse.renew(free, order, over_triangle(Y, T, transposed=True))
            self.sharp = True

    def add(self, constraint: int, side: int) -> Array | None:
        """Add a constraint; return its normal, or None if that is in the span of the others: O(n²)."""
        normal = self.statement.normal(constraint)
        sign = side if side != EQUALITY else 0
        if constraint >= normal.size:
            inverse = self._hold(normal)
            if inverse is None:
                return None
            self._append(normal, constraint, sign, inverse)
        else:
            if self.size and self._hold(normal, constraint) is None:
                return None
            self.inverse.fix(constraint)
            self._signs[constraint], self.free[constraint] = sign, 0.0
        self.sides[constraint], self.held[constraint] = side, True
        self.number += 1
        return normal

    def spans(self, constraint: int) -> bool:
        """Whether the normal of a constraint is a combination of those that are held."""
        normal = self.statement.normal(constraint) * self.free
        outside = normal
        for _ in range(2):
            outside = (outside - self.inverse.against(outside).dot(self.W)) * self.free
        return self._is_rounding(dot(outside, outside))

    def _is_rounding(self, outside: float) -> bool:
        """Whether the squared length of a normal outside the span is none."""
        if outside > DEPENDENT**2:
            return False
        return outside <= max(ALIKE, 10.0 * EPS * self.inverse.largest) ** 2

    def fix(self, direction: Array, kind: int) -> None:
        """Add a temporary row, with a direction of the null space as its normal."""
        inverse = self._hold(direction)
        if inverse is not None:
            self._append(direction, kind, 0, inverse)
            self.number += 1
            self.temporary += 1

    def _hold(self, normal: Array, variable: int | None = None) -> Array | None:
        """Remove from N its part along the normal; return the new column, or None if the normal is dependent.

        The normal may be that of a variable.
        """
        if self.number == normal.size - 1 and (only := self.inverse.exchanged(normal, variable)) is not None:
            component, direction = only
            if self._is_rounding(component * component):
                return None
            inverse = direction / component
            self.inverse.exchange(normal, variable, inverse)
            return inverse
        along = self.inverse.against(normal) if variable is None else self.inverse.row(variable)
        outside = (normal - along.dot(self.W)) * self.free
        again, size = self.inverse.against(outside), dot(outside, normal)
        if self.size and dot(again, again) > SHARP**2 * size:
            self.sharp = False
            outside -= again.dot(self.W) * self.free
            size = dot(outside, normal)
        if self._is_rounding(size):
            return None
        inverse = outside / size
        self.inverse.subtract(inverse, along)
        return inverse

    def _append(self, normal: Array, constraint: int, sign: int, inverse: Array) -> None:
        """Append a row of W and a column of N."""
        r, n = self.size, self.free.size
        self.inverse.append(inverse)
        self._W[r], self._ids[r], self._signs[n + r] = normal, constraint, sign
        self._resize(r + 1)

    def drop(self, place: int) -> tuple[int, Array]:
        """Drop a fixed variable (place < n) or the row at place - n; return its number and the unit direction now free.

        The direction is the shortest of those that change no other constraint: O(n²).
        """
        n = self.free.size
        if place < n:
            direction, constraint = self._along_variable(place), place
            self._signs[place], self.free[place] = 0.0, 1.0
            self.inverse.free(place)
        else:
            direction, constraint = self.inverse.column(place - n), self._forget(place - n)
        direction = self.within(direction)
        if constraint >= 0:
            self.sides[constraint], self.held[constraint] = 0, False
        self.number -= 1
        if self.size or place >= n:
            direction /= sqrt(dot(direction, direction))
        if self.size:
            self.inverse.released(direction)
        return constraint, direction

    def within(self, direction: Array) -> Array:
        """The direction, made orthogonal to the rows again."""
        if self.size == 0:
            return direction
        rest = self.W.dot(direction)
        lost, length = dot(rest, rest), dot(direction, direction)
        if lost <= EXACT**2 * length:
            return direction
        self.sharp = self.sharp and lost <= BLUNT**2 * length
        return direction - self.inverse.times(rest)

    def _along_variable(self, variable: int) -> Array:
        """The direction that changes a fixed variable and no row."""
        direction = -self.inverse.times(self.W[:, variable]) if self.size else np.zeros(self.free.size)
        direction[variable] = 1.0
        return direction

    def _forget(self, row: int) -> int:
        """Replace a row by the last one, and return its constraint."""
        constraint, n, last = int(self._ids[row]), self.free.size, self.size - 1
        self.inverse.forget(row)
        self._W[row], self._ids[row] = self._W[last], self._ids[last]
        self._signs[n + row] = self._signs[n + last]
        self.temporary -= constraint < 0
        self._resize(last)
        return constraint

    def onto(self, x: Array) -> Array:
        """The nearest point on the bounds of the working set."""
        n = self.free.size
        targets = np.where(self.sides == 1, self.statement.upper, self.statement.lower)
        x = np.where(self.held[:n], targets[:n], x)
        if self.size == 0:
            return x
        right = targets[self.ids] if not self.temporary else self.W.dot(x)
        if self.temporary:
            real = self.ids >= 0
            right[real] = targets[self.ids[real]]
        near = x + self.inverse.times(right - self.W.dot(x))
        lost = EPS * self.inverse.sizes_times(np.abs(self.W).dot(np.abs(near)))
        if not np.count_nonzero(lost > FEW_DIGITS * np.abs(near)):
            return near
        return near + self.inverse.times(fine_remainders(right, self.W, near))


def supporting(progress: SearchState, sides: Sides) -> Sides:
    """Sides of independent active constraints with multipliers of the right sign, if the point is stationary.

    Other choices among dependent active constraints have multipliers of the wrong sign. Without such a set the sides
    are returned unchanged. Variables whose bounds are equal are fixed in any working set, with any multiplier. So they
    are kept, and the choice is made on the other variables.
    """
    statement, n = progress.statement, progress.x.size
    free, rows = (sides[:n] == 0).nonzero()[0], sides[n:].nonzero()[0]
    if rows.size == 0 or (progress.violation > progress.slack).any():
        return sides
    if orthogonal(unit_rows(statement.A[rows][:, free])[0], DEPENDENT, complete=False)[3].size == rows.size:
        return sides
    fixed = statement.equality & (np.arange(sides.size) < n)
    active = ((sides != 0) & ~fixed).nonzero()[0]
    others = (~fixed[:n]).nonzero()[0]
    normals, _ = unit_rows(statement.normals(active)[:, others])
    equal, upper = sides[active] == EQUALITY, sides[active] == 1
    inwards = np.where(upper, -1.0, 1.0)[:, None] * normals
    try:
        multipliers, residual = scipy.optimize.nnls(np.vstack([inwards, -normals[equal]]).T, progress.gradient[others])
    except RuntimeError:  # SciPy's iteration limit
        return sides
    if residual > progress.zero:
        return sides
    fine = FINE * progress.zero  # a multiplier may be decisive by its own terms
    strong = multipliers[: active.size] > fine
    strong[equal] |= multipliers[active.size :] > fine
    needed = (strong | equal).nonzero()[0]  # an equality is held anyway, so it comes before what has no multiplier
    first = np.zeros(active.size, dtype=bool)
    first[needed[independent_rows(normals[needed], strong[needed], DEPENDENT)]] = True
    kept = active[independent_rows(normals, first, DEPENDENT)]
    supporting = np.where(fixed, sides, 0).astype(sides.dtype)
    supporting[kept] = sides[kept]
    return supporting


def wrong_sign(
    working: WorkingSet,
    multipliers: Array,
    zero: float | Array,
    *,
    least_index: bool,
    curvatures: Array | None = None,
) -> int | None:
    """The place of the constraint to drop; None if all signs are right.

    `zero` is the size of a multiplier that counts as zero, one for all or (n + r,). With `least_index` the constraint
    of the lowest number among those with a wrong sign is taken (Bland 1977); with `curvatures` (n + r,) that of the
    steepest edge, else that of the largest multiplier.
    """
    wrong = working.signs * multipliers
    if working.temporary:
        n, ids = working.free.size, working.ids
        of_temporary = np.where(ids == TEMPORARY, np.inf, np.abs(multipliers[n:]))
        wrong[n:] = np.where(ids < 0, of_temporary, wrong[n:])
    place = int(wrong.argmax())
    if not isinstance(zero, float):
        if wrong.item(place) <= 0.0:
            return None
        wrong = np.where(wrong > zero, wrong, -np.inf)
        place, zero = int(wrong.argmax()), 0.0
    if wrong.item(place) <= zero:
        return None
    if least_index:
        return int(np.where(wrong > zero, working.numbers, working.held.size).argmin())
    if curvatures is not None:
        return int((np.square(np.where(wrong > zero, wrong, 0.0)) / curvatures).argmax())
    return place
