"""Dense factorizations of the local solver, called directly from LAPACK and BLAS."""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import get_blas_funcs, get_lapack_funcs

from bemcontact.arrays import Array, BoolArray

Inertia = tuple[int, int, int]

geqp3, orgqr, pstrf, potrf, posv = get_lapack_funcs(("geqp3", "orgqr", "pstrf", "potrf", "posv"), dtype=np.float64)
SWEEPS = 4
BLOCK = 32
"""Block size of LAPACK, in columns."""
dot: Any = get_blas_funcs("dot", dtype=np.float64)  # of small vectors, in a third of the time of NumPy's
ger: Any = get_blas_funcs("ger", dtype=np.float64)
symv: Any = get_blas_funcs("symv", dtype=np.float64)
trsm: Any = get_blas_funcs("trsm", dtype=np.float64)


def add_rank_one(matrix: Array, factor: float, column: Array, row: Array) -> None:
    """Add factor column rowᵀ to a column-major matrix in place."""
    if row.size:
        ger(factor, column, row, 1, 1, matrix, 0, 0, 1)  # by position, which is twice as fast as by name


def over_triangle(columns: Array, R: Array, *, transposed: bool) -> Array:
    """Columns times R⁻¹ or R⁻ᵀ of an upper triangle R of full rank; entries below its diagonal are not read."""
    return trsm(1.0, R, columns, 1, 0, int(transposed)) if R.shape[0] else columns


def pivoted_cholesky(matrix: Array, zero: float) -> tuple[Array, NDArray[np.intp], int]:
    """Pivoted Cholesky factor R, the order of rows and columns, and the rank; RᵀR is the leading part in this order.

    R is the upper triangle of the first result, whose other entries have no meaning.
    """
    factor, pivots, rank, _ = pstrf(matrix, tol=zero)
    # LAPACK does not hold the first pivot against the tolerance
    rank = int(rank) if matrix.diagonal().max() > zero else 0
    return factor[:rank, :rank], pivots - 1, rank


def is_definite(matrix: Array) -> bool:
    """Whether a symmetric matrix has a Cholesky factor."""
    return matrix.shape[0] == 0 or potrf(matrix)[1] == 0


def row_lengths(rows: Array) -> Array:
    """Euclidean length of each row, 1 for a row of zeros."""
    length = np.sqrt(np.vecdot(rows, rows))
    length[length == 0.0] = 1.0
    return length


def unit_rows(rows: Array) -> tuple[Array, Array]:
    """Rows divided by their lengths, and the lengths; rows of zeros are unchanged."""
    length = row_lengths(rows)
    return rows / length[:, None], length


def unit_sizes(size: Array) -> Array:
    """Factors of rows and columns by which the largest entry of each row of a symmetric matrix is about one."""
    units = np.ones(size.shape[0])
    for _ in range(SWEEPS if units.size else 0):
        rows = units * np.maximum.reduce(size * units, axis=1)
        units = units / np.sqrt(np.where(rows > 0.0, rows, 1.0))
    return units


def inertia(matrix: Array, noise: Array | float = 0.0) -> Inertia:
    """Numbers of positive, zero and negative eigenvalues; entries up to `noise` count as zero.

    The matrix is first scaled to rows of size one. This changes no inertia (Sylvester), and makes rounding measurable.
    """
    matrix = np.where(np.abs(matrix) <= noise, 0.0, matrix)
    units = unit_sizes(np.abs(matrix))
    eigenvalues = np.linalg.eigvalsh(units[:, None] * matrix * units)
    zero = 100.0 * max(10, matrix.shape[0]) * np.finfo(float).eps
    negative, positive = int(np.sum(eigenvalues < -zero)), int(np.sum(eigenvalues > zero))
    return positive, matrix.shape[0] - positive - negative, negative


def orthogonal(rows: Array, tolerance: float, *, complete: bool = True) -> tuple[Array, Array, Array, NDArray[np.intp]]:
    """Pivoted QR of rowsᵀ: bases of the range and of the null space, the triangle, and the independent rows.

    The entries below the triangle have no meaning. The basis of the null space has no columns unless it is `complete`.
    """
    m, n = rows.shape
    if m == 0 or n == 0:
        return np.zeros((n, 0)), np.eye(n), np.zeros((0, 0)), np.zeros(0, dtype=np.intp)
    reflectors, pivots, tau, *_ = geqp3(rows.T, lwork=2 * m + BLOCK * (m + 1))
    rank = int(np.count_nonzero(np.abs(reflectors.diagonal()) > tolerance))
    Q = np.zeros((n, n if complete else rank), order="F")
    given = min(m, Q.shape[1])
    Q[:, :given] = reflectors[:, :given]
    Q = orgqr(Q, tau[:given], lwork=BLOCK * n)[0]
    return Q[:, :rank], Q[:, rank:], reflectors[:rank, :rank], pivots[:rank].astype(np.intp) - 1


def independent_rows(rows: Array, first: BoolArray, tolerance: float) -> NDArray[np.intp]:
    """Indices of independent rows, of rows of length one; those marked in `first` (m,) are preferred."""
    preferred, others = first.nonzero()[0], (~first).nonzero()[0]
    span, _, _, kept = orthogonal(rows[preferred], tolerance, complete=False)
    outside = rows[others] - (rows[others] @ span) @ span.T
    return np.concatenate([preferred[kept], others[orthogonal(outside, tolerance, complete=False)[3]]])
