"""The equations of a condensed contact solved for pressure: contact stiffness rows."""

from typing import NamedTuple

import numpy as np

from bemcontact.arrays import Array
from bemcontact.contact.scales import ContactScales
from bemcontact.errors import SingularSystemError


class StiffnessRows(NamedTuple):
    """K u_n = B p + r, [SS92] (12), as contact stiffness rows: K (n, n) [p/L], B (n, n) [1], r (n,) [p]."""

    K: Array
    B: Array
    r: Array


def stiffness_rows(
    compliance: Array,
    rigid_motions: Array,
    equilibrium: Array,
    free_displacement: Array,
    motion_load: Array,
    scales: ContactScales,
) -> StiffnessRows:
    """K u_n = B p + r, (12), with K = S, B = I, r = S Δ1 + V load; [S, V] the top of [[M, R], [ℓᵀ, 0]]⁻¹.

    Parameters
    ----------
    compliance, rigid_motions, equilibrium : M (n, n), R (n, k), ℓ (n, k)
    free_displacement, motion_load : Δ1 (n,), load (k,)
    scales : of the problem

    Returns
    -------
    StiffnessRows

    Raises
    ------
    SingularSystemError
        Where the matrix has no inverse.
    """
    n, k = rigid_motions.shape
    U, T = scales
    row_scale = np.abs(equilibrium).max(axis=0, initial=0.0)
    unit_rows = (equilibrium / row_scale).T
    bordered = np.block([[compliance * (T / U), rigid_motions], [unit_rows, np.zeros((k, k))]])
    try:
        inverse = np.linalg.inv(bordered.T).T.astype(float)  # accurate as a left inverse, which is how K is used
    except np.linalg.LinAlgError:
        raise SingularSystemError(
            "the compliance is singular: some change of pressure moves no contact point, so that pressures cannot "
            "be told apart; give each contact point a compliance of its own"
        ) from None
    S, V = inverse[:n, :n] * (T / U), inverse[:n, n:] / row_scale
    return StiffnessRows(S, np.eye(n), S @ free_displacement + V @ motion_load)
