"""The equations of contact in dimensionless numbers with their round-off, and pressures in equilibrium.

Ordinary sums know δ = q + M y + R a to n ε (|q| + |M||y| + |R||a|). Where a body turns easily, about a short edge that
holds it, the terms are far larger than δ. Then they are added without rounding, of the numbers as they are stored:
units are powers of two, and what rounding takes from q = ε + Δ1 and ℓ = J R is added too.
"""

from typing import Self

import numpy as np
import scipy
from numpy.typing import NDArray

from bemcontact.arrays import (
    Array,
    exact_remainders,
    least_squares,
    norm,
    powers_of_two,
    product_remainders,
    row_norms,
    short_svd,
    sum_remainders,
)
from bemcontact.assessment.definiteness import EPS
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.frozen import frozen

KNOWN = 1e-6
"""Relative accuracy that is demanded of a step to equilibrium."""
NEWTON_STEPS = 20
TIE = 1e-6
"""Relative difference of gaps that round-off may decide."""
SAFE = 2.0
"""Factor of what linear programs say of pressures: more than they can be off."""


@frozen
class ContactEquations:
    """δ = q + M y + R a with weights D, and ℓᵀy = -load, in units of a gap and a pressure.

    Parameters
    ----------
    units : gap [L], pressure [p]
    weights : (n,) D, the largest about one
    compliance, offset, rigid_motions : M (n, n) with ‖M‖∞ about one, q (n,), R (n, k)
    equilibrium, load : ℓ (n, k) with columns of length about one, and the load (k,) to match
    offset_rest, equilibrium_rest : what rounding took from q = ε + Δ1 and from the products ℓ = J R; empty if not exact
    exact : whether all units are powers of two, and sums are rounded once
    """

    units: tuple[float, float]
    weights: Array
    compliance: Array
    offset: Array
    rigid_motions: Array
    equilibrium: Array
    load: Array
    offset_rest: Array
    equilibrium_rest: Array
    exact: bool

    @classmethod
    def of(cls, contact: CondensedContact, *, exact: bool = False) -> Self:
        """Take the units out of a contact problem."""
        rounded = powers_of_two if exact else np.asarray
        U, T = rounded(np.array(contact.scales)).tolist()
        length = rounded(row_norms(contact.equilibrium.T))
        offset_rest, ell_rest = contact.offset[:0], contact.equilibrium[:0]
        if exact:
            offset_rest = sum_remainders(contact.initial_gap, contact.free_displacement)
            ell_rest = product_remainders(contact.weights[:, None], contact.rigid_motions)
        return cls(
            units=(U, T),
            weights=contact.weights / rounded(contact.weights.max()),
            compliance=contact.compliance * (T / U),
            offset=contact.offset / U,
            rigid_motions=contact.rigid_motions,
            equilibrium=contact.equilibrium / length,
            load=contact.motion_load / (length * T),
            offset_rest=offset_rest / U,
            equilibrium_rest=ell_rest / length,
            exact=exact,
        )

    def gaps(self, y: Array, a: Array) -> tuple[Array, Array]:
        """δ (n,) and its round-off."""
        D, q, M, R = self.weights, self.offset, self.compliance, self.rigid_motions
        if not self.exact:
            terms = np.abs(q) + np.abs(M) @ y + np.abs(R) @ np.abs(a)
            return q + M @ y + R @ a, len(D) * EPS * terms
        columns = np.concatenate([self.offset_rest[:, None], M, R], axis=1)
        delta = exact_remainders(q, -columns, np.concatenate([[1.0], y, a]))
        return delta, 2 * EPS * (np.abs(delta) + np.abs(R) @ np.abs(a))

    def imbalance(self, y: Array) -> tuple[Array, Array]:
        """ℓᵀy + load (k,), and its round-off where the numbers are not exact."""
        ell, load = self.equilibrium, self.load
        if self.exact:
            left = exact_remainders(load, -np.hstack([ell.T, self.equilibrium_rest.T]), np.concatenate([y, y]))
            return left, EPS * np.abs(left)
        return exact_remainders(load, -ell.T, y), 2 * EPS * (np.abs(ell).T @ y + np.abs(load))

    def step_to_balance(self, y: Array, least: float) -> tuple[Array, float]:
        """A step (n,) of points that carry more than `least` after which ℓᵀy = -load but for a step of this size."""
        step, ell = np.zeros(len(y)), self.equilibrium[y > least]
        if not ell.shape[1] or not len(ell):
            return step, least
        left = self.imbalance(y)[0]
        step[y > least] = -least_squares(ell.T, left)
        rest = np.linalg.norm(left + self.equilibrium.T @ step)
        if rest > KNOWN * np.linalg.norm(left) or np.linalg.norm(step) > least:
            return np.zeros(len(y)), least
        return step, KNOWN * least


