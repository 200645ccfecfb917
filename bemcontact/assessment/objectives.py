"""One solution under every statement: F1 of QP1, F2 of QP2 and F3 of QP3, recomputed from p and u_n.

All three vanish at the contact state with diagonal weights; the consistent ones couple neighbours and leave a rest. An
objective below that of another solution says nothing where equations or bounds are violated, so read them beside the
residuals.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.solution import ContactSolution
from bemcontact.options import Weights


@dataclass(frozen=True, kw_only=True)
class Objectives:
    """The objectives of one solution, free of units: over U T max|J|, the `CondensedContact.scales` and the weights.

    Parameters
    ----------
    weights : the J in all of them
    qp1 : F1 = pᵀJ(ε + u_n), (27)
    qp2 : F2 = F1 + (1/μ)|K u_n - B p - r|², (30), for each penalty μ
    qp3 : F3 = pᵀJ(ε + Δ1 + M p + R a) for the best amplitudes a, (40)
    """

    weights: Weights
    qp1: float
    qp2: tuple[tuple[float, float], ...]
    qp3: float

    def to_dict(self) -> dict[str, Any]:
        """Give them as numbers and texts, ready for JSON."""
        return {
            "weights": self.weights.value,
            "qp1": self.qp1,
            "qp2": [{"penalty": penalty, "value": value} for penalty, value in self.qp2],
            "qp3": self.qp3,
        }


def objectives(
    contact: CondensedContact, solution: ContactSolution, weights: Weights, penalties: tuple[float, ...]
) -> Objectives:
    """Evaluate (27), (30) and (40) at a solution.

    Parameters
    ----------
    contact : CondensedContact
    solution : of any formulation
    weights : of all three
    penalties : μ of QP2, free of units

    Returns
    -------
    Objectives

    Raises
    ------
    ProblemError
        The problem does not carry these weights.
    """
    U, T = contact.scales
    J = contact.weight_matrix(weights)
    p, u = solution.pressure / T, solution.displacement / U
    K, B, r = contact.stiffness_rows
    strange = (K @ solution.displacement - B @ solution.pressure - r) / T
    work = p @ J / np.abs(J).max()
    qp1 = float(work @ (contact.initial_gap / U + u))
    return Objectives(
        weights=weights,
        qp1=qp1,
        qp2=tuple((penalty, qp1 + float(strange @ strange) / penalty) for penalty in penalties),
        qp3=float(work @ contact.gap(solution.pressure, solution.rigid_amplitudes)) / U,
    )
