"""`equilibration.scaled_data` as machine code by numba (the extra ``fast``): loops in place of many small arrays.

Machine code that was kept knows the functions of this file, and the constants of others: a change of those needs a
change here.
"""

import math

import numpy as np

from bemcontact.arrays import Array
from bemcontact.compilation import compiled
from bemcontact.formulations.local_solver.equilibration import (
    OF_BOUNDS,
    OF_OBJECTIVE,
    OF_ROW,
    OF_VARIABLE,
    SWEEPS,
    UNDECIDED,
    WIDE,
    ScaledData,
)
from bemcontact.formulations.local_solver.statement import EPS

LEAST = 2.0**-1000
"""Least factor of the objective and of all variables; its inverse is the largest one."""
ROOT_OF_HALF = math.sqrt(0.5)
ABSENT = -1e300
"""In place of the logarithm of an entry that is not there."""


@compiled(inner=True, reorder=True)
def _dot(a: Array, b: Array) -> float:
    """a·b."""
    product = 0.0
    for i in range(a.size):
        product += a[i] * b[i]
    return product


@compiled(inner=True)
def _logarithms(matrix: Array, least: float, largest: float) -> tuple[Array, float, float]:
    """Binary logarithms of the sizes of all entries, and the least and the largest so far."""
    logarithms = np.empty(matrix.shape)
    for i in range(matrix.shape[0]):
        for j in range(matrix.shape[1]):
            if matrix[i, j] == 0.0:
                logarithms[i, j] = ABSENT
            else:
                logarithm = math.log2(abs(matrix[i, j]))
                logarithms[i, j], least, largest = logarithm, min(least, logarithm), max(largest, logarithm)
    return logarithms, least, largest


@compiled(inner=True)
def _leave_out_rounding(matrix: Array, logarithms: Array) -> None:
    """Leave out entries that are small beside the largest ones of their row and of their column."""
    m, n = matrix.shape
    rows, columns = np.zeros(m), np.zeros(n)
    for i in range(m):
        for j in range(n):
            rows[i], columns[j] = max(rows[i], abs(matrix[i, j])), max(columns[j], abs(matrix[i, j]))
    for i in range(m):
        for j in range(n):
            if not abs(matrix[i, j]) > 4.0 * EPS * min(rows[i], columns[j]):
                logarithms[i, j] = ABSENT


@compiled(inner=True)
def _smaller_bound(lower: float, upper: float) -> float:
    """Binary logarithm of the size of the smaller nonzero bound."""
    smaller = math.inf
    for bound in (abs(lower), abs(upper)):
        if bound > 0.0:
            smaller = min(smaller, bound)
    return math.log2(smaller) if smaller < math.inf else ABSENT


@compiled(inner=True)
def _solve(matrix: Array, right: Array) -> None:
    """Solve a definite system in place by Cholesky's method; the lower triangle of the matrix is used up."""
    n = right.size
    for i in range(n):
        for j in range(i):
            matrix[i, j] = (matrix[i, j] - _dot(matrix[i, :j], matrix[j, :j])) / matrix[j, j]
        row = matrix[i, :i]
        matrix[i, i] = math.sqrt(matrix[i, i] - _dot(row, row))
        right[i] = (right[i] - _dot(row, right[:i])) / matrix[i, i]
    for i in range(n - 1, -1, -1):
        right[i] /= matrix[i, i]
        for j in range(i):
            right[j] -= right[i] * matrix[i, j]


@compiled()
def natural_factors_by_loops(H: Array, c: Array, A: Array, bounds: Array) -> Array:
    """As `equilibration.natural_factors`."""
    m, n = A.shape
    of_hessian, least, largest = _logarithms(H, math.inf, -math.inf)
    of_linear, least, largest = _logarithms(c.reshape(1, n), least, largest)
    of_rows, least, largest = _logarithms(A, least, largest)
    if min(least, 0.0) < max(largest, 0.0) - WIDE:
        _leave_out_rounding(H, of_hessian)
        _leave_out_rounding(A, of_rows)
    factors, column, reduced = np.zeros(n + m), np.zeros(n), np.zeros((n, n))
    d, e = factors[:n], factors[n:]
    whole, of_whole = 0.0, 0.0
    for i in range(n + 1):
        logarithms = of_hessian[i] if i < n else of_linear[0]
        for j in range(n):
            if logarithms[j] != ABSENT:
                column[j] += OF_OBJECTIVE
                d[j] -= OF_OBJECTIVE * logarithms[j]
                if i < n:
                    reduced[i, j] = OF_OBJECTIVE
                else:
                    whole += OF_OBJECTIVE
                    of_whole += OF_OBJECTIVE * logarithms[j]
    for j in range(n):
        whole += column[j]
        of_whole -= d[j]
    whole, of_whole, top = 0.5 * whole + UNDECIDED, 0.5 * of_whole, 0.0
    diagonal = column.copy()
    for j in range(n):
        share = column[j] / whole
        d[j] += of_whole * share
        for i in range(j, n):
            reduced[i, j] -= column[i] * share
        logarithm = _smaller_bound(bounds[0, j], bounds[1, j])
        if logarithm != ABSENT:
            diagonal[j] += OF_BOUNDS
            d[j] += OF_BOUNDS * logarithm
    weights, places = np.empty(m), np.empty(n, np.intp)
    for i in range(m):
        weight, right, count = UNDECIDED, 0.0, 0
        logarithm = _smaller_bound(bounds[0, n + i], bounds[1, n + i])
        if logarithm != ABSENT:
            weight, right = weight + OF_BOUNDS, OF_BOUNDS * logarithm
        for j in range(n):
            if of_rows[i, j] != ABSENT:
                places[count], count = j, count + 1
                right += of_rows[i, j]
        weight += count
        weights[i], e[i] = weight, right
        for one in range(count):
            j = places[one]
            diagonal[j] += 1.0
            d[j] += right / weight - of_rows[i, j]
            for other in range(one + 1):
                reduced[j, places[other]] -= 1.0 / weight
    for j in range(n):
        top = max(top, diagonal[j])
    for j in range(n):
        reduced[j, j] += diagonal[j] + UNDECIDED * (1.0 + top)
    _solve(reduced, d)
    for j in range(n):
        d[j] = min(max(d[j], -OF_VARIABLE), OF_VARIABLE)
    for i in range(m):
        for j in range(n):
            if of_rows[i, j] != ABSENT:
                e[i] += d[j]
        e[i] = min(max(-e[i] / weights[i], -OF_ROW), OF_ROW)
    for i in range(n + m):
        factors[i] = 2.0 ** factors[i]
    return factors


