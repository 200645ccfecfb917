"""Equilibration: the program is scaled so that the units of the data have no influence on the answer."""

from collections.abc import Callable
from math import frexp, isfinite, ldexp, sqrt
from typing import NamedTuple

import numpy as np

from bemcontact.arrays import Array
from bemcontact.errors import ProblemError
from bemcontact.formulations.local_solver.factorizations import posv, row_lengths
from bemcontact.formulations.local_solver.statement import EPS, Statement, largest
from bemcontact.frozen import frozen_value

SWEEPS = 4
"""Sweeps of Ruiz's method (RAL-TR-2001-034) after the natural factors."""
OF_OBJECTIVE, OF_BOUNDS, UNDECIDED = 1e-3, 1e-6, 1e-11
"""Weights in the least-squares problem: of H and c, of the bounds, and of the factors themselves. A has weight 1."""
OF_VARIABLE, OF_ROW = 200.0, 1000.0
"""Largest binary logarithms of the natural factors. A factor of H is a product of two factors of variables."""
LARGEST_UNSCALED = 1e150
"""Largest entry without scaling: sums of squares of larger ones are infinite."""
WIDE = 49.0
"""Range of binary logarithms below which no entry can be rounding."""


@frozen_value
class Scales:
    """Factors of a scaling: x = variables * (scaled x), scaled A = rows * A * variables, scaled H = objective * H."""

    variables: Array
    rows: Array
    objective: float

    def multipliers(self, scaled: Array) -> Array:
        """Multipliers of the constraints in the units of x and A; the objective remains scaled."""
        return scaled * np.concatenate([1.0 / self.variables, self.rows])


def unequilibrated(statement: Statement) -> tuple[Statement, Scales]:
    """Return the statement unchanged, with factors of one; `ProblemError` if squares of its entries are infinite."""
    m, n = statement.A.shape
    for name, entries in (("H", statement.H), ("c", statement.c), ("A", statement.A)):
        if (size := largest(entries)) > LARGEST_UNSCALED:
            raise ProblemError(
                f"{name} has an entry of size {size:.3g}, and squares of entries above {LARGEST_UNSCALED:g} cannot be "
                "computed: leave out scale=False, or choose other units"
            )
    return statement, Scales(variables=np.ones(n), rows=np.ones(m), objective=1.0)


class ScaledData(NamedTuple):
    """Data of a scaled `Statement`, with the factors of variables (n,), of rows (m,) and of the objective."""

    H: Array
    c: Array
    A: Array
    bounds: Array
    variables: Array
    rows: Array
    objective: float
    representable: bool


Scaling = Callable[[Array, Array, Array, Array], ScaledData]
"""A function with the parameters of `scaled_data`."""


def scaled_data(H: Array, c: Array, A: Array, bounds: Array) -> ScaledData:
    """Scale as `equilibrate` says, from H, c, A and bounds (2, n + m); data may come out that no number represents."""
    n, present = c.size, np.count_nonzero(np.isfinite(bounds))
    factors = natural_factors(H, c, A, bounds)
    if A.size:
        factors = _balanced(A, factors)
    D, E = _power_of_two(factors[:n]), factors[n:]
    if E.size:
        E = _power_of_two(E / row_lengths(E[:, None] * A * D))
        A = E[:, None] * A * D
    of_bounds = np.concatenate([1.0 / D, E])
    bounds = of_bounds * bounds
    greatest, least = of_bounds.item(of_bounds.argmax()), of_bounds.item(of_bounds.argmin())
    smaller = _smaller_unit(bounds, greatest)
    if smaller < 1.0:
        D, E, bounds = smaller * D, E / smaller, bounds / smaller
    H, c = D[:, None] * H * D, D * c
    sizes = largest(H), largest(c), largest(A)
    unit = _near_power(1.0 / (max(sizes[:2]) or 1.0))
    representable = isfinite(sum(sizes) + greatest) and least > 0.0 and np.count_nonzero(np.isfinite(bounds)) == present
    return ScaledData(H * unit, c * unit, A, bounds, D, E, unit, representable)


@np.errstate(over="ignore", divide="ignore", invalid="ignore")  # what overflows is refused at the end
def equilibrate(statement: Statement, scaling: Scaling = scaled_data) -> tuple[Statement, Scales]:
    """Scale by natural factors, then columns and rows of A to size one, and the largest entry of H and c to one.

    If all bounds are smaller than one, the unit of all variables is made smaller, as absolute tolerances assume.
    All factors are powers of two, so that no digit of the data changes. `ProblemError` if entries are so far apart that
    no factors bring them together.
    """
    data = scaling(statement.H, statement.c, statement.A, np.array([statement.lower, statement.upper]))
    if not data.representable:
        raise ProblemError(
            "the sizes of entries and bounds are too far apart for double precision; choose other units, or write 0 "
            "for what is round-off"
        )
    scaled = Statement(H=data.H, c=data.c, A=data.A, lower=data.bounds[0], upper=data.bounds[1])
    return scaled, Scales(variables=data.variables, rows=data.rows, objective=data.objective)


def _balanced(A: Array, factors: Array) -> Array:
    """The factors of columns and rows (n + m,) by which the largest entry of each column and row of A is about one."""
    sizes, n = np.abs(A), A.shape[1]
    sizes *= factors[n:, None]
    sizes *= factors[:n]
    roots = np.empty(factors.size)
    of_columns, of_rows, across = roots[:n], roots[n:], roots[n:, None]
    for _ in range(SWEEPS):
        sizes.max(0, of_columns)
        sizes.max(1, of_rows)
        np.sqrt(roots, roots)
        if np.count_nonzero(roots) < roots.size:
            roots[roots == 0.0] = 1.0
        sizes /= across
        sizes /= of_columns
        factors = factors / roots
    return factors


