"""Uniqueness of the contact state by weights other than the tributary ones, for slender bodies with long contacts.

Let y >= 0 be a pressure in equilibrium, s the part of Dδ that should not be, as in `certificate`, C the points with
y > 0, p* a contact state with gaps δ*, and e = y - p*. Each product eᵢ(δ - δ*)ᵢ but for that of s is at most zero, so
weights E > 0 may be put on them:

    eᵀED(δ - δ*) <= eᵀEs - Σ Eᵢ Dᵢ yᵢ δ*ᵢ,    δ - δ* = M e + R Δa.

The motion Δa is what C sees of it: Δa = Φ(δ - δ*) - ΦM e with Φ = G⁻¹RᵀDY, G = RᵀDY R, Y = diag(y). With
Q = ED(I - RΦ)M and u = RᵀEDe, which is Rᵀ(E - I)De as e is in equilibrium,

    eᵀQ e <= eᵀEs - uᵀΦδ + Σ (uᵀG⁻¹Rᵢ - Eᵢ) Dᵢ yᵢ δ*ᵢ.

The last sum is at most zero if |uᵀG⁻¹Rᵢ| <= Eᵢ on C, which holds for E near one, since the load bounds all p*. Then a
positive λ, the smallest eigenvalue of sym(Q) on the equilibrium space, bounds |e|. E is sought by least squares: that
by which sym(Q) is nearest to the identity, in the metric in which the eigenvalues of the form before are ±1.
"""

import numpy as np
from scipy.linalg import eigh

from bemcontact.assessment.definiteness import EPS, LEAST_COMPLIANCE
from bemcontact.assessment.uniqueness import NearState, largest_sum

ROUNDS = 12
"""Times that weights are sought, each from those before."""
LEAST = 1e-13
"""Fraction of the largest singular value of the normal equations below which one counts as zero."""


def reweighted_bound(state: NearState) -> float:
    """Bound of |y - p*| of all states p*, in the largest component; infinity if no weights prove one."""
    D, M, R, pressure, residual = state.weights, state.compliance, state.rigid_motions, state.pressure, state.residual
    n, k = R.shape
    carried = D * pressure
    G = R.T @ (carried[:, None] * R)
    if k and np.linalg.cond(G) > 1.0 / np.sqrt(EPS):
        return np.inf
    seen = np.linalg.solve(G, (carried[:, None] * R).T)  # Φ
    S = 1.0 / np.sqrt(D * np.maximum(M.diagonal(), LEAST_COMPLIANCE))
    A = (S * D)[:, None] * (M - R @ (seen @ M)) * S
    terms = (S * D)[:, None] * (np.abs(M) + np.abs(R) @ (np.abs(seen) @ np.abs(M))) * S
    ell = (S * D)[:, None] * R
    ell = ell / np.linalg.norm(ell, axis=0)
    Z = np.linalg.qr(ell, mode="complete")[0][:, k:]
    spread = float(np.linalg.cond(ell)) if k else 1.0
    E, certain = np.ones(n), -np.inf
    for _ in range(ROUNDS):
        form = E[:, None] * A
        values, vectors = eigh(Z.T @ ((form + form.T) / 2) @ Z)
        size = E[:, None] * terms
        certain = float(values[0]) - n * EPS * spread * float((size + size.T).sum(axis=1).max()) / 2
        if certain > 0 or not values.all():
            break
        flat = (Z @ vectors / np.abs(values)) @ (Z @ vectors).T
        product = form @ flat
        normal = (flat * (product @ form.T) + product * product.T) / 2
        E = E * np.linalg.lstsq(normal, product.diagonal(), rcond=LEAST)[0]
        if not E.min() > 0:
            return np.inf
        E = E / np.median(E)
    if not certain > 0:
        return np.inf
    apart = np.abs(E - 1.0)
    if k:
        total = carried.sum() + largest_sum(R, carried, n * EPS)
        levers = np.abs(R @ np.linalg.solve(G, R[pressure > 0].T)).max(axis=0)
        if not total < np.inf or (apart.max() * total * levers > E[pressure > 0]).any():
            return np.inf
    gaps = np.where(pressure > 0, residual / D, 0.0)
    rest = E * residual + apart * D * (np.abs(R) @ (np.abs(seen) @ gaps))
    return float(S.max() * np.linalg.norm(S * rest)) / certain
