"""The Hessian on the null space of the working set: a conjugate basis of it, and at most one direction of no curvature.

    Zᵀ H Z = I,   and d with Zᵀ H d = 0, dᵀ H d <= 0 (pending), if there is one.

Any rotation of the columns of Z keeps this, so that a reflection lets a constraint enter; a direction that becomes free
is made conjugate to the others. No other direction is let in while one is pending, so that the reduced Hessian never
has two non-positive eigenvalues (Gill, Murray, Saunders and Wright, SIAM Review 33 (1991) 1-36).
"""

from math import sqrt

import numpy as np

from bemcontact.arrays import Array
from bemcontact.formulations.local_solver.factorizations import add_rank_one, inverse_triangle, pivoted_cholesky
from bemcontact.formulations.local_solver.statement import EPS, Statement


class ReducedHessian:
    """A conjugate basis of the null space, changed in place by `enter` and `leave`.

    Parameters
    ----------
    statement : Statement
        The scaled problem.
    null_space : (n, k) array
        An orthonormal basis to start from.

    Attributes
    ----------
    Z : (n, k) array
        The conjugate basis.
    left_over : (n, t) array
        Directions of the start in which the Hessian is not positive definite, orthonormal; they are to be fixed.
    pending : (n,) array or None
        The unit direction of no positive curvature.
    curvature : float
        dᵀHd of the pending direction; exactly zero where it is rounding.
    """

    def __init__(self, statement: Statement, null_space: Array) -> None:
        n, k = null_space.shape
        self.statement = statement
        self._top = float(statement.absolute[0].max())
        self._columns = np.zeros((n, n), order="F")
        self.left_over = null_space[:, :0]
        self._resize(0)
        self.pending: Array | None = None
        self.curvature = 0.0
        if k:
            reduced = null_space.T @ statement.H @ null_space
            zero = 10.0 * max(10, n) * EPS * self._top
            factor, order, rank = pivoted_cholesky(reduced, zero)
            ordered = null_space[:, order]
            self.left_over = ordered[:, rank:]
            self._resize(rank)
            self.Z[:] = ordered[:, :rank] @ inverse_triangle(factor)

    def _resize(self, size: int) -> None:
        """Look at the leading columns."""
        self.size, self.Z = size, self._columns[:, :size]

    def newton(self, gradient: Array) -> Array:
        """-Z Zᵀg: to the minimizer on the working set."""
        return -self.Z.dot(gradient.dot(self.Z))

    def is_stationary(self, gradient: Array, zero: float) -> bool:
        """Whether the reduced gradient is below `zero`, by |gᵀZ|² |ZᵀHZ|: quick, and never true of one that is not."""
        if self.size == 0:
            return True
        slopes = gradient.dot(self.Z)
        return float(slopes.dot(slopes)) * self._top * gradient.size <= zero**2

    def enter(self, direction: Array) -> None:
        """A direction of length one joins the null space: Z gains it, or it is pending: O(n²)."""
        d, H, Z = direction, self.statement.H, self.Z
        product = H.dot(d)
        curvature = float(d.dot(product))
        length = 1.0
        for _ in range(2 if self.size else 0):
            d = d - Z.dot(product.dot(Z))
            product = H.dot(d)
            before, curvature = curvature, float(d.dot(product))
            if abs(curvature) > 0.01 * abs(before):
                break  # no digits were lost that a second turn would bring back
        if self.size:
            length = float(d.dot(d))
        clear = curvature == 0.0 or abs(curvature) > 1e-8 * self._top * length
        rounding = 0.0 if clear else self.statement.rounding(d)
        if curvature > rounding:
            self._columns[:, self.size] = d / sqrt(curvature)
            self._resize(self.size + 1)
        else:
            self.pending = d if length == 1.0 else d / sqrt(length)
            self.curvature = curvature / length if curvature < -rounding else 0.0

    def leave(self, normal: Array) -> None:
        """A constraint joins the working set: the part of the null space along its normal goes: O(n²)."""
        pending, self.pending = self.pending, None
        if self.size == 0:
            return
        if self.size == 1 and pending is None:
            self._resize(0)
            return
        along = normal.dot(self.Z)
        length = sqrt(along.dot(along))
        if length == 0.0:
            return
        last = self._reflect(along, length)
        if pending is not None:
            rest = length * pending - float(normal.dot(pending)) * last
            self.enter(rest / sqrt(rest.dot(rest)))

    def _reflect(self, along: Array, length: float) -> Array:
        """Turn Z so that the normal meets its last column alone, and take that out; normalᵀ column = length."""
        sign = -1.0 if along[-1] > 0.0 else 1.0
        along[-1] -= sign * length
        add_rank_one(self.Z, -2.0 / float(along.dot(along)), self.Z.dot(along), along)
        self._resize(self.size - 1)
        return sign * self._columns[:, self.size]

    def clear(self, variable: int) -> None:
        """A fixed variable has no part in any direction, not even by rounding."""
        self.Z[variable] = 0.0
        if self.pending is not None:
            self.pending[variable] = 0.0
