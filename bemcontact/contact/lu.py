"""LU factorization with partial pivoting, an estimate of the condition, and one step of iterative refinement."""

from collections.abc import Callable
from typing import Any, Self

from scipy.linalg import get_blas_funcs, get_lapack_funcs

from bemcontact.arrays import Array, IntArray
from bemcontact.cached import cached_property
from bemcontact.frozen import frozen
from bemcontact.threads import one_thread

lange, getrf, gecon, getrs, laswp = get_lapack_funcs(("lange", "getrf", "gecon", "getrs", "laswp"), dtype=float)
trsm: Any = get_blas_funcs("trsm", dtype=float)


@frozen
class LU:
    """Factors of a square matrix A = P⁻¹ L U.

    Parameters
    ----------
    factors : (m, m) L and U in one array
    pivots : (m,) row exchanges
    norm : of A, the 1-norm
    singular : whether a pivot is zero
    """

    factors: Array
    pivots: IntArray
    norm: float
    singular: bool

    @classmethod
    def of(cls, matrix: Array, *, overwrite: bool = False) -> Self:
        """Factorize a matrix (m, m); `overwrite` reuses the memory of one in Fortran order."""
        norm = lange("1", matrix)
        with one_thread.lifted(len(matrix) ** 3 / 3):
            factors, pivots, singular = getrf(matrix, overwrite_a=overwrite)
        return cls(factors=factors, pivots=pivots, norm=norm, singular=bool(singular))

    @cached_property
    def reciprocal_condition(self) -> float:
        """Estimate in the 1-norm; zero if a pivot is zero."""
        return 0.0 if self.singular else float(gecon(self.factors, self.norm)[0])

    def solve(self, right: Array, residual: Callable[[Array], Array]) -> Array:
        """Solve for right sides (m,) or (m, s), and refine once.

        `residual` gives the right sides less matrix times its argument; its result may be overwritten.
        """
        x = getrs(self.factors, self.pivots, right)[0]
        return x + getrs(self.factors, self.pivots, residual(x), overwrite_b=True)[0]

    def forward(self, right: Array) -> Array:
        """L⁻¹P times right sides (m, s)."""
        exchanged = laswp(right, self.pivots)
        with one_thread.lifted(exchanged.size * len(exchanged) / 2):
            return trsm(1.0, self.factors, exchanged, lower=True, diag=True, overwrite_b=True)

    def backward(self, reduced: Array, last: int | None = None) -> Array:
        """The last rows (q,) or (q, s) of U⁻¹ times reduced right sides (m,) or (m, s); all rows if None."""
        first = 0 if last is None else len(self.factors) - last
        own = reduced[first:] if reduced.ndim == 2 else reduced[first:, None]
        with one_thread.lifted(own.size * len(own) / 2):
            return trsm(1.0, self.factors[first:, first:], own).reshape(-1, *reduced.shape[1:])
