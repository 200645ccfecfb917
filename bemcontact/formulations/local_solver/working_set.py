"""The working set, with the shortest right inverse of its rows, updated when it changes by one constraint.

Bounds of the working set fix their variables; only rows need algebra. With W the rows on the variables that are free,

    W N = I,   N = Wᵀ(WWᵀ)⁻¹:

Nᵀg are the multipliers of the rows in the least-squares sense, and g - Wᵀ Nᵀg holds the multipliers of the fixed
variables beside the reduced gradient of the free ones. When a constraint enters or leaves, N changes by a matrix of
rank one (Greville, SIAM Review 2 (1960) 15-22).
"""

from math import sqrt

import numpy as np
from numpy.typing import NDArray

from bemcontact.arrays import Array
from bemcontact.formulations.local_solver.factorizations import add_rank_one, inverse_triangle, orthogonal, unit_rows
from bemcontact.formulations.local_solver.statement import Sides, Statement

EQUALITY = 2
TEMPORARY, FLAT = -1, -2
"""Numbers of rows that only fix a direction; FLAT once both its slope and its curvature were found zero."""

DEPENDENT = 1e-9
"""A normal whose part outside the span of the others is a smaller part of it counts as dependent."""

ALIKE = 1e-12
"""The same for one that enters later, against a step that it has ended."""

SHARP, WEAR = 1e-12, 1e-8
"""Relative size of a refinement above which refinements are needed, and above which N is made anew."""


