"""Uniqueness of the contact state of slender bodies, whose sym(DM) has a few slightly negative eigenvalues.

Their eigenvectors spread over the whole length of a slender body. Contact does not: the gap keeps pressure away from
the other points, and the load bounds it. Together they exclude the negative directions.

Let K = sym(DM) on the equilibrium space have the eigenvalues -Λ <= λ₁ <= ... <= λₘ, and λ > 0 above them, with the
eigenvectors X (n, m) of the first m. Let y >= 0 be a pressure in equilibrium, s the part of Dδ that should not be, as
in `certificate`, p* a contact state, e = y - p* and t = |Xᵀe|. Let S be a set of points with y = 0 off it, g = Dδ - s
and r = p* off S. Then

    λ(|e|² - t²) + gᵀr <= Λt² + |e||s|.

The rows of X off S are small beside g: with σ the norm of the rows of X on S, and κ = max |Xᵢ|/gᵢ off S,

    t <= σ|e| + κ gᵀr,    |e| <= |s|/λ + ρt,    ρ = √(1 + Λ/λ).

All p* >= 0 carry the same load, and gᵀp* <= Λt² + |e||s|. Linear programs of k + 1 rows bound |xⱼᵀe| for these, and
so t by a number B. With σ' = σ + κ|s| the inequalities combine to

    t (1 - κΛB - σ'ρ) <= σ'|s|/λ.

If the bracket, b, is positive, then |e| <= |s|/λ (1 + ρσ'/b), the bound of a compliance with the smallest eigenvalue
λ/(1 + ρσ'/b). All states are within this bound of y. That there is only one is proved if s = 0 alone.

Where a node has contact points for several surfaces, K has many eigenvalues that are zero up to round-off -Λ. Then
contact is near one of the surfaces only. Let N be the points with gᵢ <= h, the contact set among them, all in the
scaling S of `definiteness`; let λ > 0 be the eigenvalue on N, and σ the least singular value of the rows of ℓ there,
for orthonormal columns. The load bounds |e| by a number B, and so gᵀr <= w = ΛB² + B|s|. A body without free motions
has no ℓ; there K' = K - N is positive definite, with a smallest eigenvalue λ', for some N >= 0 that joins the points
which null vectors of K set against each other. With b = max(K'y, -Dq) and p* >= 0 it is p*ᵀK'p* <= p*ᵀKp* = -p*ᵀDq
<= p*ᵀb, and so λ'|p*|² <= bᵀK'⁻¹b. Off N this leaves
|r| <= τ = w/h. On N the rest of e is v + d, with v in the equilibrium space of N and |d| <= τ/σ. With η = τ (1 + 1/σ)

    λ|v|² - 2‖K‖η|v| - ‖K‖η² <= eᵀKe <= (|v| + η)|s|,

a bound of |e| <= |v| + η that takes the place of B, and so on: in the end little more than |s|/λ is left.
"""

import numpy as np
import scipy
from scipy.linalg import eigh

from bemcontact.arrays import Array, BoolArray
from bemcontact.assessment.definiteness import EPS, SURE, Definiteness, least_eigenvalue
from bemcontact.cached import cached_property
from bemcontact.frozen import frozen

MOST = 8
"""Eigenvectors with which a proof is tried."""
PASSES = 4
"""Times that the bounds of pressures and of their work sharpen one another."""
NEAR = (0.25, 0.5, 0.75)
"""Parts of the open points, those with the smallest gaps first, that are tried as near to contact."""
ROUNDS = 20
"""Times that the bound of pressures near contact and the work of all others sharpen one another."""
NULL = (1e-4, 1e-6, 1e-8)
"""Eigenvalues of K, with a diagonal of ones, up to which vectors are tried as null vectors."""
SAFE = 2.0
"""Bound of |p - p'| over the largest sum of pressures, for two p, p' >= 0: √2, and more than round-off can add."""
LEAST_REST = 0.05
"""Value of the bracket that is demanded: more than the linear programs can be off."""