@compiled(inner=True)
def _balance(A: Array, D: Array, E: Array) -> None:
    """As `equilibration._balanced`."""
    m, n = A.shape
    sizes, rows, columns = np.empty((m, n)), np.empty(m), np.empty(n)
    for i in range(m):
        for j in range(n):
            sizes[i, j] = abs(A[i, j]) * E[i] * D[j]
    for _ in range(SWEEPS if A.size else 0):
        rows[:], columns[:] = 0.0, 0.0
        for i in range(m):
            for j in range(n):
                rows[i], columns[j] = max(rows[i], sizes[i, j]), max(columns[j], sizes[i, j])
        for i in range(m):
            rows[i] = math.sqrt(rows[i]) if rows[i] > 0.0 else 1.0
            E[i] /= rows[i]
        for j in range(n):
            columns[j] = math.sqrt(columns[j]) if columns[j] > 0.0 else 1.0
            D[j] /= columns[j]
        for i in range(m):
            for j in range(n):
                sizes[i, j] = sizes[i, j] / rows[i] / columns[j]


@compiled(inner=True)
def _near_power(factor: float) -> float:
    """The nearest power of two."""
    return math.ldexp(1.0, math.frexp(factor * ROOT_OF_HALF)[1])


@compiled(inner=True)
def _scaled(matrix: Array, rows: Array, columns: Array) -> tuple[Array, float]:
    """A matrix with factors of rows and columns, and the size of its largest entry, or NaN if one is no number."""
    scaled, largest, rest = np.empty(matrix.shape), 0.0, 0.0
    for i in range(matrix.shape[0]):
        for j in range(matrix.shape[1]):
            entry = rows[i] * matrix[i, j] * columns[j]
            scaled[i, j], largest = entry, max(largest, abs(entry))
            rest += 0.0 * entry
    return scaled, largest + rest


@compiled()
def scaled_data_by_loops(H: Array, c: Array, A: Array, bounds: Array) -> ScaledData:
    """As `equilibration.scaled_data`."""
    m, n = A.shape
    factors = natural_factors_by_loops(H, c, A, bounds)
    D, E, of_bounds = factors[:n], factors[n:], np.empty(n + m)
    _balance(A, D, E)
    for j in range(n):
        D[j] = _near_power(D[j])
        of_bounds[j] = 1.0 / D[j]
    for i in range(m):
        square = 0.0
        for j in range(n):
            square += (E[i] * A[i, j] * D[j]) ** 2
        E[i] = of_bounds[n + i] = _near_power(E[i] / math.sqrt(square) if square > 0.0 else E[i])
    scaled_rows, size_of_rows = _scaled(A, E, D)
    size, smaller, representable, greatest, least = 0.0, 1.0, True, 0.0, math.inf
    for i in range(n + m):
        greatest, least = max(greatest, of_bounds[i]), min(least, of_bounds[i])
        for side in range(2):
            bound = abs(of_bounds[i] * bounds[side, i])
            if bound < math.inf:
                size = max(size, bound)
            elif abs(bounds[side, i]) < math.inf:
                representable = False
    if 0.0 < size < 1.0:
        smaller = min(_near_power(max(size, math.ldexp(greatest, -1000), LEAST)), 1.0)
    for j in range(n):
        D[j] *= smaller
    for i in range(m):
        E[i] /= smaller
    ends, ones = np.empty((2, n + m)), np.ones(1)
    for i in range(n + m):
        for side in range(2):
            ends[side, i] = of_bounds[i] * bounds[side, i] / smaller
    hessian, size_of_hessian = _scaled(H, D, D)
    linear, size_of_linear = _scaled(c.reshape(1, n), ones, D)
    top = max(size_of_hessian, size_of_linear)
    unit = _near_power(min(max(1.0 / top if top > 0.0 else 1.0, LEAST), 1.0 / LEAST))
    for i in range(n):
        linear[0, i] *= unit
        for j in range(n):
            hessian[i, j] *= unit
    if not math.isfinite(size_of_hessian + size_of_linear + size_of_rows + greatest) or least == 0.0:
        representable = False
    return ScaledData(hessian, linear[0], scaled_rows, ends, D, E, unit, representable)
