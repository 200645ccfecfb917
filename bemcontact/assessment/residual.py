"""How wrong a solution is, recomputed from p and u_n alone: `residuals`."""

from dataclasses import asdict, dataclass

import numpy as np

from bemcontact.arrays import Array
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.solution import ContactSolution


@dataclass(frozen=True, kw_only=True)
class Residuals:
    """What is left of (12) and (16)-(18), free of units; with U, T the `CondensedContact.scales`.

    Parameters
    ----------
    penetration : max(-δ)/U, or 0 if no point penetrates; δ = ε + u_n with the solver's own u_n
    tension : max(-p)/T, or 0 if no point is in tension
    complementarity : max |min(p/T, δ/U)|, point by point, independent of weights
    work : pᵀJδ / (U T max J) with the tributary weights: zero exactly at the solution if p, δ >= 0
    equilibrium : of (12), max |u_n - Δ1 - M p - R a| / U for the best amplitudes a
    stiffness_rows : the same in the contact stiffness rows, max |K u_n - B p - r| / T: an error of pressure, to which
        round-off adds eps times the condition of the compliance
    balance : max over the free motions of |ℓᵀp + load| / (T Σ|ℓ|), an error of mean pressure; 0 if there are none
    round_off : what evaluating δ where p/T > δ/U may leave of penetration and complementarity
    force_balance : of the whole body, from its recovered boundary tractions, if the caller has them; else None
    """

    penetration: float
    tension: float
    complementarity: float
    work: float
    equilibrium: float
    stiffness_rows: float
    balance: float
    round_off: float
    force_balance: float | None

    def to_dict(self) -> dict[str, float | None]:
        """Give them as numbers, ready for JSON, without the round-off allowed."""
        return {name: value for name, value in asdict(self).items() if name != "round_off"}


def residuals(contact: CondensedContact, solution: ContactSolution, force_balance: float | None = None) -> Residuals:
    """Recompute all that a solution must satisfy.

    Parameters
    ----------
    contact : CondensedContact
    solution : of any formulation
    force_balance : relative, passed through

    Returns
    -------
    Residuals
    """
    U, T = contact.scales
    p, u_n = solution.pressure, solution.displacement
    gap = contact.initial_gap + u_n
    K, B, r = contact.stiffness_rows
    apart = u_n - contact.free_displacement - contact.compliance @ p
    R, root = contact.rigid_motions, np.sqrt(contact.weights)  # on purpose not `amplitudes_of`, which solvers use
    apart = apart - R @ np.linalg.lstsq(root[:, None] * R, root * apart, rcond=None)[0]
    return Residuals(
        penetration=_largest(-gap / U),
        tension=_largest(-p / T),
        complementarity=_largest(np.abs(np.minimum(p / T, gap / U))),
        work=float(contact.weights @ (p * gap)) / (U * T * float(contact.weights.max())),
        equilibrium=_largest(np.abs(apart) / U),
        stiffness_rows=_largest(np.abs(K @ u_n - B @ p - r) / T),
        balance=_largest(_imbalance(contact, p) / (T * np.abs(contact.equilibrium).sum(axis=0))),
        round_off=_largest(_round_off(contact, solution)[contact.touching(p, u_n)] / U),
        force_balance=force_balance,
    )


def _round_off(contact: CondensedContact, solution: ContactSolution) -> Array:
    """Round-off of δ (n,) [L], n eps times the sum of the magnitudes of all that is added up in it."""
    terms = np.abs(contact.initial_gap) + np.abs(contact.free_displacement)
    terms += np.abs(contact.compliance) @ np.abs(solution.pressure)
    terms += np.abs(contact.rigid_motions) @ np.abs(solution.rigid_amplitudes)
    return contact.size * np.finfo(float).eps * terms


def _imbalance(contact: CondensedContact, pressure: Array) -> Array:
    """|ℓᵀp + load| (k,)."""
    return np.abs(contact.imbalance(pressure))


def _largest(values: Array) -> float:
    """The largest positive one, or zero."""
    return float(values.max(initial=0.0))
