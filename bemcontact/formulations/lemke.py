"""Lemke's complementary pivoting for w = q + M z, w >= 0, z >= 0, w·z = 0.

Reference: Cottle, Pang and Stone, "The Linear Complementarity Problem", 1992, section 4.4, with the lexicographic rule
of section 4.9, which makes it finite. For a row sufficient M the path ends at a solution or proves that there is none.
"""

from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from bemcontact.arrays import Array, BoolArray
from bemcontact.contact.solution import Status

PIVOT = 1e-11
TIE = 1e-12
VANISHED = 1e-13
ROUND_OFF = 1e-11
REFRESH = 50
"""Pivots after which the inverse of the basis is computed anew, against the growth of round-off."""


@dataclass(frozen=True, kw_only=True, eq=False)
class LemkeEnd:
    """How the path of pivots ended.

    Parameters
    ----------
    status : SOLVED, INFEASIBLE (proved by a ray), ITERATION_LIMIT, or NO_SOLUTION_FOUND (no proof)
    active : (n,) True where z is a basic variable
    covers : z0 after each pivot
    """

    status: Status
    active: BoolArray
    covers: tuple[float, ...]

    @property
    def pivots(self) -> int:
        """Number of pivots."""
        return len(self.covers)


def lemke(M: Array, q: Array, covering: Array | None = None, limit: int | None = None) -> LemkeEnd:
    """Follow the solutions of w = q + M z + d z0 from a large z0 down to z0 = 0.

    Parameters
    ----------
    M : (n, n)
    q : (n,), of size one as M is: the tolerances are absolute
    covering : (n,) d > 0. The default, row sums of |M| plus max|q|, takes two pivots for the families of Murty and of
        Fathi; d = (1, 2, 4, ...) takes 2ⁿ for Murty's.
    limit : most pivots to make, default 1000 + 50 n

    Returns
    -------
    LemkeEnd
        Which variables are basic. Solve for their values anew: that is more accurate than the pivots are.
    """
    n = len(q)
    if (q >= 0).all():
        return LemkeEnd(status=Status.SOLVED, active=np.zeros(n, bool), covers=())
    d = np.abs(M).sum(axis=1) + np.abs(q).max() if covering is None else covering
    limit = 1000 + 50 * n if limit is None else limit
    basis, covers = _Basis(M, q, d), []
    entering, column, row = basis.cover, -d, basis.leaving_row(d)
    while row is not None and len(covers) < limit:
        left = basis.exchange(row, entering, column)
        covers.append(basis.cover_value)
        if left == basis.cover:
            return LemkeEnd(status=Status.SOLVED, active=basis.active, covers=tuple(covers))
        entering = left + n if left < n else left - n
        column = basis.column(entering)
        row = basis.leaving_row(column)
    status = Status.ITERATION_LIMIT if row is not None else _end_of_ray(M, q, basis, entering, column)
    return LemkeEnd(status=status, active=basis.active, covers=tuple(covers))


class _Basis:
    """The dictionary w - M z - d z0 = q for one set of basic variables: 0..n-1 are w, n..2n-1 are z, 2n is z0."""

    def __init__(self, M: Array, q: Array, d: Array) -> None:
        self.cover = 2 * len(q)
        self.vectors = np.vstack([np.eye(len(q)), -M.T, -d])
        self.right = q
        self.basic = np.arange(len(q))
        self.inverse = np.eye(len(q))
        self.values = q.copy()
        self.age = 0

    @property
    def active(self) -> BoolArray:
        """(n,) True where z is basic."""
        active = np.zeros(self.cover + 1, bool)
        active[self.basic] = True
        return active[len(self.right) : self.cover]

    @property
    def cover_value(self) -> float:
        """z0, which is zero where it is not basic."""
        return float(self.values[self.basic == self.cover].sum())

    def column(self, variable: int) -> Array:
        """Decrease of each basic variable per increase of this one, (n,)."""
        return self.inverse @ self.vectors[variable]

    def leaving_row(self, column: Array) -> int | None:
        """The basic variable that first falls to zero, lexicographically; z0 where it is among the first."""
        rows = np.flatnonzero(column > PIVOT * max(1.0, np.abs(column).max()))
        if not rows.size:
            return None
        for values in (self.values, *self.inverse.T):
            ratios = values[rows] / column[rows]
            rows = rows[ratios <= ratios.min() + TIE]
            for row in rows[self.basic[rows] == self.cover]:
                return int(row)
            if rows.size == 1:
                break
        return int(rows[0])

    def exchange(self, row: int, entering: int, column: Array) -> int:
        """Pivot, and return the variable that left."""
        left = int(self.basic[row])
        self.basic[row] = entering
        self.age += 1
        for array in (self.inverse, self.values):
            pivot_row = array[row] / column[row]
            array -= np.multiply.outer(column, pivot_row)
            array[row] = pivot_row
        if self.age % REFRESH == 0:
            with suppress(np.linalg.LinAlgError):  # then the updated inverse has to serve
                self.inverse = np.linalg.inv(self.vectors[self.basic].T)
                self.values = self.inverse @ self.right
        return left


def _end_of_ray(M: Array, q: Array, basis: _Basis, entering: int, column: Array) -> Status:
    """A direction y >= 0 of z along which nothing falls proves infeasibility if Mᵀy <= 0 and qᵀy < 0 (Farkas)."""
    if basis.cover_value <= VANISHED:
        return Status.SOLVED
    direction = np.zeros(basis.cover + 1)
    direction[basis.basic] = -column
    direction[entering] = 1.0
    y = np.maximum(direction[len(q) : basis.cover], 0.0)
    y /= max(y.max(), 1e-300)
    proved = (M.T @ y).max() <= ROUND_OFF and q @ y < -1e3 * ROUND_OFF
    return Status.INFEASIBLE if proved else Status.NO_SOLUTION_FOUND