def natural_factors(H: Array, c: Array, A: Array, bounds: Array) -> Array:
    """Factors of variables and rows (n + m,) that minimize the sum of squares of the logarithms of all scaled entries.

    The method is that of Curtis and Reid, J. Inst. Math. Appl. 10 (1972) 118-124. The entries of A have the largest
    weight. Where they do not determine a factor, H and c do, and then the bounds. If the units of a row, a variable or
    the objective change, the factors change with them. So the scaled data do not depend on the units of the data.

    With logarithms d of the factors of variables, e of rows and o of the objective, these are to be small:
    e_i + d_j + log|A_ij|, o + d_i + d_j + log|H_ij|, o + d_j + log|c_j|, log|b_j| - d_j and e_i + log|b_i|, b the
    bounds. The normal equations are diagonal in e. So e and o are eliminated, and d is left.
    """
    n = c.size
    present, logarithms = _entries(H, c, A)
    bounds_present, of_bounds = _logarithms(_smaller_bounds(bounds))
    objective, rows, of_rows = present[: n + 1], present[n + 1 :], logarithms[n + 1 :]
    units = np.ones(present.shape[0])
    weights, ones = OF_OBJECTIVE * units[: n + 1], units[:n]
    column, of_column = weights.dot(objective), weights.dot(logarithms[: n + 1])
    whole = 0.5 * float(column.dot(ones) + OF_OBJECTIVE * objective[n].dot(ones)) + UNDECIDED
    of_whole = 0.5 * float(of_column.dot(ones) + OF_OBJECTIVE * logarithms[n].dot(ones))
    share, diagonal = column / whole, column + OF_BOUNDS * bounds_present[:n]
    right = OF_BOUNDS * of_bounds[:n] - of_column + of_whole * share
    reduced = OF_OBJECTIVE * objective[:n]
    reduced -= column[:, None] * share
    e_diagonal = rows.dot(ones) + (OF_BOUNDS * bounds_present[n:] + UNDECIDED)
    e_right = of_rows.dot(ones) + OF_BOUNDS * of_bounds[n:]
    if rows.size:
        units = units[n + 1 :]
        diagonal += units.dot(rows)
        shares = rows / e_diagonal[:, None]
        reduced -= rows.T.dot(shares)
        right += e_right.dot(shares) - units.dot(of_rows)
    reduced.reshape(-1)[:: n + 1] += diagonal + UNDECIDED * (1.0 + largest(diagonal))
    d = np.minimum(np.maximum(posv(reduced, right)[1], -OF_VARIABLE), OF_VARIABLE)
    e = np.minimum(np.maximum((e_right + rows.dot(d)) / -e_diagonal, -OF_ROW), OF_ROW)
    return np.exp2(np.concatenate([d, e]))


def _entries(H: Array, c: Array, A: Array) -> tuple[Array, Array]:
    """Which entries of [H; c; A] are present (n + 1 + m, n), and their binary logarithms; zeros elsewhere."""
    # an entry of H or A counts as rounding if it is small beside the largest entries of its row and of its column
    n = c.size
    sizes = np.abs(np.concatenate([H, c[None], A]))
    present, logarithms = _logarithms(sizes)
    if logarithms.item(logarithms.argmax()) - logarithms.item(logarithms.argmin()) > WIDE:
        for matrix in (slice(n), slice(n + 1, None)):  # H by itself: its units are not those of A, and it is symmetric
            columns = np.maximum.reduce(sizes[matrix], axis=0, initial=0.0)
            rows = np.maximum.reduce(sizes[matrix], axis=1, initial=0.0)
            counts = sizes[matrix] > 4.0 * EPS * np.minimum(rows[:, None], columns)
            present[matrix] *= counts
            logarithms[matrix] *= counts
    return present, logarithms


def _logarithms(sizes: Array) -> tuple[Array, Array]:
    """One where there is a number, zero where there is a zero; and binary logarithms of the numbers."""
    present = np.sign(sizes)
    return present, np.log2(sizes + (1.0 - present))


def _smaller_bounds(bounds: Array) -> Array:
    """Size of the smaller nonzero bound of each constraint; zero where there is none (n + m,)."""
    sizes = np.abs(bounds)
    sizes[sizes == 0.0] = np.inf
    smaller = np.minimum(sizes[0], sizes[1])
    smaller[smaller == np.inf] = 0.0
    return smaller


def _smaller_unit(bounds: Array, factor: float) -> float:
    """Factor of all variables by which the largest bound is about one if all are smaller, as tolerances assume.

    The largest factor over it, of a row or of one over a variable, is still a number.
    """
    sizes = np.abs(bounds)
    size = largest(sizes[sizes < np.inf])
    return min(_near_power(max(size, ldexp(factor, -1000))), 1.0) if 0.0 < size < 1.0 else 1.0


def _near_power(factor: float) -> float:
    """The nearest power of two within the limits of double precision."""
    return ldexp(1.0, min(max(frexp(factor * sqrt(0.5))[1], -1000), 1000))


def _power_of_two(factors: Array) -> Array:
    """The nearest power of two of each factor."""
    return np.ldexp(1.0, np.frexp(factors * sqrt(0.5))[1])
