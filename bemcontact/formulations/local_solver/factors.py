"""The factors of the working set, updated when it changes by one constraint.

A_Wᵀ = Y T with T upper triangular, Z an orthonormal basis of the null space, RᵀR = ZᵀHZ (Gill, Murray, Saunders and
Wright, SIAM Review 33 (1991) 1-36, section 6). One orthogonal sweep serves all updates: the plane rotations that turn
a vector w into |w| e_last. If X w gives the last new column of X, then the rows of a triangular X are made triangular
again by the sweep of X⁻ᵀw, because X⁻ᵀ takes the same last column to a multiple of a unit vector.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import get_lapack_funcs, qr

from bemcontact.formulations.local_solver.statement import Statement

Array = NDArray[np.float64]

pivoted_cholesky, solve_triangular = get_lapack_funcs(("pstrf", "trtrs"), dtype=np.float64)

TEMPORARY, FLAT = -1, -2
"""Numbers of constraints that only fix a direction; FLAT once both its slope and its curvature were found zero."""

DEPENDENT = 1e-9
"""A normal whose part outside the span of the others is below this counts as dependent."""


def swept(X: Array, w: Array) -> Array:
    """X G for the rotations G in planes (0,1), (1,2), ... with Gᵀw = |w| e_last."""
    size = np.sqrt(np.cumsum(w * w))
    first = int(np.searchsorted(size, 1e-140, side="right"))
    if first >= w.size - 1:
        return X.copy() if w[-1] >= 0.0 else np.hstack([X[:, :-1], -X[:, -1:]])
    new = np.empty_like(X)
    new[:, :first] = X[:, :first]
    w, size, rest = w[first:], size[first:], X[:, first:]
    running = np.cumsum(rest * w, axis=1) / size
    new[:, first:-1] = running[:, :-1] * (w[1:] / size[1:]) - rest[:, 1:] * (size[:-1] / size[1:])
    new[:, -1] = running[:, -1]
    return new


def solve(R: Array, b: Array, *, transposed: bool = False) -> Array:
    """R⁻¹ b or R⁻ᵀ b for an upper triangular R."""
    if b.size == 0:
        return b
    # R' as LAPACK sees a row-major R is lower triangular, so no copy is made
    return solve_triangular(R.T, b, lower=1, trans=0 if transposed else 1)[0]


def bordered(R: Array, column: Array, corner: float) -> Array:
    """[[R, column], [0, corner]]."""
    k = R.shape[0]
    new = np.zeros((k + 1, k + 1))
    new[:k, :k], new[:k, k], new[k, k] = R, column, corner
    return new


class Factors:
    """The working set and its factors; changed in place by `add` and `drop`.

    Parameters
    ----------
    statement : Statement
        The scaled problem.
    sides : (n + m,) int8 array
        Wanted working set: 0 free, -1 lower, +1 upper, 2 equality. Dependent constraints are left out.
    curved : bool
        Whether to keep R, the Cholesky factor of the reduced Hessian (phase 2), with temporary constraints on the
        directions in which it is not positive definite.

    Attributes
    ----------
    ids : list of int
        Constraints in the order of the columns of T; `TEMPORARY` or `FLAT` for temporary ones.
    pending : (array, array, float) or None
        A null-space direction z outside R, l = R⁻ᵀZᵀHz and the curvature ρ = zᵀHz - lᵀl <= 0 (or about 0).
    """

    def __init__(self, statement: Statement, sides: NDArray[np.int8], *, curved: bool) -> None:
        self.statement = statement
        self.sides = sides.copy()
        self.curved = curved
        self.size = float(np.abs(statement.H).max(initial=0.0))
        self.refactor()

    def refactor(self) -> None:
        """All factors from the data: O(n³)."""
        n, A = self.statement.c.size, self.statement.A
        bounds, free = np.flatnonzero(self.sides[:n]), np.flatnonzero(self.sides[:n] == 0)
        rows = np.flatnonzero(self.sides[n:])
        Q, T, order = _orthogonal(A[np.ix_(rows, free)].T)
        rank = int(np.count_nonzero(np.abs(np.diag(T)) > DEPENDENT))
        kept = rows[order[:rank]]
        self.sides[n:] = np.where(np.isin(np.arange(A.shape[0]), kept), self.sides[n:], 0)
        k = bounds.size
        self.Y, self.Z, self.T = (
            np.zeros((n, k + rank)),
            np.zeros((n, free.size - rank)),
            np.zeros((k + rank, k + rank)),
        )
        self.Y[bounds, np.arange(k)] = 1.0
        self.Y[free, k:], self.Z[free] = Q[:, :rank], Q[:, rank:]
        self.T[np.arange(k), np.arange(k)] = 1.0
        self.T[:k, k:] = A[np.ix_(kept, bounds)].T
        self.T[k:, k:] = np.triu(T[:rank, :rank])
        self.ids = [*bounds.tolist(), *(n + kept).tolist()]
        self.R = np.zeros((0, 0))
        self.pending: tuple[Array, Array, float] | None = None
        if self.curved and self.Z.shape[1]:
            self._fix_nonpositive()

    def _fix_nonpositive(self) -> None:
        """Pivoted Cholesky of ZᵀHZ; the directions it leaves over are fixed by temporary constraints."""
        reduced = self.Z.T @ self.statement.H @ self.Z
        c, pivots, rank, _ = pivoted_cholesky(reduced, tol=self.curvature_tolerance)
        Z = self.Z[:, pivots - 1]
        # LAPACK does not hold the first pivot against the tolerance
        rank = int(rank) if reduced.diagonal().max() > self.curvature_tolerance else 0
        self.Z, self.R = np.ascontiguousarray(Z[:, :rank]), np.ascontiguousarray(np.triu(c[:rank, :rank]))
        fixed = Z[:, rank:]
        k, t = self.T.shape[0], fixed.shape[1]
        T = np.zeros((k + t, k + t))
        T[:k, :k] = self.T
        T[range(k, k + t), range(k, k + t)] = 1.0
        self.Y, self.T = np.hstack([self.Y, fixed]), T
        self.ids += [TEMPORARY] * t

    @property
    def curvature_tolerance(self) -> float:
        """Curvature of a unit direction that rounding could have made."""
        return 10.0 * max(10, self.statement.c.size) * np.finfo(float).eps * self.size

    def add(self, constraint: int, side: int) -> None:
        """One constraint enters, whose normal is not in the span of the others: O(n²)."""
        a = self.statement.normal(constraint)
        w, along = self.Z.T @ a, self.Y.T @ a
        pending, self.pending = self.pending, None
        new, corner = self._leave_null_space(w) if w.any() else (np.zeros(a.size), 0.0)
        rest = None
        if pending is not None:
            z = pending[0]
            beta = float(a @ z)
            length = float(np.hypot(corner, beta))
            rest = (beta * new - corner * z) / length if corner > 0.0 else None
            new, corner = (corner * new + beta * z) / length, length
        self.Y, self.T = np.column_stack([self.Y, new]), bordered(self.T, along, corner)
        self.ids.append(constraint)
        self.sides[constraint] = side
        if rest is not None:
            self.extend(rest)

    def _leave_null_space(self, w: Array) -> tuple[Array, float]:
        """Take Z w/|w| out of Z, and R along; the unit vector and |w|."""
        Z = swept(self.Z, w)
        if self.curved:
            q = solve(self.R, w, transposed=True)
            self.R = np.triu(swept(swept(self.R, w)[:, :-1].T, q)[:, :-1].T)
        self.Z = Z[:, :-1]
        return Z[:, -1], float(np.linalg.norm(w))

    def drop(self, position: int) -> int:
        """The constraint at this place of `ids` leaves: O(n²); returns its number."""
        k, j = self.T.shape[0], position
        unit = np.zeros(k)
        unit[j] = 1.0
        t = solve(self.T, unit, transposed=True)
        turned = np.flatnonzero(t)  # the others keep their columns, which saves nearly all the work where bounds rule
        Y, rows = swept(self.Y[:, turned], t[turned]), swept(self.T[turned].T, t[turned]).T
        self.Y[:, turned[1:]], self.T[turned[1:]] = Y[:, :-1], rows[:-1]
        self.Y, self.T = np.delete(self.Y, j, axis=1), np.triu(np.delete(np.delete(self.T, j, axis=0), j, axis=1))
        constraint = self.ids.pop(j)
        if constraint >= 0:
            self.sides[constraint] = 0
        self.extend(Y[:, -1])
        return constraint

    def extend(self, z: Array) -> None:
        """Z gains z if the reduced Hessian stays positive definite; otherwise z is pending."""
        if not self.curved:
            self.Z = np.column_stack([self.Z, z])
            return
        product = self.statement.H @ z
        column = solve(self.R, self.Z.T @ product, transposed=True)
        curvature, lost = float(z @ product), float(column @ column)
        rho, length = curvature - lost, 1.0
        if rho < 1e-4 * (abs(curvature) + lost):  # cancellation: measure the curvature on the direction itself
            d = z - self.Z @ solve(self.R, column)
            rho, length = float(d @ self.statement.H @ d), float(d @ d)
        if rho > self.curvature_tolerance * length:
            self.Z, self.R = np.column_stack([self.Z, z]), bordered(self.R, column, float(np.sqrt(rho)))
        else:
            self.pending = (z, column, rho)

    def fix_pending(self) -> None:
        """Fix the pending direction by a temporary constraint that was found flat."""
        if self.pending is not None:
            self.Y = np.column_stack([self.Y, self.pending[0]])
            self.T = bordered(self.T, np.zeros(self.T.shape[0]), 1.0)
            self.ids.append(FLAT)
            self.pending = None

    def curvature_direction(self) -> Array:
        """The unit direction of non-positive curvature, ZᵀHd = 0."""
        assert self.pending is not None
        z, column, _ = self.pending
        d = z - self.Z @ solve(self.R, column)
        return d / np.linalg.norm(d)

    def newton(self, gradient: Array) -> Array:
        """-Z (ZᵀHZ)⁻¹ Zᵀg."""
        return -self.Z @ solve(self.R, solve(self.R, self.Z.T @ gradient, transposed=True))

    def multipliers(self, gradient: Array) -> Array:
        """λ of A_Wᵀλ = g in the least-squares sense, in the order of `ids`."""
        return solve(self.T, self.Y.T @ gradient)

    def onto(self, values: Array) -> Array:
        """The shortest displacement that puts the working constraints on their bounds."""
        ids = np.array(self.ids, dtype=np.intp)
        real = ids >= 0
        lack = np.zeros(ids.size)
        held = ids[real]
        lack[real] = (
            np.where(self.sides[held] == 1, self.statement.upper[held], self.statement.lower[held]) - values[held]
        )
        return self.Y @ solve(self.T, lack, transposed=True)


def _orthogonal(normals: Array) -> tuple[Array, Array, NDArray[np.intp]]:
    """Q, R and the order of the columns in the pivoted QR factorisation."""
    if normals.size == 0:
        return np.eye(normals.shape[0]), np.zeros((0, 0)), np.zeros(0, dtype=np.intp)
    factors: Any = qr(normals, pivoting=True)
    return factors
