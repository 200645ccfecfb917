"""Points that no contact state can press on, because the load and the compliance do not close their gaps.

A zone may be much longer than the contact in it, and a node may face several surfaces. Then the compliance on all
points is often not definite, and on those that can touch it is.

For each state p* the load bounds Σ Dp* by a number P, and |S⁻¹(y - p*)| by B; see `uniqueness` for the names. So the
work yᵀDδ* is at most w = ΛB² + B|Ss|. Where the body moves freely, y sees its motion, as in `reweighting`:

    δ* - δ = H (p* - y) + RΦ(δ* - δ),  H = (I - RΦ) M,  Φ = G⁻¹RᵀDY,  G = RᵀDY R.

With δ* >= 0 the last product is at most w max |RᵢG⁻¹Rⱼᵀ| over the points j with y > 0. Hence

    δ*ᵢ >= δᵢ + P min(0, minⱼ Hᵢⱼ/Dⱼ) - (Hy)ᵢ - w maxⱼ |RᵢG⁻¹Rⱼᵀ| - |Rᵢ||Φδ|.

A point whose bound is positive is open in each state. Without these points P, B and Λ are less, and so on.
"""

import numpy as np

from bemcontact.arrays import Array, BoolArray
from bemcontact.assessment.definiteness import EPS
from bemcontact.assessment.uniqueness import NearState

REST = 1e-6
"""Gap over the terms of its bound that is demanded: more than these can be off by rounding."""


def points_that_may_touch(state: NearState) -> BoolArray:
    """Points (n,) on which a state may press; the fewest that are found, or the first on which M is definite."""
    touch = np.ones(len(state.pressure), bool)
    while not state.definiteness.definite:
        least = _least_gaps(state)
        opened = (least > 0) & ~state.contact_set
        if not opened.any():
            break
        touch[touch] = ~opened
        state = state.on(~opened)
    return touch


def _least_gaps(state: NearState) -> Array:
    """Lower bounds (n,) of the gaps in all states; minus infinity if there are none."""
    D, M, R, y = state.weights, state.compliance, state.rigid_motions, state.pressure
    carried = D * y
    G = R.T @ (carried[:, None] * R)
    B, P = state.bounds()
    if not (np.inf > B and np.inf > P) or (len(G) and np.linalg.cond(G) > 1.0 / np.sqrt(EPS)):
        return np.full(len(D), -np.inf)
    seen = np.linalg.solve(G, (carried[:, None] * R).T)  # Φ
    H, sizes = M - R @ (seen @ M), np.abs(M) + np.abs(R) @ (np.abs(seen) @ np.abs(M))
    levers = np.abs(R @ np.linalg.solve(G, R[y > 0].T)).max(axis=1, initial=0.0)
    residual = float(np.linalg.norm(state.definiteness.scales * state.residual))
    work = max(-state.definiteness.certain, 0.0) * B**2 + B * residual
    gaps = np.abs(R) @ np.abs(seen) @ np.where(y > 0, state.residual / D, 0.0)
    terms = P * (sizes / D).max(axis=1) + sizes @ y + work * levers + gaps
    least = state.work / D + P * np.minimum((H / D).min(axis=1), 0.0) - H @ y - work * levers - gaps
    return least - REST * terms