@frozen
class NearState:
    """A pressure near the contact state in scaled numbers, on all points that may be in contact.

    Parameters
    ----------
    weights, compliance, rigid_motions, offset : D (n,), M (n, n), R (n, k), q (n,)
    equilibrium : (n, k) ℓ
    pressure : (n,) y >= 0 in equilibrium
    work : (n,) g = Dδ - s, zero on the contact set
    residual : (n,) |sᵢ|, with their round-off
    definiteness : of M on the equilibrium space
    """

    weights: Array
    compliance: Array
    rigid_motions: Array
    offset: Array
    equilibrium: Array
    pressure: Array
    work: Array
    residual: Array
    definiteness: Definiteness

    def on(self, points: BoolArray) -> "NearState":
        """The same on fewer points, if no state presses on others."""
        if points.all():
            return self
        D, M, ell = self.weights[points], self.compliance[np.ix_(points, points)], self.equilibrium[points]
        return NearState(
            weights=D,
            compliance=M,
            rigid_motions=self.rigid_motions[points],
            offset=self.offset[points],
            equilibrium=ell,
            pressure=self.pressure[points],
            work=self.work[points],
            residual=self.residual[points],
            definiteness=Definiteness.of(D, M, ell),
        )

    @property
    def contact_set(self) -> BoolArray:
        """Where y is positive (n,)."""
        return self.pressure > 0

    @cached_property
    def directions(self) -> Array:
        """ℓ with columns that are orthonormal (n, k), so that linear programs see each direction."""
        return np.linalg.qr(self.equilibrium)[0]

    @property
    def round_off(self) -> float:
        """That of eigenvalues on the equilibrium space."""
        spread = float(np.linalg.cond(self.equilibrium)) if self.equilibrium.size else 1.0
        return len(self.pressure) * EPS * spread

    def bounds(self) -> tuple[float, float]:
        """Bounds of |S⁻¹(y - p*)| and of Σ Dp* for all states p*; infinity if there are none."""
        S, D, y = self.definiteness.scales, self.weights, self.pressure
        if self.equilibrium.size:
            return SAFE * self._largest_sum(1 / S), self._largest_sum(D)
        most = _largest_pressure(self.definiteness, y / S, -S * D * self.offset)
        return most + float(np.linalg.norm(y / S)), most * float(np.linalg.norm(D * S))

    def _largest_sum(self, weights: Array) -> float:
        """Bound of Σ wᵢp*ᵢ of all states p* for weights w > 0."""
        columns = self.equilibrium / weights[:, None]
        columns = columns / np.linalg.norm(columns, axis=0)
        lost = len(weights) * EPS * float(np.linalg.cond(columns))
        return largest_sum(np.linalg.qr(columns)[0], weights * self.pressure, lost)


def effective_eigenvalue(state: NearState) -> float | None:
    """Eigenvalue by which |s| over it bounds how far each state can be from y; None if none is proved."""
    weighted, ell = state.weights[:, None] * state.compliance, state.equilibrium
    Z = np.linalg.qr(ell, mode="complete")[0][:, ell.shape[1] :]
    last = min(MOST, Z.shape[1] - 1)
    values, vectors = eigh(Z.T @ (weighted + weighted.T) @ Z / 2, subset_by_index=(0, last))
    values, vectors = values - state.round_off, Z @ vectors
    for m in range(max(1, int(np.count_nonzero(values <= 0))), last + 1):
        if found := _with(state, float(max(-values[0], 0.0)), float(values[m]), vectors[:, :m]):
            return found
    return None