class WorkingSet:
    """The constraints that are held, changed in place by `add` and `drop`.

    Parameters
    ----------
    statement : Statement
        The scaled problem.
    sides : (n + m,) int8 array
        Wanted working set: 0 free, -1 lower, +1 upper, 2 equality. Dependent rows are left out.

    Attributes
    ----------
    sides : (n + m,) int8 array
        What is held.
    held : (n + m,) bool array
        The same without sides.
    free : (n,) array
        1 for a variable that is not fixed by a bound, else 0.
    number : int
        How many constraints are held, temporary ones included.
    N, W : (n, r) and (r, n) arrays
        Right inverse, zero in the rows of fixed variables; normals of the rows held, on all variables.
    null_space : (n, k) array
        Orthonormal directions that change nothing held at the start; later changes of the set leave them alone.
    ids : (r,) int array
        Constraint of each row of W; `TEMPORARY` or `FLAT` for one that is none.
    signs : (n + r,) array
        -1 for a variable or row at its lower bound, +1 at its upper, 0 for any other.
    temporary : int
        How many rows of W are no constraints.
    sharp : bool
        Whether N still has all its digits.
    """

    def __init__(self, statement: Statement, sides: Sides) -> None:
        n, A = statement.c.size, statement.A
        self.statement = statement
        self.sides = sides.copy()
        self.held = sides != 0
        self.free = (~self.held[:n]).astype(float)
        self._N, self._W = np.zeros((n, n), order="F"), np.zeros((n, n))
        self._ids, self._signs = np.zeros(n, dtype=np.intp), np.zeros(2 * n)
        free, rows = self.free.nonzero()[0], sides[n:].nonzero()[0]
        kept, self.null_space = rows[:0], np.eye(n)[:, free]
        if rows.size and free.size:
            normals, length = unit_rows(A[rows][:, free])
            Y, null_space, T, independent = orthogonal(normals, DEPENDENT)
            kept, self.null_space = rows[independent], np.zeros((n, null_space.shape[1]))
            self.null_space[free] = null_space
            self._N[free, : kept.size] = Y @ inverse_triangle(T).T / length[independent]
        if kept.size < rows.size:
            self.sides[n + rows], self.held[n + rows] = 0, False
            self.sides[n + kept], self.held[n + kept] = sides[n + kept], True
        r = kept.size
        self.number = n - free.size + r
        self.temporary, self.sharp = 0, True
        signs = self.sides * (self.sides != EQUALITY)
        self._signs[:n] = signs[:n]
        if r:
            self._ids[:r], self._W[:r], self._signs[n : n + r] = n + kept, A[kept], signs[n + kept]
        self._resize(r)

    def _resize(self, rows: int) -> None:
        """Look at the leading columns of N and rows of W."""
        self.size = rows
        self.N, self.W, self.ids = self._N[:, :rows], self._W[:rows], self._ids[:rows]
        self.signs = self._signs[: self.free.size + rows]

    @property
    def numbers(self) -> NDArray[np.intp]:
        """The constraint of each place (n + r,): the variables, then `ids`."""
        return np.concatenate([np.arange(self.free.size), self.ids])

    def constraints(self) -> tuple[NDArray[np.intp], Array, Array]:
        """The rows that are constraints: `ids`, W and N without those that are temporary."""
        if not self.temporary:
            return self.ids, self.W, self.N
        real = self.ids >= 0
        return self.ids[real], self.W[real], self.N[:, real]

    def multipliers(self, gradient: Array, *, refined: bool = False) -> Array:
        """Of the fixed variables, beside the reduced gradient of the free ones, and of the rows (n + r,).

        They are refined with the data if N has lost digits, or if that is asked for.
        """
        if self.size == 0:
            return gradient
        of_rows = gradient.dot(self.N)
        if refined or not self.sharp:
            of_rows = self._refined(of_rows, gradient)
        n = gradient.size
        found = np.empty(n + self.size)
        np.subtract(gradient, of_rows.dot(self.W), found[:n])
        found[n:] = of_rows
        return found

    def of_all(self, multipliers: Array) -> Array:
        """Those of all constraints (n + m,) from those of the working set, as `multipliers` has them."""
        n, real = self.free.size, self.ids >= 0
        found = np.zeros(self.held.size)
        found[:n] = multipliers[:n] * self.held[:n]
        found[self.ids[real]] = multipliers[n:][real]
        return found

    def _refined(self, of_rows: Array, gradient: Array) -> Array:
        """Multipliers of the rows after a refinement; from a new N if there was too much to mend."""
        correction = (gradient - of_rows.dot(self.W)).dot(self.N)
        if correction.dot(correction) > WEAR**2 * of_rows.dot(of_rows):
            self._renew()
            of_rows = gradient.dot(self.N)
            correction = (gradient - of_rows.dot(self.W)).dot(self.N)
        return of_rows + correction

    def _renew(self) -> None:
        """N from the rows anew, once rounding has piled up in it: O(n³)."""
        free = np.flatnonzero(self.free)
        Y, _, T, order = orthogonal(self.W[:, free], 0.0)
        if order.size == self.size:
            self.N[np.ix_(free, order)] = Y @ inverse_triangle(T).T
            self.sharp = True

    def add(self, constraint: int, side: int) -> Array | None:
        """One constraint enters; returns its normal, or None if that is in the span of the others: O(n²)."""
        normal = self.statement.normal(constraint)
        sign = side if side != EQUALITY else 0
        if constraint >= normal.size:
            inverse = self._hold(normal, normal.dot(self.N))
            if inverse is None:
                return None
            self._append(normal, constraint, sign, inverse)
        else:
            if self.size:
                if self._hold(normal, self.N[constraint].copy()) is None:
                    return None
                self.N[constraint] = 0.0
            self._signs[constraint], self.free[constraint] = sign, 0.0
        self.sides[constraint], self.held[constraint] = side, True
        self.number += 1
        return normal

    def spans(self, constraint: int) -> bool:
        """Whether the normal of a constraint is a combination of those that are held."""
        normal = self.statement.normal(constraint) * self.free
        outside = normal
        for _ in range(2):
            outside = (outside - outside.dot(self.N).dot(self.W)) * self.free
        return float(outside.dot(outside)) <= ALIKE**2 * float(normal.dot(normal))

    def fix(self, direction: Array, kind: int) -> None:
        """A temporary row enters, with a direction of the null space as its normal."""
        inverse = self._hold(direction, direction.dot(self.N))
        if inverse is not None:
            self._append(direction, kind, 0, inverse)
            self.number += 1
            self.temporary += 1

    def _hold(self, normal: Array, along: Array) -> Array | None:
        """N loses what it has along the normal; the new column, or None if the normal is in the span."""
        outside = (normal - along.dot(self.W)) * self.free
        again, size = outside.dot(self.N), float(outside.dot(normal))
        if again.dot(again) > SHARP**2 * size:
            self.sharp = False
            outside -= again.dot(self.W) * self.free
            size = float(outside.dot(normal))
        if size <= ALIKE**2:
            return None
        inverse = outside / size
        add_rank_one(self.N, -1.0, inverse, along)
        return inverse

    def _append(self, normal: Array, constraint: int, sign: int, inverse: Array) -> None:
        """One more row of W and column of N."""
        r, n = self.size, self.free.size
        self._N[:, r], self._W[r], self._ids[r], self._signs[n + r] = inverse, normal, constraint, sign
        self._resize(r + 1)

    def drop(self, place: int) -> tuple[int, Array]:
        """A fixed variable (place < n) or the row at place - n leaves; its number and the direction that is free now.

        The direction has length one, and the shortest of those that change no other constraint: O(n²).
        """
        n = self.free.size
        if place < n:
            direction, constraint = self._along_variable(place), place
            self._signs[place], self.free[place] = 0.0, 1.0
        else:
            direction, constraint = self._N[:, place - n].copy(), self._forget(place - n)
        if not self.sharp:
            direction = self.within(direction)
        if constraint >= 0:
            self.sides[constraint], self.held[constraint] = 0, False
        self.number -= 1
        if self.size or place >= n:
            direction /= sqrt(direction.dot(direction))
            add_rank_one(self.N, -1.0, direction, direction.dot(self.N))
        return constraint, direction

    def within(self, direction: Array) -> Array:
        """A direction without what rounding has left in it along the rows."""
        return direction - self.N.dot(self.W.dot(direction)) if self.size else direction

    def _along_variable(self, variable: int) -> Array:
        """The direction that changes a fixed variable and no row."""
        direction = -self.N.dot(self.W[:, variable]) if self.size else np.zeros(self.free.size)
        direction[variable] = 1.0
        return direction

    def _forget(self, row: int) -> int:
        """The last row takes the place of this one."""
        constraint, n, last = int(self._ids[row]), self.free.size, self.size - 1
        self._N[:, row], self._W[row], self._ids[row] = self._N[:, last], self._W[last], self._ids[last]
        self._signs[n + row] = self._signs[n + last]
        self.temporary -= constraint < 0
        self._resize(last)
        return constraint

    def onto(self, x: Array) -> Array:
        """The nearest point on the bounds of the working set."""
        n, lower, upper = self.free.size, self.statement.lower, self.statement.upper
        targets = np.where(self.sides == 1, upper, lower)
        x = np.where(self.held[:n], targets[:n], x)
        if self.size == 0:
            return x
        ids, W, N = self.constraints()
        return x + N.dot(targets[ids] - W.dot(x))
