"""Asymmetry, definiteness and condition of the condensed matrices, which decide what can be proved."""

import numpy as np
from pydantic import computed_field
from scipy.linalg import eigvalsh

from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.frozen import frozen_value
from bemcontact.options import Weights
from bemcontact.serialization import Leaf

NEGLIGIBLE = 1e-10
"""Entry of ZᵀJR, or part of the largest eigenvalue, that is round-off; by the scaling the numbers are of size one."""


@frozen_value
class WeightedCompliance(Leaf):
    """Numbers of J M on the equilibrium space {p : ℓᵀp = 0}; J is over its largest entry and ‖M‖∞ = 1."""

    weights: Weights
    """The weights J."""
    negative_weights: int
    """Number of entries of J below 0; with any of them an objective of 0 certifies nothing."""
    asymmetry: float
    """|JM - MᵀJᵀ|/|JM + MᵀJᵀ| in the Frobenius norm; 0 for the continuum, so that it measures the mesh."""
    smallest_eigenvalue: float | None
    """Smallest eigenvalue of sym(JM) on the equilibrium space; null if equilibrium alone fixes the pressure."""
    largest_eigenvalue: float | None
    """Largest eigenvalue of sym(JM) on the equilibrium space; null if equilibrium alone fixes the pressure."""
    saddle: bool
    """Whether pᵀJR a is not zero on the equilibrium space, so that the objective of QP3 is a saddle in (p, a)."""

    @property
    def definite(self) -> bool:
        """Whether sym(JM) has no negative eigenvalue on the equilibrium space, up to round-off."""
        if self.smallest_eigenvalue is None or self.largest_eigenvalue is None:
            return True
        return self.smallest_eigenvalue >= -NEGLIGIBLE * abs(self.largest_eigenvalue)

    @computed_field
    @property
    def convex(self) -> bool:
        """Whether QP3 with these weights is convex, up to round-off."""
        return self.definite and not self.saddle


def weighted_compliance(contact: CondensedContact, weights: Weights) -> WeightedCompliance:
    """Compute the numbers of J M; `ProblemError` if the problem does not carry these weights."""
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
