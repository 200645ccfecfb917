"""LU factorization with partial pivoting, an estimate of the condition, and one step of iterative refinement."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Self

from scipy.linalg import get_lapack_funcs

from bemcontact.arrays import Array, IntArray


@dataclass(frozen=True, kw_only=True, eq=False)
class LU:
    """Factors of a square matrix.

    Parameters
    ----------
    factors : (m, m) L and U in one array
    pivots : (m,) row exchanges
    reciprocal_condition : estimate in the 1-norm; zero if a pivot is zero
    """

    factors: Array
    pivots: IntArray
    reciprocal_condition: float

    @classmethod
    def of(cls, matrix: Array, *, overwrite: bool = False) -> Self:
        """Factorize a matrix (m, m); `overwrite` reuses the memory of one in Fortran order."""
        lange, getrf, gecon = get_lapack_funcs(("lange", "getrf", "gecon"), dtype=float)
        norm = lange("1", matrix)
        factors, pivots, singular = getrf(matrix, overwrite_a=overwrite)
        return cls(factors=factors, pivots=pivots, reciprocal_condition=0.0 if singular else gecon(factors, norm)[0])

    def solve(self, right: Array, residual: Callable[[Array], Array]) -> Array:
        """Solve for right sides (m,) or (m, s), and refine once.

        `residual` gives the right sides less matrix times its argument; its result may be overwritten.
        """
        (substitute,) = get_lapack_funcs(("getrs",), dtype=float)
        x = substitute(self.factors, self.pivots, right)[0]
        return x + substitute(self.factors, self.pivots, residual(x), overwrite_b=True)[0]
