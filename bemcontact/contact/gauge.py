"""The gauge of a condensed problem: what depends on how its free rigid motions were held while solving, taken out."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Gauge(NamedTuple):
    """Compliance and free displacement in the fixed gauge, and the shift (k,), (k, n) of the amplitudes it implies.

    Of s loadings at once, free displacement is (n, s), and the shift by the load (k, s).

    u_n = Δ1 + M p + R a holds before and after for every p in equilibrium, with
    ``a_before = a_after - shift_load - shift_pressure @ p``.
    """

    compliance: Array
    free_displacement: Array
    shift_load: Array
    shift_pressure: Array


def fix_gauge(
    compliance: Array, free_displacement: Array, rigid_motions: Array, weights: Array, motion_load: Array
) -> Gauge:
    """Remove from M and Δ1 what depends on how the free rigid motions were held while solving.

    With ℓ = J R, P = I - R (ℓᵀR)⁻¹ ℓᵀ and p0 = -R (ℓᵀR)⁻¹ load: M' = P M P and Δ1' = P (Δ1 + M p0).

    Parameters
    ----------
    compliance : (n, n) M [L/p]
    free_displacement : (n,) Δ1 [L], or (n, s) of s loadings
    rigid_motions : (n, k) R of full column rank
    weights : (n,) tributary J [L]
    motion_load : (k,) work of the applied loads in the free motions, or (k, s)

    Returns
    -------
    Gauge
    """
    M, R = compliance, rigid_motions
    ell = weights[:, None] * R
    to_motion = np.linalg.solve(ell.T @ R, ell.T)
    p0 = -R @ np.linalg.solve(ell.T @ R, motion_load)
    n, k = R.shape
    project = np.eye(n) - R @ to_motion if n > k else np.zeros((n, n))
    return Gauge(
        compliance=project @ M @ project,
        free_displacement=project @ (free_displacement + M @ p0),
        shift_load=to_motion @ free_displacement,
        shift_pressure=to_motion @ M,
    )
