"""The quadratic program as given, checked on entry, and its equilibration."""

from dataclasses import dataclass
from functools import cached_property
from math import frexp, ldexp, sqrt
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import sparse

from bemcontact.arrays import Array, BoolArray, real_array
from bemcontact.errors import ProblemError
from bemcontact.formulations.local_solver.factorizations import row_lengths

Sides = NDArray[np.int8]

RUIZ_SWEEPS = 4
LEAST = 2.0**-200
"""The smallest factor."""
INFINITE = 1e20
"""A bound of this size or more is none, as in most solvers and their files."""
EPS = float(np.finfo(float).eps)


def largest(numbers: Array) -> float:
    """The largest absolute value, 0 if there is none."""
    sizes = np.abs(numbers)
    return sizes.item(sizes.argmax()) if sizes.size else 0.0


@dataclass(frozen=True, kw_only=True)
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
        """|H|, |c|, |A|, which rounding is measured by."""
        return np.abs(self.H), np.abs(self.c), np.abs(self.A)

    @property
    def row_sum(self) -> float:
        """The largest sum of a row of |H|."""
        return largest(self.absolute[0].dot(np.ones(self.c.size)))

    @cached_property
    def bound_size(self) -> Array:
        """Size of the smaller bound of each constraint, 0 where it has none (n + m,)."""
        size = np.minimum(np.abs(self.lower), np.abs(self.upper))
        size[size == np.inf] = 0.0
        return size

    @cached_property
    def equality(self) -> BoolArray:
        """Which constraints have one bound for both sides, or two that rounding does not tell apart (n + m,)."""
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

    def transposed(self, y: Array) -> Array:
        """[I; A]ᵀ y."""
        n = self.c.size
        return y[:n] + y[n:].dot(self.A)

    def normal(self, constraint: int) -> Array:
        """Gradient of one constraint."""
        n = self.c.size
        if constraint >= n:
            return self.A[constraint - n]
        unit = np.zeros(n)
        unit[constraint] = 1.0
        return unit

    def sides_reached(self, values: Array, slack: Array) -> Sides:
        """Which bound each constraint is at, within its slack; the nearer of two; 2 for an equality."""
        lower, upper = np.abs(values - self.lower), np.abs(values - self.upper)
        sides = np.ones(values.size, dtype=np.int8)
        sides[lower <= upper] = -1
        sides[self.equality] = 2
        sides[np.minimum(lower, upper) > slack] = 0
        return sides

    def rounding(self, d: Array) -> float:
        """The rounding in dᵀHd, from its terms and from the components of d."""
        size = np.abs(d)
        product = self.absolute[0].dot(size)
        return 10.0 * sqrt(d.size) * EPS * float(size.dot(product) + largest(size) * largest(product * (size > 0.0)))

    def violation(self, values: Array) -> Array:
        """How far each constraint is outside its bounds; 0 inside."""
        return np.maximum(np.maximum(self.lower - values, values - self.upper), 0.0)


@dataclass(frozen=True, kw_only=True)
class Scales:
    """x = variables * scaled x; scaled rows = rows * A * variables; scaled objective = objective * objective."""

    variables: Array
    rows: Array
    objective: float

    def multipliers(self, scaled: Array) -> Array:
        """Multipliers of the constraints in the units of the data (objective not rescaled)."""
        return scaled * np.concatenate([1.0 / self.variables, self.rows])


def unscaled(statement: Statement) -> tuple[Statement, Scales]:
    """The statement as it is, all factors one."""
    m, n = statement.A.shape
    return statement, Scales(variables=np.ones(n), rows=np.ones(m), objective=1.0)


def equilibrate(statement: Statement) -> tuple[Statement, Scales]:
    """The statement with rows and columns of A of size one, columns outside A by H, and the largest of H and c one.

    All factors are powers of two, so that no digit of the data changes.
    """
    n = statement.c.size
    factors = _power_of_two(_ruiz(np.abs(statement.H), np.abs(statement.A)))
    D, E = factors[:n], factors[n:]
    D *= _smaller_unit(statement, D, E)
    H, c, A = D[:, None] * statement.H * D, D * statement.c, E[:, None] * statement.A * D
    last = _power_of_two(1.0 / row_lengths(A))
    E *= last
    A *= last[:, None]
    unit = _near_power(1.0 / (max(largest(H), largest(c)) or 1.0))
    H *= unit
    c *= unit
    factors = np.concatenate([1.0 / D, E])
    scaled = Statement(H=H, c=c, A=A, lower=factors * statement.lower, upper=factors * statement.upper)
    return scaled, Scales(variables=D, rows=E, objective=unit)


def _ruiz(H: Array, A: Array) -> Array:
    """Factors of columns and rows by which the largest entry of each comes to one, nearly (Ruiz, RAL-TR-2001-034)."""
    m, n = A.shape
    factors, linear = np.ones(n + m), A
    D, E = factors[:n], factors[n:]
    columns = np.maximum.reduce(A, axis=0, initial=0.0)
    outside = columns == 0.0
    mixed = np.count_nonzero(outside) > 0
    for _ in range(RUIZ_SWEEPS):
        if mixed:
            sizes = D * np.maximum.reduce(H * D, axis=1)
            columns = np.where(outside, sizes / (largest(sizes) or 1.0), columns)
        sizes = np.concatenate([columns, np.maximum.reduce(linear, axis=1)])
        sizes[sizes == 0.0] = 1.0
        factors /= np.sqrt(sizes)
        if sizes[sizes.argmax()] < 2.0 and sizes[sizes.argmin()] > 0.5:  # another sweep would change little
            break
        linear = E[:, None] * A * D
        columns = np.maximum.reduce(linear, axis=0, initial=0.0)
    return factors


def _smaller_unit(statement: Statement, D: Array, E: Array) -> float:
    """A unit of length that makes the largest bound about one, if all are smaller: tolerances are relative to one."""
    factors = np.concatenate([1.0 / D, E])
    sizes = np.abs(np.concatenate([factors * statement.lower, factors * statement.upper]))
    size = largest(sizes[sizes < np.inf])
    return _near_power(size) if 0.0 < size < 1.0 else 1.0


def _near_power(factor: float) -> float:
    """The nearest power of two; within the limits of double precision."""
    return ldexp(1.0, min(max(frexp(factor * sqrt(0.5))[1], -1000), 1000))


def _power_of_two(factors: Array) -> Array:
    """The nearest power of two of each factor."""
    return np.ldexp(1.0, np.frexp(factors.clip(LEAST, 1.0 / LEAST) * sqrt(0.5))[1])


def read(
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
    if np.count_nonzero((lower < np.inf) & (upper > -np.inf) & (lower <= upper)) < lower.size:
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
    return real_array(given.toarray() if sparse.issparse(given) else given, name, finite=False).copy()


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
    """Refuse a bound that is not a number, an infinite one in the wrong direction, and crossed bounds."""
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
