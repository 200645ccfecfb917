"""Residuals and objectives of a solution, recomputed from p and u_n alone.

All objectives are zero at the contact state with diagonal weights. The consistent weights couple neighbors, so that the
objectives are not zero there. An objective below that of another solution says nothing where equations or bounds are
violated: read it beside the residuals.
"""

import numpy as np

from bemcontact.arrays import Array, least_squares
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.lu import LU
from bemcontact.contact.solution import ContactSolution
from bemcontact.frozen import frozen_value
from bemcontact.options import Weights
from bemcontact.serialization import Leaf


@frozen_value
class Residuals(Leaf):
    """Residuals of (12) and (16)-(18), recomputed, over the scales of displacement U and pressure T.

    The gap is δ = ε + u_n with the solver's own u_n.
    """

    penetration: float
    """Largest penetration max(-δ)/U of a point, or 0."""
    tension: float
    """Largest tension max(-p)/T of a point, or 0."""
    complementarity: float
    """Largest |min(p/T, δ/U)| of a point; it does not depend on weights."""
    work: float
    """Work pᵀJδ over U T max J with the tributary weights J; 0 exactly at the solution if p, δ >= 0."""
    equilibrium: float
    """Residual of (12), max |u_n - Δ1 - M p - R a|/U for the best amplitudes a."""
    equilibrium_round_off: float
    """Round-off of u_n over U, which the residual of (12) cannot fall below."""
    stiffness_rows: float
    """Residual of the contact stiffness rows, max |K u_n - B p - r|/T: an error of pressure.

    Round-off adds to it the machine precision times the condition of the compliance.
    """
    balance: float
    """Imbalance max |ℓᵀp + load|/(T Σ|ℓ|) over the free motions, an error of mean pressure; 0 without free motions."""
    round_off: float
    """Round-off of δ over U where p/T > δ/U, which penetration and complementarity cannot fall below."""
    force_balance: float | None
    """Resultant of all forces on the body over the sum of their magnitudes; null where no boundary was recovered."""


def residuals(contact: CondensedContact, solution: ContactSolution, force_balance: float | None = None) -> Residuals:
    """Recompute all residuals of a solution of any formulation; the force balance is passed through."""
    U, T = contact.scales
    p, u_n = solution.pressure, solution.displacement
    gap = contact.initial_gap + u_n
    round_off = _round_off(contact, solution)
    residual = u_n - contact.free_displacement - contact.compliance @ p
    residual = residual - contact.rigid_motions @ solution.rigid_amplitudes  # what is left has all its digits
    R, root = contact.rigid_motions, np.sqrt(contact.weights)  # on purpose not `amplitudes_of`, which solvers use
    residual = residual - R @ least_squares(root[:, None] * R, root * residual)
    return Residuals(
        penetration=_largest(-gap / U),
        tension=_largest(-p / T),
        complementarity=_largest(np.abs(np.minimum(p / T, gap / U))),
        work=float(contact.weights @ (p * gap)) / (U * T * float(contact.weights.max())),
        equilibrium=_largest(np.abs(residual) / U),
        equilibrium_round_off=_largest(round_off / U),
        stiffness_rows=_largest(np.abs(_pressure_that_moves(contact, u_n) - p) / T),
        balance=_largest(np.abs(contact.imbalance(p)) / (T * np.abs(contact.equilibrium).sum(axis=0))),
        round_off=_largest(round_off[contact.touching(p, u_n)] / U),
        force_balance=force_balance,
    )


def _pressure_that_moves(contact: CondensedContact, displacement: Array) -> Array:
    """K u_n - r (n,) [p], the pressure by (12), from one system of equations: K itself takes three times as long.

    `SingularSystemError` where the rows do not exist.
    """
    R, ell, (U, T) = contact.rigid_motions, contact.equilibrium, contact.scales
    n, k = R.shape
    size = np.abs(ell).max(axis=0, initial=0.0)
    bordered = np.zeros((n + k, n + k))
    bordered[:n, :n], bordered[:n, n:], bordered[n:, :n] = contact.compliance * (T / U), R, (ell / size).T
    factors = LU.of(bordered)
    if factors.singular:
        K, _, r = contact.stiffness_rows
        return K @ displacement - r
    right = np.concatenate([(displacement - contact.free_displacement) * (T / U), -contact.motion_load / size])
    return factors.solve(right, lambda found: right - bordered @ found)[:n]


def _round_off(contact: CondensedContact, solution: ContactSolution) -> Array:
    """Round-off of δ (n,) [L], n eps times the sum of the magnitudes of all that is added up in it."""
    terms = np.abs(contact.initial_gap) + np.abs(contact.free_displacement)
    terms += np.abs(contact.compliance) @ np.abs(solution.pressure)
    terms += np.abs(contact.rigid_motions) @ np.abs(solution.rigid_amplitudes)
    return contact.size * np.finfo(float).eps * terms


def _largest(values: Array) -> float:
    """The largest positive value, or zero."""
    return float(values.max(initial=0.0))


@frozen_value
class PenaltyObjective(Leaf):
    """Objective of QP2 with one penalty."""

    penalty: float
    """Penalty μ, free of units."""
    value: float
    """F2 = F1 + (1/μ)|K u_n - B p - r|², (30), scaled."""


@frozen_value
class Objectives(Leaf):
    """Objectives of one solution under every statement, over U T max|J|, the scales and the weights.

    All are zero at the contact state with positive diagonal weights.
    """

    weights: Weights
    """The weights J in all of them."""
    qp1: float
    """F1 = pᵀJ(ε + u_n), (27), with the solver's own displacements u_n."""
    qp2: tuple[PenaltyObjective, ...]
    """F2 of (30) for each penalty μ."""
    qp3: float
    """F3 = pᵀJ(ε + Δ1 + M p + R a), (40), with the displacements that the equations give for these pressures."""


def objectives(
    contact: CondensedContact, solution: ContactSolution, weights: Weights, penalties: tuple[float, ...]
) -> Objectives:
    """Evaluate (27), (30) and (40) at a solution; `ProblemError` if the problem does not carry these weights."""
    U, T = contact.scales
    J = contact.weight_matrix(weights)
    p, u = solution.pressure / T, solution.displacement / U
    K, B, r = contact.stiffness_rows
    residual = (K @ solution.displacement - B @ solution.pressure - r) / T
    work = p @ J / np.abs(J).max()
    qp1 = float(work @ (contact.initial_gap / U + u))
    return Objectives(
        weights=weights,
        qp1=qp1,
        qp2=tuple(
            PenaltyObjective(penalty=penalty, value=qp1 + float(residual @ residual) / penalty) for penalty in penalties
        ),
        qp3=float(work @ contact.gap(solution.pressure, solution.rigid_amplitudes)) / U,
    )
