"""Lemke's complementary pivoting for w = q + M z >= 0, z >= 0, z·w = 0, and what holds and excludes a solution.

Cottle, Pang and Stone, "The Linear Complementarity Problem", 1992, section 4.4, with the lexicographic rule of section
4.9, which makes it finite. For a row sufficient M the path ends at a solution, or on a ray if there is none.
"""

from contextlib import suppress

import numpy as np
import scipy

from bemcontact.arrays import Array, BoolArray, powers_of_two
from bemcontact.contact.solution import Status
from bemcontact.formulations.linear_rays import FINEST
from bemcontact.formulations.local_solver.infeasibility import proof_of_infeasibility
from bemcontact.frozen import frozen

PIVOT = 1e-11
TIE = 1e-12
VANISHED = 1e-13
VERIFIED, LEAST = 1e-10, 1e-4
"""Part of the terms of a number that may be rounding; part of the largest variable that any variable counts with."""
REFRESH = 50
"""Pivots after which the inverse of the basis is computed anew, against the growth of round-off."""
EQUILIBRATIONS = 10


@frozen
class LemkeEnd:
    """How the path of pivots ended: its status, where z is basic (n,), and z0 after each pivot (`covers`).

    The status is SOLVED, INFEASIBLE (proved by multipliers), ITERATION_LIMIT, or NO_SOLUTION_FOUND (no proof).
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

    Solve for the values of the basic variables anew: that is more accurate than the pivots are. Rows and columns are
    scaled alike until the largest number of each is near one, for short elements make numbers of M that are smaller
    than the round-off of others; q is scaled to one.

    Parameters
    ----------
    M, q : (n, n) and (n,)
    covering : (n,) d > 0. The default, row sums of |M| plus max|q| once scaled, takes two pivots for the families of
        Murty and of Fathi; d = (1, 2, 4, ...) takes 2ⁿ for Murty's.
    limit : of pivots, default 1000 + 50 n
    """
    n = len(q)
    if (q >= 0).all():
        return LemkeEnd(status=Status.SOLVED, active=np.zeros(n, bool), covers=())
    if n == 1 and M[0, 0] > 0:
        return LemkeEnd(status=Status.SOLVED, active=np.ones(1, bool), covers=(0.0,))
    factors = equilibrating(M)
    M, q = factors[:, None] * M * factors, factors * q
    unit = float(powers_of_two(np.abs(q).max()))
    q = q / unit
    d = np.abs(M).sum(axis=1) + np.abs(q).max() if covering is None else factors * covering
    limit = 1000 + 50 * n if limit is None else limit
    basis, covers = _Basis(M, q, d), []
    entering, column, row = basis.cover, -d, basis.leaving_row(d)
    while row is not None and len(covers) < limit:
        left = basis.exchange(row, entering, column)
        covers.append(unit * basis.cover_value)
        if left == basis.cover:
            status = Status.SOLVED if _is_solution(M, q, basis.active) else Status.NO_SOLUTION_FOUND
            return LemkeEnd(status=status, active=basis.active, covers=tuple(covers))
        entering = left + n if left < n else left - n
        column = basis.column(entering)
        row = basis.leaving_row(column)
    status = Status.ITERATION_LIMIT if row is not None else _end_of_ray(M, q, basis, entering, column)
    return LemkeEnd(status=status, active=basis.active, covers=tuple(covers))


def equilibrating(M: Array) -> Array:
    """Powers of two (n,), for rows and columns alike, by which the largest number of each becomes one, nearly.

    D. Ruiz, "A scaling algorithm to equilibrate both rows and columns norms in matrices", RAL-TR-2001-034.
    """
    size, factors = np.abs(M), np.ones(len(M))
    for _ in range(EQUILIBRATIONS):
        equal = factors[:, None] * size * factors
        largest = np.maximum(equal.max(axis=0, initial=0.0), equal.max(axis=1, initial=0.0))
        factors /= np.sqrt(np.where(largest > 0, largest, 1.0))
    return powers_of_two(factors)


def holds(M: Array, q: Array, z: Array) -> bool:
    """Whether z (n,) solves the problem up to rounding: each number beside the terms it is made of.

    Where w is not zero, z has to be too small to matter in any row. A z that is small beside others has their rounding,
    so that units of variables should be even.
    """
    size = np.abs(z)
    known = np.where(size > 0, np.maximum(size, LEAST * size.max(initial=0.0)), 0.0)
    terms = VERIFIED * (np.abs(M) @ known + np.abs(q))
    w = q + M @ z
    faint = (np.abs(M) * size <= terms[:, None]).all(axis=0)
    return bool((w >= -terms).all() and ((z >= 0) | faint).all() and ((w <= terms) | faint).all())


def holds_row_by_row(M: Array, q: Array, z: Array) -> bool:
    """Whether z >= 0 (n,) solves the problem, each w held against its own terms alone."""
    terms, w = VERIFIED * (np.abs(M) @ z + np.abs(q)), q + M @ z
    return bool((w >= -terms).all() and (w <= terms)[z > 0].all())


def basic_solution(M: Array, q: Array, active: BoolArray) -> Array:
    """The z (n,) with w = q + M z = 0 where `active` and z = 0 elsewhere; the shortest one where there are several."""
    z = np.zeros(len(q))
    z[active] = -np.linalg.lstsq(M[np.ix_(active, active)], q[active], rcond=None)[0]
    return z


def _is_solution(M: Array, q: Array, active: BoolArray) -> bool:
    """Whether the values of a basis solve the problem."""
    return holds(M, q, basic_solution(M, q, active))


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
    """Infeasible, if the direction y >= 0 of z along which nothing falls proves it, or another one."""
    if basis.cover_value <= VANISHED and _is_solution(M, q, basis.active):
        return Status.SOLVED
    direction = np.zeros(basis.cover + 1)
    direction[basis.basic] = -column
    direction[entering] = 1.0
    y = np.maximum(direction[len(q) : basis.cover], 0.0)
    infeasible = excludes(M, q, y) or excludes(M, q, _separating(M, q))
    return Status.INFEASIBLE if infeasible else Status.NO_SOLUTION_FOUND


def _separating(M: Array, q: Array) -> Array:
    """The y (n,) with 0 <= y <= 1 and Mᵀy <= 0 for which qᵀy is least, by a linear program.

    The direction in which Lemke's method ends is one for semidefinite M, and not for such M with other weights on rows.
    """
    found = scipy.optimize.linprog(
        q / np.abs(q).max(), A_ub=M.T, b_ub=np.zeros(len(q)), bounds=(0.0, 1.0),
        options=FINEST,
    )  # fmt: skip
    return found.x if found.status == 0 else np.zeros(len(q))


def excludes(M: Array, q: Array, y: Array) -> bool:
    """Whether y >= 0 (n,) proves that no z >= 0 has w >= 0: Mᵀy <= 0 and qᵀy < 0 (Farkas)."""
    none = np.full(2 * len(q), np.inf)
    return proof_of_infeasibility(M, np.concatenate([0.0 * q, -q]), none, y, 0.0 * q) is not None
