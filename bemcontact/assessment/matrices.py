"""What the condensed matrices are like: asymmetry, definiteness, condition; they decide what can be proved."""

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from scipy.linalg import eigvalsh

from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.options import Weights

NEGLIGIBLE = 1e-10
"""Entry of ZᵀJR, or part of the largest eigenvalue, that is round-off; by the scaling the numbers are of size one."""


@dataclass(frozen=True, kw_only=True)
class WeightedCompliance:
    """J M with J over its largest entry and ‖M‖∞ = 1, and what it is on the equilibrium space {p : ℓᵀp = 0}.

    Parameters
    ----------
    weights : which J
    negative_weights : entries of J below zero; with any of them an objective of zero certifies nothing
    asymmetry : |JM - MᵀJᵀ| / |JM + MᵀJᵀ| in the Frobenius norm: zero for the continuum, so that it tells of the mesh
    smallest_eigenvalue, largest_eigenvalue : of sym(JM) on the equilibrium space; None if that is the zero vector
    saddle : whether pᵀJR a does not vanish there, so that the objective of QP3 is a saddle in (p, a)
    """

    weights: Weights
    negative_weights: int
    asymmetry: float
    smallest_eigenvalue: float | None
    largest_eigenvalue: float | None
    saddle: bool

    @property
    def definite(self) -> bool:
        """Whether sym(JM) has no negative eigenvalue on the equilibrium space, up to round-off."""
        if self.smallest_eigenvalue is None or self.largest_eigenvalue is None:
            return True
        return self.smallest_eigenvalue >= -NEGLIGIBLE * abs(self.largest_eigenvalue)

    @property
    def convex(self) -> bool:
        """Whether QP3 with these weights is convex, up to round-off."""
        return self.definite and not self.saddle

    def to_dict(self) -> dict[str, Any]:
        """Give it as numbers and texts, ready for JSON."""
        return {**asdict(self), "weights": self.weights.value, "convex": self.convex}


def weighted_compliance(contact: CondensedContact, weights: Weights) -> WeightedCompliance:
    """Look at J M.

    Parameters
    ----------
    contact : CondensedContact
    weights : which J

    Returns
    -------
    WeightedCompliance

    Raises
    ------
    ProblemError
        The problem does not carry these weights.
    """
    U, T = contact.scales
    J = contact.weight_matrix(weights)
    J = J / np.abs(J).max()
    weighted, Z = J @ contact.compliance * (T / U), contact.equilibrium_space
    symmetric = weighted + weighted.T
    eigenvalues = eigvalsh(Z.T @ symmetric @ Z / 2) if Z.shape[1] else None
    motions = contact.rigid_motions / np.abs(contact.rigid_motions).max(axis=0, initial=0.0)
    size = float(np.linalg.norm(symmetric))
    return WeightedCompliance(
        weights=weights,
        negative_weights=int(np.count_nonzero(J < 0)),
        asymmetry=float(np.linalg.norm(weighted - weighted.T)) / size if size > 0 else 0.0,
        smallest_eigenvalue=None if eigenvalues is None else float(eigenvalues[0]),
        largest_eigenvalue=None if eigenvalues is None else float(eigenvalues[-1]),
        saddle=bool(np.abs(Z.T @ J @ motions).max(initial=0.0) > NEGLIGIBLE),
    )


def condition(contact: CondensedContact) -> float:
    """Condition in the 2-norm of [[M, R], [ℓᵀ, 0]], scaled, whose inverse holds the contact stiffness rows of (12)."""
    U, T = contact.scales
    R, k = contact.rigid_motions, contact.free_motions
    motions = R / np.abs(R).max(axis=0, initial=0.0)
    rows = (contact.weights / contact.weights.max())[:, None] * motions
    matrix = np.block([[contact.compliance * (T / U), motions], [rows.T, np.zeros((k, k))]])
    return float(np.linalg.cond(matrix))
