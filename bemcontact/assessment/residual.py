"""How wrong a solution is, recomputed from p and u_n alone: `residuals`."""

from dataclasses import dataclass

import numpy as np

from bemcontact.contact import Array, CondensedContact, ContactSolution


@dataclass(frozen=True, kw_only=True)
class Residuals:
    """What is left of (12) and (16)-(18), free of units; with U, T the `CondensedContact.scales`.

    Parameters
    ----------
    penetration : max(-δ)/U, or 0 if no point penetrates; δ = ε + u_n with the solver's own u_n
    tension : max(-p)/T, or 0 if no point is in tension
    complementarity : max |min(p/T, δ/U)|, point by point, independent of weights
    work : pᵀJδ / (U T max J) with the tributary weights: zero exactly at the solution if p, δ >= 0
    equilibrium : max |K u_n - B p - r| / T, the contact stiffness rows of (12): an error of pressure
    balance : max over the free motions of |ℓᵀp + load| / (T Σ|ℓ|), an error of mean pressure; 0 if there are none
    force_balance : of the whole body, from its recovered boundary tractions, if the caller has them; else None
    equilibrium_round_off : what evaluating the rows of (12) may leave of `equilibrium`, n eps times
        max(|K||u_n| + |p| + |r|)/T; it grows with the condition of the compliance
    """

    penetration: float
    tension: float
    complementarity: float
    work: float
    equilibrium: float
    balance: float
    force_balance: float | None
    equilibrium_round_off: float


def residuals(condensed: CondensedContact, solution: ContactSolution, force_balance: float | None = None) -> Residuals:
    """Recompute all that a solution must satisfy.

    Parameters
    ----------
    condensed : CondensedContact
    solution : of any formulation
    force_balance : relative, passed through

    Returns
    -------
    Residuals
    """
    U, T = condensed.scales
    p, u_n = solution.pressure, solution.displacement
    gap = condensed.initial_gap + u_n
    K, B, r = condensed.stiffness_rows
    magnitudes = np.abs(K) @ np.abs(u_n) + np.abs(B) @ np.abs(p) + np.abs(r)
    return Residuals(
        penetration=_largest(-gap / U),
        tension=_largest(-p / T),
        complementarity=_largest(np.abs(np.minimum(p / T, gap / U))),
        work=float(condensed.weights @ (p * gap)) / (U * T * float(condensed.weights.max())),
        equilibrium=_largest(np.abs(K @ u_n - B @ p - r) / T),
        balance=_largest(_imbalance(condensed, p) / (T * np.abs(condensed.equilibrium).sum(axis=0))),
        force_balance=force_balance,
        equilibrium_round_off=condensed.size * float(np.finfo(float).eps) * _largest(magnitudes / T),
    )


def _imbalance(condensed: CondensedContact, pressure: Array) -> Array:
    """|ℓᵀp + load| (k,)."""
    return np.abs(condensed.equilibrium.T @ pressure + condensed.motion_load)


def _largest(values: Array) -> float:
    """The largest positive one, or zero."""
    return float(values.max(initial=0.0))