def _with(state: NearState, negative: float, positive: float, X: Array) -> float | None:
    """The eigenvalue by the eigenvectors X (n, m) of those up to λ, here `positive`; Λ is `negative`."""
    B = _bound(state, negative, positive, X)
    rows = np.linalg.norm(X, axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.where(state.contact_set | (state.work <= 0), np.inf, rows / state.work)
    order = np.argsort(-ratio)
    sigma = np.sqrt(np.linalg.eigvalsh(np.cumsum(X[order, :, None] * X[order, None, :], axis=0))[:, -1])
    kappa = np.append(ratio[order][1:], 0.0)
    rho = np.sqrt(1 + negative / positive)
    with np.errstate(invalid="ignore"):
        spread = sigma + kappa * np.linalg.norm(state.residual)
        bracket = np.nan_to_num(1 - kappa * negative * B - spread * rho, nan=-np.inf)
    best = int(np.argmax(bracket))
    return None if bracket[best] < LEAST_REST else float(positive / (1 + rho * spread[best] / bracket[best]))


def _bound(state: NearState, negative: float, positive: float, X: Array) -> float:
    """B, a bound of |Xᵀe|; infinity if the load does not bound pressures."""
    bound, work, residual = np.inf, np.inf, float(np.linalg.norm(state.residual))
    for _ in range(PASSES):
        bound = min(bound, float(np.linalg.norm([_largest(state, x, state.work / work) for x in X.T])))
        if not np.isfinite(bound):
            break
        size = residual / positive + np.sqrt(1 + negative / positive) * bound
        work = negative * bound**2 + size * residual
        if work <= 0:
            break
    return bound


def _largest(state: NearState, x: Array, g: Array) -> float:
    """Largest |xᵀ(y - p)| for all p >= 0 with the same load and gᵀp <= 1; infinity if it is unbounded."""
    size = np.maximum(1.0, g)
    columns = (state.directions / size[:, None]).T
    ends = [
        scipy.optimize.linprog(
            side * x / size, A_ub=(g / size)[None, :], b_ub=[1.0], A_eq=columns,
            b_eq=state.directions.T @ state.pressure, bounds=(0, None),
        )
        for side in (1.0, -1.0)
    ]  # fmt: skip
    at = float(x @ state.pressure)
    lowest, highest = (end.fun if end.status == 0 else -np.inf for end in ends)
    return max(at - lowest, -highest - at)


def near_bound(state: NearState) -> float:
    """Bound of |y - p*| of all states p*, in the largest component, by points near contact, or infinity."""
    D, M, ell, whole = state.weights, state.compliance, state.equilibrium, state.definiteness
    S, open_points = whole.scales, ~state.contact_set
    scaled = S[:, None] * ell / np.linalg.norm(S[:, None] * ell, axis=0)
    rows, lost = np.linalg.qr(scaled)[0], len(S) * EPS * float(np.linalg.cond(scaled)) if ell.size else 0.0
    g, residual = S * state.work, float(np.linalg.norm(S * state.residual))
    K = np.abs(S[:, None] * (D[:, None] * M) * S)
    norm, start, found = float(((K + K.T) / 2).sum(axis=1).max()), state.bounds()[0], np.inf
    for h in np.quantile(g[open_points], NEAR) if start < np.inf and open_points.any() else ():
        near = state.contact_set | (g <= h)
        if h <= 0 or (lever := _least_singular(rows[near]) - lost) <= 0:
            continue
        on = Definiteness.of(D[near], M[np.ix_(near, near)], ell[near])
        if not on.definite or on.eigenvalue is None:
            continue
        B = start
        for _ in range(ROUNDS):
            work = max(-whole.certain, 0.0) * B**2 + B * residual
            rest = work / h * (1 + 1 / lever)
            half = norm * rest + residual / 2
            v = (half + np.sqrt(half**2 + on.certain * rest * (norm * rest + residual))) / on.certain
            B = min(B, v + rest)
        found = min(found, float(S.max()) * B if start > B else np.inf)
    return found


def largest_sum(rows: Array, y: Array, lost: float) -> float:
    """Bound of the sum of any p >= 0 with rowsᵀp = rowsᵀy, rows (n, k) but for `lost`; infinity if there is none.

    By duality it is yᵀ(rows v) if rows v >= 1 for all points: no tolerance of the program that gives v enters.
    """
    most = scipy.optimize.linprog(-np.ones(len(y)), A_eq=rows.T, b_eq=rows.T @ y, bounds=(0, None))
    if most.status != 0:
        return np.inf
    v = -most.eqlin.marginals
    share = rows @ v
    least = float(share.min()) - lost * float(np.linalg.norm(v))
    return float(np.maximum(share, 0.0) @ y) / least if least > 0 else np.inf


def _largest_pressure(whole: Definiteness, y: Array, pull: Array) -> float:
    """Bound of |f*| of all f* >= 0 with f*ᵀK f* = pullᵀf*, for K without free motions; infinity if there is none."""
    values, vectors = eigh(whole.form)
    round_off = 2 * (float(values[0]) - whole.certain)
    for null in NULL:
        m = int(np.count_nonzero(values <= null))
        if m == len(values):
            continue
        opposed = np.maximum(-vectors[:, :m] @ vectors[:, :m].T, 0.0)  # N, but for its size
        form = whole.form - values[m] * opposed - round_off * np.eye(len(values))
        least = least_eigenvalue(form)
        if least > round_off:
            load = np.maximum(form @ y, pull)
            return SURE * float(np.sqrt(load @ np.linalg.solve(form, load) / least))
    return np.inf


def _least_singular(rows: Array) -> float:
    """Least singular value of rows (m, k); zero if they are fewer than k, and infinite if k = 0."""
    if not rows.shape[1]:
        return np.inf
    return float(np.linalg.svd(rows, compute_uv=False)[-1]) if len(rows) >= rows.shape[1] else 0.0