def round_off_of_equilibrium(
    equations: ContactEquations, y: Array, gaps: Array, round_off: Array
) -> tuple[float, Array, Array | None]:
    """How far y (n,) may be from exact balance: the least change of points that carry which takes ℓᵀy + load away.

    Points side by side carry a moment by large pressures only. A point whose pressure is no more than that error may
    not carry at all. Infinite if some load is carried by round-off only. With it the pressures (n,) of points without
    pressure that this takes where those that carry lack directions; or, if they lack one, the gaps Dδ (n,) that are
    left where the body tilts onto one such point, whichever the direction. `gaps` are Dδ (n,) with their round-off.
    """
    least, change, beside, tilted = -1.0, 0.0, np.zeros(len(y)), None
    ell = equations.equilibrium
    if not ell.shape[1]:
        return change, beside, tilted
    while change < np.inf and (least < 0 or ((y > least) & (y <= change)).any()):
        least = change
        carried = np.where(y > least, y, 0.0)
        left, lost = equations.imbalance(carried)
        left = np.abs(left) + lost
        size, beside, tilted = _least_change(ell, y > least, left, gaps, round_off)
        change = max(change, size + norm(y - carried))
    return change, np.where(y > 0, 0.0, beside), tilted


def _least_change(
    ell: Array, carries: NDArray[np.bool_], left: Array, gaps: Array, round_off: Array
) -> tuple[float, Array, Array | None]:
    """Bound of the least pressures that carry loads up to left (k,), infinity if none do; the rest as is returned.

    Points that carry may lose pressure. Where their rows of ℓ (n, k) lack directions, others gain pressure.
    """
    lost, beside = len(ell) * EPS, np.zeros(len(ell))
    if not left.any():
        return 0.0, beside, None
    own = ell[carries]
    sizes, axes = short_svd(own)
    if (rank := int(np.count_nonzero(sizes > lost))) == ell.shape[1]:  # rows of the pseudo-inverse are these times Uᵀ
        return float(row_norms(axes.T / sizes) @ left), beside, None
    if rank == ell.shape[1] - 1:
        return _tilted(ell, carries, left, gaps, round_off, axes[-1])
    columns, size = np.vstack([ell, -ell[carries]]).T, 0.0
    for load, part in zip(np.eye(len(left))[left > 0], left[left > 0], strict=True):
        cost = np.ones(columns.shape[1])
        ends = [scipy.optimize.linprog(cost, A_eq=columns, b_eq=sign * load) for sign in (1.0, -1.0)]
        if any(end.status != 0 for end in ends):
            return np.inf, beside, None
        size += float(max(end.fun for end in ends)) * part
        beside += np.maximum(*(end.x[: len(ell)] for end in ends)) * part
    return SAFE * size, SAFE * beside, None


def _tilted(
    ell: Array, carries: NDArray[np.bool_], left: Array, gaps: Array, round_off: Array, lacking: Array
) -> tuple[float, Array, Array | None]:
    """As `_least_change` where one direction (k,) is lacking: in it the body tilts onto the point that it meets first.

    The points that carry do not see this motion, and no other gap becomes negative, so that no work is done.
    """
    lost, lever, size = len(ell) * EPS, ell @ lacking, 0.0
    inverse = np.linalg.norm(np.linalg.pinv(ell[carries], rcond=lost), axis=1)
    tilted = np.full(len(ell), np.inf)
    if np.abs(lacking) @ left <= lost * np.linalg.norm(left):
        return float(inverse @ left), np.zeros(len(ell)), None
    for sign in (1.0, -1.0):
        may = ~carries & (sign * lever > 2 * lost)
        if not may.any():
            return np.inf, np.zeros(len(ell)), None
        rest = gaps - sign * lever * (gaps[may] / (sign * lever[may])).min()
        met = may & (rest <= TIE * gaps + 2 * round_off)
        pressure = float(np.abs(lacking) @ left / np.abs(lever[met]).min())
        size = max(size, pressure + float(inverse @ (left + np.abs(ell[met]).max(axis=0) * pressure)))
        tilted = np.minimum(tilted, np.where(carries, np.inf, rest))
    return SAFE * size, np.zeros(len(ell)), tilted


def balanced(equations: ContactEquations, p: Array, touching: NDArray[np.bool_]) -> Array | None:
    """A scaled pressure near p in equilibrium: zero off the contact set, or without that if the set carries no load."""
    y = _nearest_balanced(equations, p, touching)
    return _nearest_balanced(equations, p, np.ones_like(touching)) if y is None else y


def _nearest_balanced(equations: ContactEquations, p: Array, contact_set: NDArray[np.bool_]) -> Array | None:
    """The y >= 0 nearest to p with ℓᵀy = -load and y = 0 off the contact set: y = max(p + ℓ b, 0), Newton on b (k,)."""
    ell, load = equations.equilibrium, equations.load
    b = np.zeros(len(load))
    for _ in range(NEWTON_STEPS):
        y = np.where(contact_set, np.maximum(p + ell @ b, 0.0), 0.0)
        imbalance = ell.T @ y + load
        touching = ell[y > 0]
        if np.abs(imbalance).max(initial=0.0) <= 1e-14 * (1.0 + np.abs(p).sum()):
            y[y > 0] -= least_squares(touching.T, equations.imbalance(y)[0])
            return np.maximum(y, 0.0)
        b -= least_squares(touching.T @ touching, imbalance)
    return None
