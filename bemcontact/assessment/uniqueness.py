"""Uniqueness of the contact state of slender bodies, whose sym(DM) has a few slightly negative eigenvalues.

Their eigenvectors spread over the whole length of a slender body. Contact does not: the gap keeps pressure away from
the other points, and the load bounds it. Together they exclude the negative directions.

Let K = sym(DM) on the equilibrium space have the eigenvalues -Λ <= λ₁ <= ... <= λₘ, and λ > 0 above them, with the
eigenvectors X (n, m) of the first m. Let y >= 0 be a pressure in equilibrium, s the part of Dδ that should not be, as
in `certificate`, p* a contact state, e = y - p* and t = |Xᵀe|. Let S be a set of points with y = 0 off it, g = Dδ - s
and r = p* off S. Then

    λ(|e|² - t²) + gᵀr <= Λt² + |e||s|.

The rows of X off S are small beside g: with σ the norm of the rows of X on S, and κ = max |Xᵢ|/gᵢ off S,

    t <= σ|e| + κ gᵀr,    |e| <= |s|/λ + ρt,    ρ = √(1 + Λ/λ).

All p* >= 0 carry the same load, and gᵀp* <= Λt² + |e||s|. Linear programs of k + 1 rows bound |xⱼᵀe| for these, and
so t by a number B. With σ' = σ + κ|s| the inequalities combine to

    t (1 - κΛB - σ'ρ) <= σ'|s|/λ.

If the bracket, b, is positive, then |e| <= |s|/λ (1 + ρσ'/b): s = 0 makes the state the only one, and the bound is that
of a compliance with the smallest eigenvalue λ/(1 + ρσ'/b).
"""

from dataclasses import dataclass

import numpy as np
import scipy
from scipy.linalg import eigh

from bemcontact.arrays import Array, BoolArray

MOST = 8
"""Eigenvectors with which a proof is tried."""
PASSES = 4
"""Times that the bounds of pressures and of their work sharpen one another."""
LEAST_REST = 0.05
"""Value of the bracket that is demanded: more than the linear programs can be off."""


@dataclass(frozen=True, kw_only=True, eq=False)
class NearState:
    """A pressure near the contact state in scaled numbers.

    Parameters
    ----------
    pressure : (n,) y >= 0 in equilibrium
    contact_set : (n,) where y may be positive
    equilibrium : (n, k) ℓ, with columns that are orthonormal, so that the linear programs see each direction
    work : (n,) g = Dδ - s on all points, zero on the contact set
    residual : |s|, with the round-off of s
    round_off : of the eigenvalues
    """

    pressure: Array
    contact_set: BoolArray
    equilibrium: Array
    work: Array
    residual: float
    round_off: float


def effective_eigenvalue(state: NearState, D: Array, M: Array, Z: Array) -> float | None:
    """Eigenvalue that bounds the error of the state by |s| over it, if it is proved to be the only one; else None.

    D (n,), M (n, n), and Z (n, n - k), an orthonormal basis of the equilibrium space.
    """
    weighted = D[:, None] * M
    last = min(MOST, Z.shape[1] - 1)
    values, vectors = eigh(Z.T @ (weighted + weighted.T) @ Z / 2, subset_by_index=(0, last))
    values, vectors = values - state.round_off, Z @ vectors
    for m in range(max(1, int(np.count_nonzero(values <= 0))), last + 1):
        if found := _with(state, float(max(-values[0], 0.0)), float(values[m]), vectors[:, :m]):
            return found
    return None


def _with(state: NearState, negative: float, positive: float, X: Array) -> float | None:
    """The eigenvalue by the eigenvectors X (n, m) of those up to λ, here `positive`; Λ is `negative`."""
    B = _bound(state, negative, positive, X)
    rows = np.linalg.norm(X, axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.where(state.contact_set | (state.work <= 0), np.inf, rows / state.work)
    order = np.argsort(-ratio)
    sigma = np.sqrt(np.linalg.eigvalsh(np.cumsum(X[order, :, None] * X[order, None, :], axis=0))[:, -1])
    kappa = np.append(ratio[order][1:], 0.0)
    rho = np.sqrt(1 + negative / positive)
    with np.errstate(invalid="ignore"):
        spread = sigma + kappa * state.residual
        bracket = np.nan_to_num(1 - kappa * negative * B - spread * rho, nan=-np.inf)
    best = int(np.argmax(bracket))
    return None if bracket[best] < LEAST_REST else float(positive / (1 + rho * spread[best] / bracket[best]))


def _bound(state: NearState, negative: float, positive: float, X: Array) -> float:
    """B, a bound of |Xᵀe|; infinity if the load does not bound pressures."""
    bound, work = np.inf, np.inf
    for _ in range(PASSES):
        bound = min(bound, float(np.linalg.norm([_largest(state, x, state.work / work) for x in X.T])))
        if not np.isfinite(bound):
            break
        size = state.residual / positive + np.sqrt(1 + negative / positive) * bound
        work = negative * bound**2 + size * state.residual
        if work <= 0:
            break
    return bound


def _largest(state: NearState, x: Array, g: Array) -> float:
    """Largest |xᵀ(y - p)| for all p >= 0 with the same load and gᵀp <= 1; infinity if it is unbounded."""
    size = np.maximum(1.0, g)
    columns = (state.equilibrium / size[:, None]).T
    ends = [
        scipy.optimize.linprog(
            side * x / size, A_ub=(g / size)[None, :], b_ub=[1.0], A_eq=columns,
            b_eq=state.equilibrium.T @ state.pressure, bounds=(0, None),
        )
        for side in (1.0, -1.0)
    ]  # fmt: skip
    at = float(x @ state.pressure)
    lowest, highest = (end.fun if end.status == 0 else -np.inf for end in ends)
    return max(at - lowest, -highest - at)
