"""The quadratic program, and the check of the data on entry."""

from math import sqrt
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import sparse

from bemcontact.arrays import Array, BoolArray, real_array
from bemcontact.cached import cached_property
from bemcontact.errors import ProblemError
from bemcontact.formulations.local_solver.factorizations import symv
from bemcontact.frozen import frozen_value

Sides = NDArray[np.int8]

INFINITE = 1e20
"""A bound of this size or more counts as infinite, as in most solvers."""
WORTH_SPARSE, SPARSE = 150, 0.1
"""Least number of variables, and largest part of entries that are not zero, of a matrix whose zeros are left out."""
FEW_ENTRIES = 10000
"""Largest number of entries of a matrix of which a product with all rows takes no longer than one with some."""
INFINITY = float("inf")
EPS = float(np.finfo(float).eps)


def largest(numbers: Array) -> float:
    """The largest absolute value, 0 if there is none."""
    sizes = np.abs(numbers)
    return sizes.item(sizes.argmax()) if sizes.size else 0.0


@frozen_value
class Statement:
    """min cᵀx + xᵀHx/2 over lower <= [x; A x] <= upper: a bound is a constraint whose normal is a unit vector.

    Parameters
    ----------
    H : (n, n) symmetric, of any inertia
    c : (n,)
    A : (m, n)
    lower, upper : (n + m,) of the variables, then of the rows; infinite where there is none
    """

    H: Array
    c: Array
    A: Array
    lower: Array
    upper: Array

    @property
    def slope(self) -> float:
        """The largest entry of c."""
        return largest(self.c)

    @cached_property
    def absolute(self) -> tuple[Array, Array, Array]:
        """|H|, |c|, |A|, from which bounds of the rounding are computed."""
        return np.abs(self.H), np.abs(self.c), np.abs(self.A)

    @cached_property
    def _factors(self) -> tuple[Any, Any]:
        """H and |H|, without their zeros if products are faster then."""
        n = self.c.size
        if n < WORTH_SPARSE or np.count_nonzero(self.H) > SPARSE * n * n:
            return self.H, self.absolute[0]
        H = sparse.csr_array(self.H)
        return H, abs(H)

    def bent(self, x: Array) -> Array:
        """H x."""
        H = self._factors[0]
        if x.ndim == 1 and x.size >= WORTH_SPARSE and H is self.H:
            return symv(1.0, H.T, x)  # which reads half of H
        return H.dot(x)

    def curved(self, size: Array) -> Array:
        """Sum of the sizes of the terms of H x, from the sizes of x."""
        return self._factors[1].dot(size)

    @property
    def row_sum(self) -> float:
        """The largest sum of a row of |H|."""
        return largest(self.absolute[0].dot(np.ones(self.c.size)))

    @cached_property
    def bound_size(self) -> Array:
        """Absolute value of the smaller bound of each constraint; 0 if there is no bound (n + m,)."""
        size = np.minimum(np.abs(self.lower), np.abs(self.upper))
        size[size == np.inf] = 0.0
        return size

    @cached_property
    def equality(self) -> BoolArray:
        """Whether the two bounds of each constraint are equal up to rounding (n + m,)."""
        return self.upper - self.lower <= 4.0 * EPS * self.bound_size

    def objective(self, x: Array) -> float:
        """cᵀx + xᵀHx/2."""
        return float(x.dot(self.c + 0.5 * self.H.dot(x)))

    def values(self, x: Array) -> Array:
        """[x; A x]."""
        m, n = self.A.shape
        if m == 0:
            return x
        values = np.empty(n + m)
        values[:n] = x
        self.A.dot(x, values[n:])
        return values

    def terms(self, size: Array) -> Array:
        """Sum of the sizes of the terms of each value (n + m,), from the sizes of the variables (n,)."""
        m, n = self.A.shape
        if m == 0:
            return size
        terms = np.empty(n + m)
        terms[:n] = size
        self.absolute[2].dot(size, terms[n:])
        return terms

    def transposed(self, y: Array) -> Array:
        """[I; A]ᵀ y."""
        n, of_rows = self.c.size, y[self.c.size :]
        if self.A.size > FEW_ENTRIES:
            used = of_rows.nonzero()[0]
            if 4 * used.size < of_rows.size:
                return y[:n] + of_rows[used].dot(self.A[used])
        return y[:n] + of_rows.dot(self.A)

    def normal(self, constraint: int) -> Array:
        """Gradient of one constraint."""
        n = self.c.size
        if constraint >= n:
            return self.A[constraint - n]
        unit = np.zeros(n)
        unit[constraint] = 1.0
        return unit

    def normals(self, constraints: NDArray[np.intp]) -> Array:
        """Gradients of constraints in ascending order."""
        n, fixed = self.c.size, int(constraints.searchsorted(self.c.size))
        normals = np.zeros((constraints.size, n))
        normals[np.arange(fixed), constraints[:fixed]] = 1.0
        normals[fixed:] = self.A[constraints[fixed:] - n]
        return normals

    def sides_reached(self, values: Array, slack: Array) -> Sides:
        """Nearer bound of each active constraint (-1, +1, or 2 for an equality); 0 if it is farther than its slack."""
        return self.sides_within(*self.distances(values), slack)

    def distances(self, values: Array) -> tuple[Array, Array]:
        """Distance of each value from its lower and from its upper bound (n + m,)."""
        return np.abs(values - self.lower), np.abs(values - self.upper)

    def sides_within(self, below: Array, above: Array, slack: Array) -> Sides:
        """`sides_reached` from the `distances`."""
        sides = np.ones(below.size, dtype=np.int8)
        sides[below <= above] = -1
        sides[self.equality] = 2
        sides[np.minimum(below, above) > slack] = 0
        return sides

    def rounding(self, d: Array) -> float:
        """Bound of the rounding in dᵀHd."""
        size = np.abs(d)
        product = self.curved(size)
        return 100.0 * sqrt(d.size) * EPS * float(size.dot(product) + largest(size) * largest(product * (size > 0.0)))

    def violation(self, values: Array) -> Array:
        """Distance of each value from its bounds; 0 if it is between them (n + m,)."""
        return np.maximum(np.maximum(self.lower - values, values - self.upper), 0.0)


