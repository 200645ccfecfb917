"""Equilibration: the program is scaled so that the units of the data have no influence on the answer."""

from dataclasses import dataclass
from math import frexp, ldexp, sqrt

import numpy as np

from bemcontact.arrays import Array
from bemcontact.formulations.local_solver.factorizations import posv, row_lengths
from bemcontact.formulations.local_solver.statement import EPS, Statement, largest

RUIZ_SWEEPS = 4
OF_OBJECTIVE, OF_BOUNDS, UNDECIDED = 1e-3, 1e-6, 1e-11
"""Weights in the least-squares problem: of H and c, of the bounds, and of the factors themselves. A has weight 1."""
BITS = 1000.0
"""The largest binary logarithm of a factor."""
LEAST = 2.0**-200
"""The smallest factor of a variable."""


@dataclass(frozen=True, kw_only=True)
class Scales:
    """Factors of a scaling: x = variables * (scaled x), scaled A = rows * A * variables, scaled H = objective * H."""

    variables: Array
    rows: Array
    objective: float

    def multipliers(self, scaled: Array) -> Array:
        """Multipliers of the constraints in the units of x and A; the objective remains scaled."""
        return scaled * np.concatenate([1.0 / self.variables, self.rows])


def unscaled(statement: Statement) -> tuple[Statement, Scales]:
    """Return the statement unchanged, with factors of one."""
    m, n = statement.A.shape
    return statement, Scales(variables=np.ones(n), rows=np.ones(m), objective=1.0)


def equilibrate(statement: Statement) -> tuple[Statement, Scales]:
    """Scale the rows and columns of A to size one, and the largest entry of H and c to one.

    The scale of a column of zeros in A comes from H.
    All factors are powers of two, so that no digit of the data changes.
    """
    n = statement.c.size
    factors = _ruiz(statement, natural_factors(statement))
    factors[:n] = factors[:n].clip(LEAST, 1.0 / LEAST)  # a factor of H is a product of two of them
    factors = _power_of_two(factors)
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


def natural_factors(statement: Statement) -> Array:
    """Factors of columns and rows (n + m,) that minimize the sum of squares of the logarithms of all entries.

    The method is that of Curtis and Reid, J. Inst. Math. Appl. 10 (1972) 118-124. The entries of A have the largest
    weight. Where they do not determine a factor, H and c do, and then the bounds. If the units of a row, a variable or
    the objective change, the factors change with them. So the scaled data do not depend on the units of the data.

    With s² the factor of the objective, z = (s D, E/s, s) multiplies rows and columns of [[H, Aᵀ, c], [A, 0, b],
    [c, b, 0]] alike, b the bounds of the rows; those of the variables are multiplied by s/(s D).
    """
    n, bound = statement.c.size, _bounds(statement)
    sizes, weights = _entries(statement, bound[n:])
    logarithms = np.log2(sizes, out=np.zeros(sizes.shape), where=weights > 0.0)
    right = -(weights * logarithms).sum(axis=1)
    squares = weights
    diagonal = squares.reshape(-1)[:: len(squares) + 1]
    diagonal += weights.sum(axis=1) + UNDECIDED
    given = bound[:n].nonzero()[0]
    if given.size:
        size = OF_BOUNDS * np.log2(bound[given])
        diagonal[given] += OF_BOUNDS
        squares[given, -1] -= OF_BOUNDS
        squares[-1, given] -= OF_BOUNDS
        squares[-1, -1] += OF_BOUNDS * given.size
        right[given] += size
        right[-1] -= size.sum()
    z = posv(squares, right)[1]
    z[:n] -= z[-1]
    z[n:-1] += z[-1]
    return np.exp2(z[:-1].clip(-BITS, BITS))


def _bounds(statement: Statement) -> Array:
    """Size of the smaller nonzero bound of each constraint; 0 where there is none (n + m,)."""
    bounds = np.abs([statement.lower, statement.upper])
    bounds[bounds == 0.0] = np.inf
    smaller = bounds.min(axis=0)
    smaller[smaller == np.inf] = 0.0
    return smaller


def _entries(statement: Statement, bound: Array) -> tuple[Array, Array]:
    """Sizes of the entries of [[H, Aᵀ, c], [A, 0, b], [c, b, 0]], and their weights; zeros and rounding have weight 0.

    An entry counts as rounding if it is small beside the largest entry of its row and of its column.
    """
    (m, n), (H, c, A) = statement.A.shape, statement.absolute
    sizes = np.zeros((n + m + 1, n + m + 1))
    sizes[:n, :n], sizes[n:-1, :n], sizes[-1, :n], sizes[-1, n:-1] = H, A, c, bound
    main = sizes[:-1, :n]
    least = np.minimum(main.max(axis=1, keepdims=True), main.max(axis=0, keepdims=True))
    weights = np.zeros(sizes.shape)
    weights[:-1, :n] = main > 4.0 * EPS * least
    weights[:n] *= OF_OBJECTIVE
    weights[-1, :n] = OF_OBJECTIVE * (c > 0.0)
    weights[-1, n:-1] = OF_BOUNDS * (bound > 0.0)
    for square in (sizes, weights):
        square[:n, n:] = square[n:, :n].T
        square[n:-1, -1] = square[-1, n:-1]
    return sizes, weights


def _ruiz(statement: Statement, factors: Array) -> Array:
    """Improve the factors so that the largest entry of each row and column is about one (Ruiz, RAL-TR-2001-034)."""
    H, _, A = statement.absolute
    n = A.shape[1]
    D, E = factors[:n], factors[n:]
    linear = E[:, None] * A * D
    columns = np.maximum.reduce(linear, axis=0, initial=0.0)
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
    """Factor of all variables by which the largest bound is about one if all are smaller, as tolerances assume."""
    factors = np.concatenate([1.0 / D, E])
    sizes = np.abs(np.concatenate([factors * statement.lower, factors * statement.upper]))
    size = largest(sizes[sizes < np.inf])
    return _near_power(size) if 0.0 < size < 1.0 else 1.0


def _near_power(factor: float) -> float:
    """The nearest power of two within the limits of double precision."""
    return ldexp(1.0, min(max(frexp(factor * sqrt(0.5))[1], -1000), 1000))


def _power_of_two(factors: Array) -> Array:
    """The nearest power of two of each factor."""
    return np.ldexp(1.0, np.frexp(factors * sqrt(0.5))[1])
