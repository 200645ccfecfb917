"""Definiteness of S sym(DM) S on the equilibrium space, S diagonal; `certificate` says what follows from it."""

from typing import Self

import numpy as np
from scipy.linalg import get_lapack_funcs, solve_triangular

from bemcontact.arrays import Array, norm, row_norms, short_svd
from bemcontact.frozen import frozen

geqrf, ormqr, syevr, syevr_lwork = get_lapack_funcs(("geqrf", "ormqr", "syevr", "syevr_lwork"), dtype=float)
EPS = float(np.finfo(float).eps)
LEAST_COMPLIANCE = 1e-10
"""Fraction of ‖M‖∞ below which the compliance of a point may be what round-off leaves of zero."""

SURE = 1.0 + 1e-6
"""Factor of a bound by triangular factors: more than their round-off."""


@frozen
class Definiteness:
    """λ of S sym(DM) S on the equilibrium space, None if there is none, and what is left of it less round-off."""

    scales: Array
    reach: Array
    """Norms (n,) of the rows of an orthonormal basis of the space: zero where equilibrium fixes the pressure."""
    eigenvalue: float | None
    certain: float
    form: Array
    """S sym(DM) S on the space (m, m)."""
    space: Array
    """An orthonormal basis of the space (n, m)."""

    @property
    def definite(self) -> bool:
        """Whether λ is positive beyond round-off, so that each contact state is the only one."""
        return self.eigenvalue is None or self.certain > 0

    @classmethod
    def of(cls, D: Array, M: Array, ell: Array) -> Self:
        """Take D (n,) of largest entry one, M (n, n) of ‖M‖∞ = 1 and ℓ (n, k).

        S makes the diagonal one, except where a compliance is round-off or negative.
        """
        S, n = 1 / np.sqrt(D * np.maximum(M.diagonal(), LEAST_COMPLIANCE)), len(D)
        ell = S[:, None] * ell
        if ell.shape[1] >= n:
            none = np.zeros((n, 0))
            return cls(scales=S, reach=np.zeros(n), eigenvalue=None, certain=np.inf, form=none[:0], space=none)
        A, spread, reach = S[:, None] * (D[:, None] * M) * S, 1.0, np.ones(n)
        K, terms, Z = (A + A.T) / 2, np.abs(A), np.eye(n)
        largest = float((terms @ reach + reach @ terms).max())
        if k := ell.shape[1]:
            ell = ell / row_norms(ell.T)
            sizes, (reflectors, factors, *_) = short_svd(ell)[0], geqrf(ell)
            spread = float(sizes[0] / sizes[-1]) if sizes[-1] else np.inf
            Z, half = (_times_q(part, reflectors, factors)[:, k:] for part in (Z, K))
            K = _times_q(half.T, reflectors, factors)[:, k:]
            reach = np.minimum(row_norms(Z) + n * EPS * spread, 1.0)
        smallest = least_eigenvalue(K)
        round_off = n * EPS * spread * largest / 2
        return cls(scales=S, reach=reach, eigenvalue=smallest, certain=smallest - round_off, form=K, space=Z)

    def largest_change(self, s: Array, work: float = 0.0) -> float:
        """Change of a pressure, at most, by forces up to s (n,) and work w: max Sᵢ|Zᵢ|(|ZᵀSs|/λ + √(w/λ))."""
        part = min(norm(self.scales * s), self.reach @ (self.scales * s))
        return float((self.scales * self.reach).max(initial=0.0) * (part / self.certain + np.sqrt(work / self.certain)))

    def change_by_energy(self, s: Array, lost: Array) -> float:
        """As `largest_change` for forces s (n,) known but for `lost`: what they do in soft directions is small there.

        With K the form, x² = eᵀK e <= x √(sᵀK⁻¹s), and a component of e is at most x times the root of that of K⁻¹.
        """
        size, round_off = len(self.form), (self.eigenvalue or 0.0) - self.certain
        if not 2 * round_off < (self.eigenvalue or 0.0):
            return np.inf
        try:
            factor = np.linalg.cholesky(self.form - 2 * round_off * np.eye(size))
        except np.linalg.LinAlgError:
            return np.inf
        inverse = solve_triangular(factor, self.space.T, lower=True)
        reach = self.scales * np.linalg.norm(inverse, axis=0)
        x = np.linalg.norm(inverse @ (self.scales * s)) + reach @ lost
        return SURE * float(reach.max() * x)


def least_eigenvalue(matrix: Array) -> float:
    """The smallest eigenvalue of a symmetric matrix (m, m).

    It is what `scipy.linalg.eigvalsh` finds, without what this does around it, which takes longer in a small matrix.
    """
    if not np.isfinite(matrix).all():
        raise ValueError("the matrix must have finite entries")
    work, whole, _ = syevr_lwork(len(matrix), lower=1)
    found, *_, failed = syevr(matrix, compute_v=0, range="I", il=1, iu=1, lower=1, lwork=int(work), liwork=int(whole))
    if failed:
        raise np.linalg.LinAlgError("the smallest eigenvalue was not found")
    return float(found[0])


def _times_q(matrix: Array, reflectors: Array, factors: Array) -> Array:
    """A Q (n, n) by the k reflectors of a QR factorization, in k n² operations."""
    return ormqr("R", "N", reflectors, factors, matrix, len(matrix))[0]
