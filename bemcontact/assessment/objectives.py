"""One solution under every statement: F1 of QP1, F2 of QP2 and F3 of QP3, recomputed from p and u_n.

All three are zero at the contact state with diagonal weights. The consistent weights couple neighbors, so that the
objectives are not zero there. An objective below that of another solution says nothing where equations or bounds are
violated: read it beside the residuals.
"""

from dataclasses import dataclass

import numpy as np

from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.solution import ContactSolution
from bemcontact.options import Weights
from bemcontact.serialization import Leaf


@dataclass(frozen=True, kw_only=True)
class PenaltyObjective(Leaf):
    """Objective of QP2 with one penalty."""

    penalty: float
    """Penalty μ, free of units."""
    value: float
    """F2 = F1 + (1/μ)|K u_n - B p - r|², (30), scaled."""


@dataclass(frozen=True, kw_only=True)
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