def read_statement(
    H: Any, c: ArrayLike, A: Any, cl: ArrayLike | None, cu: ArrayLike | None, bl: ArrayLike | None, bu: ArrayLike | None
) -> Statement:
    """Check the data and put them in one form; `ProblemError` says what is wrong with them."""
    linear = numbers("c", c, None)
    n = linear.size
    if n == 0:
        raise ProblemError("c is empty: give at least one variable")
    hessian = _matrix("H", H, n)
    if hessian.shape[0] != n:
        raise ProblemError(f"H has {hessian.shape[0]} rows, but c has {n} entries: H must be ({n}, {n})")
    if np.count_nonzero(hessian != hessian.T):
        difference = np.abs(hessian - hessian.T).max()
        if difference > 1e-10 * np.abs(hessian).max():
            raise ProblemError(f"H is not symmetric: H - H' has entries up to {difference:.3g}; give (H + H') / 2")
        hessian = 0.5 * hessian + 0.5 * hessian.T
    rows = np.zeros((0, n)) if A is None else _matrix("A", A, n)
    m = rows.shape[0]
    if A is None and (cl is not None or cu is not None):
        raise ProblemError("cl or cu is given without A: give the rows A that they bound, or use bl and bu")
    lower = np.concatenate([_bound("bl", bl, n, -np.inf), _bound("cl", cl, m, -np.inf)])
    upper = np.concatenate([_bound("bu", bu, n, np.inf), _bound("cu", cu, m, np.inf)])
    crossed = np.count_nonzero(lower <= upper) < lower.size  # or not a number
    if crossed or lower.item(lower.argmax()) == INFINITY or upper.item(upper.argmin()) == -INFINITY:
        _complain(lower, upper, n)
    lower[lower <= -INFINITE], upper[upper >= INFINITE] = -np.inf, np.inf
    return Statement(H=hessian, c=linear, A=rows, lower=lower, upper=upper)


def numbers(name: str, given: ArrayLike, size: int | None) -> Array:
    """Read a vector of `size` finite numbers; `ProblemError` if it is none."""
    vector = _floats(name, given)
    if vector.ndim != 1 or (size is not None and vector.size != size):
        expected = "one-dimensional" if size is None else f"of shape ({size},)"
        raise ProblemError(f"{name} has shape {vector.shape}: it must be {expected}")
    if np.count_nonzero(np.isfinite(vector)) < vector.size:
        raise ProblemError(f"{name}[{int(np.argmin(np.isfinite(vector)))}] is not finite: give finite numbers")
    return vector


def _floats(name: str, given: Any) -> Array:
    """A new array of numbers."""
    if type(given) is np.ndarray and given.dtype == np.float64:
        return given.copy()
    dense = given.toarray() if sparse.issparse(given) else given  # pyright: ignore[reportAttributeAccessIssue]
    return real_array(dense, name, finite=False).copy()


def _matrix(name: str, given: Any, columns: int) -> Array:
    """A finite dense matrix with the given number of columns, from a dense or a sparse one."""
    matrix = _floats(name, given)
    if matrix.ndim != 2 or matrix.shape[1] != columns:
        raise ProblemError(f"{name} has shape {matrix.shape}: it needs {columns} columns, one for each entry of c")
    if np.count_nonzero(np.isfinite(matrix)) < matrix.size:
        raise ProblemError(f"{name} has entries that are not finite: give finite numbers")
    return matrix


def _bound(name: str, given: ArrayLike | None, size: int, absent: float) -> Array:
    """A vector of bounds."""
    if given is None:
        return np.full(size, absent)
    bound = _floats(name, given)
    if bound.shape != (size,):
        raise ProblemError(f"{name} has shape {bound.shape}: it must be ({size},), with {absent} where there is none")
    return bound


def _complain(lower: Array, upper: Array, n: int) -> None:
    """Raise `ProblemError` for a bound that is NaN or infinite in the wrong direction, and for crossed bounds."""
    for low, high, part in (("bl", "bu", slice(n)), ("cl", "cu", slice(n, None))):
        for name, bound, absent in ((low, lower[part], -np.inf), (high, upper[part], np.inf)):
            wrong = np.isnan(bound) | (bound == -absent)
            if wrong.any():
                i = int(np.argmax(wrong))
                raise ProblemError(f"{name}[{i}] is {bound[i]}: give a number, or {absent} for no bound")
        crossed = lower[part] > upper[part]
        if crossed.any():
            i = int(np.argmax(crossed))
            raise ProblemError(
                f"{low}[{i}] = {lower[part][i]} exceeds {high}[{i}] = {upper[part][i]}: no x satisfies both; change one"
            )
