"""Make a contact problem dimensionless, and bring its solution back: one pair.

Displacement is divided by U, pressure by T (`CondensedContact.scales`), weights by the largest one, and each free
motion by its own largest component along the normals. A change of units leaves the numbers here
unchanged.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bemcontact.actions import Change
from bemcontact.arrays import Array
from bemcontact.choices import Weights
from bemcontact.contact import CondensedContact
from bemcontact.contact_scales import ContactScales


@dataclass(frozen=True, kw_only=True, eq=False)
class ScaledContact:
    """gap = q + M p + R a >= 0, p >= 0, p·gap = 0, Rᵀ J p = -load, in dimensionless numbers.

    Parameters
    ----------
    compliance : (n, n) M, of norm ‖M‖∞ = 1
    offset : (n,) q
    rigid_motions : (n, k) R, the largest entry of each column 1
    motion_load : (k,) load
    weights : (n,) tributary J, the largest entry 1
    """

    compliance: Array
    offset: Array
    rigid_motions: Array
    motion_load: Array
    weights: Array

    @cached_property
    def equilibrium(self) -> Array:
        """ℓ = J R (n, k)."""
        return self.weights[:, None] * self.rigid_motions

    @property
    def equilibrium_space(self) -> Array:
        """Z (n, n - k), an orthonormal basis of {p : ℓᵀp = 0}."""
        return np.linalg.qr(self.equilibrium, mode="complete")[0][:, self.rigid_motions.shape[1] :]

    def gap(self, pressure: Array, amplitudes: Array) -> Array:
        """δ = q + M p + R a, (n,)."""
        return self.offset + self.compliance @ pressure + self.rigid_motions @ amplitudes

    def residual(self, pressure: Array, amplitudes: Array) -> float:
        """Largest of |min(p, δ)| and |ℓᵀp + load| / Σ|ℓ|, over the size 1 + max|p| + Σ|a| of the numbers in them."""
        natural = np.abs(np.minimum(pressure, self.gap(pressure, amplitudes)))
        balance = np.abs(self.equilibrium.T @ pressure + self.motion_load) / np.abs(self.equilibrium).sum(axis=0)
        size = 1.0 + np.abs(pressure).max(initial=0.0) + np.abs(amplitudes).sum()
        return float(max(natural.max(initial=0.0), balance.max(initial=0.0)) / size)


def scaled(condensed: CondensedContact, scales: ContactScales | None = None) -> ScaledContact:
    """Take the units out of a contact problem.

    Parameters
    ----------
    condensed : CondensedContact
    scales : other ones than those of the problem, which depend on its load; then ‖M‖∞ = 1 only if U = ‖M‖∞ T

    Returns
    -------
    ScaledContact
    """
    U, T = scales or condensed.scales
    weight = condensed.weights.max()
    motion = motion_sizes(condensed)
    return ScaledContact(
        compliance=condensed.compliance * (T / U),
        offset=condensed.offset / U,
        rigid_motions=condensed.rigid_motions / motion,
        motion_load=condensed.motion_load / (motion * weight * T),
        weights=condensed.weights / weight,
    )


def scaled_weights(condensed: CondensedContact, weights: Weights) -> Array:
    """J (n, n) over its largest entry."""
    J = condensed.weight_matrix(weights)
    return J / np.abs(J).max()


def scaled_point(condensed: CondensedContact, pressure: Array, amplitudes: Array) -> tuple[Array, Array]:
    """Take the units out of a pressure (n,) [p] and amplitudes (k,)."""
    U, T = condensed.scales
    return pressure / T, amplitudes * motion_sizes(condensed) / U


def scaled_change(condensed: CondensedContact, change: Change) -> Change:
    """Take the units out of an offset (n,) [L] and a load (k,), or of a change of both."""
    U, T = condensed.scales
    return Change(change.offset / U, change.motion_load / (motion_sizes(condensed) * condensed.weights.max() * T))


def unscaled(condensed: CondensedContact, pressure: Array, amplitudes: Array) -> tuple[Array, Array, Array]:
    """Put the units of a contact problem back into a solution of `scaled`.

    Parameters
    ----------
    condensed : CondensedContact
    pressure : (n,) p, dimensionless
    amplitudes : (k,) a, dimensionless

    Returns
    -------
    pressure : (n,) [p]
    displacement : (n,) u_n = Δ1 + M p + R a [L]
    amplitudes : (k,) in the user's units
    """
    U, T = condensed.scales
    p, a = pressure * T, amplitudes * U / motion_sizes(condensed)
    return p, condensed.free_displacement + condensed.compliance @ p + condensed.rigid_motions @ a, a


def motion_sizes(condensed: CondensedContact) -> Array:
    """Largest normal component of each free motion, (k,).

    Parameters
    ----------
    condensed : CondensedContact
    """
    return np.abs(condensed.rigid_motions).max(axis=0, initial=0.0)
