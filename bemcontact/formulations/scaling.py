"""Scaling: make a contact problem dimensionless, and put the units back into its solution.

Displacement is divided by U, pressure by T (`CondensedContact.scales`), weights by the largest one, and each free
motion by its own largest component along the normals. A change of units leaves the numbers here unchanged.
"""

import numpy as np

from bemcontact.arrays import Array
from bemcontact.cached import cached_property
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.free_motions import ContactScales, MotionAlgebra
from bemcontact.contact.load_cases import Change
from bemcontact.contact.solution import ContactSolution
from bemcontact.frozen import frozen
from bemcontact.options import Weights

ACCEPTED = 1e-11
"""Value of `ScaledContact.residual` up to which a point is a solution: a little above round-off."""


@frozen
class ScaledContact(MotionAlgebra):
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

    def gap(self, pressure: Array, amplitudes: Array) -> Array:
        """δ = q + M p + R a, (n,)."""
        return self.offset + self.compliance @ pressure + self.rigid_motions @ amplitudes

    @cached_property
    def matrix(self) -> Array:
        """W = [[M, R], [ℓᵀ, 0]] (n + k, n + k): W (p, a) + (q, load) is δ, then ℓᵀp + load."""
        n, size = len(self.offset), len(self.offset) + len(self.motion_load)
        matrix = np.zeros((size, size))
        matrix[:n, :n], matrix[:n, n:], matrix[n:, :n] = self.compliance, self.rigid_motions, self.equilibrium.T
        return matrix

    @cached_property
    def constant(self) -> Array:
        """q, then the load, (n + k,)."""
        return np.concatenate([self.offset, self.motion_load])

    def residual(self, pressure: Array, amplitudes: Array) -> float:
        """Largest of |min(p, δ)| and |ℓᵀp + load| / Σ|ℓ|, over the size 1 + max|p| + Σ|a| of the numbers in them."""
        n = len(pressure)
        numbers = np.concatenate([pressure, amplitudes])
        left, sizes = self.constant + self.matrix @ numbers, abs(numbers)
        left[:n] = np.minimum(pressure, left[:n])
        left[n:] /= self._levers
        return float(abs(left).max() / (1.0 + sizes[:n].max() + sizes[n:].sum()))

    @cached_property
    def _levers(self) -> Array:
        """Σ|ℓ| (k,): the largest ℓᵀp by pressures up to 1."""
        return np.abs(self.equilibrium).sum(axis=0)


def scale(contact: CondensedContact, scales: ContactScales | None = None) -> ScaledContact:
    """Take the units out of a contact problem.

    `scales` replace those of the problem, which depend on its load; then ‖M‖∞ = 1 only if U = ‖M‖∞ T.
    """
    U, T = scales or contact.scales
    weight = contact.weights.max()
    motion = motion_sizes(contact)
    return ScaledContact(
        compliance=contact.compliance * (T / U),
        offset=contact.offset / U,
        rigid_motions=contact.rigid_motions / motion,
        motion_load=contact.motion_load / (motion * weight * T),
        weights=contact.weights / weight,
    )


def scaled_weights(contact: CondensedContact, weights: Weights) -> Array:
    """J (n, n) over its largest entry."""
    J = contact.weight_matrix(weights)
    return J / np.abs(J).max()


def scaled_point(contact: CondensedContact, pressure: Array, amplitudes: Array) -> tuple[Array, Array]:
    """Take the units out of a pressure (n,) [p] and amplitudes (k,)."""
    U, T = contact.scales
    return pressure / T, amplitudes * motion_sizes(contact) / U


def scaled_change(contact: CondensedContact, change: Change) -> Change:
    """Take the units out of an offset (n,) [L] and a load (k,), or of a change of both."""
    U, T = contact.scales
    return Change(change.offset / U, change.motion_load / (motion_sizes(contact) * contact.weights.max() * T))


def unscaled(contact: CondensedContact, pressure: Array, amplitudes: Array) -> tuple[Array, Array, Array]:
    """Put the units back: p (n,) [p], u_n = Δ1 + M p + R a (n,) [L] and a (k,) from dimensionless p and a."""
    p, a = unscaled_point(contact, pressure, amplitudes)
    return p, contact.free_displacement + contact.compliance @ p + contact.rigid_motions @ a, a


def unscaled_point(contact: CondensedContact, pressure: Array, amplitudes: Array) -> tuple[Array, Array]:
    """Put the units back: p (n,) [p] and a (k,) from dimensionless ones."""
    U, T = contact.scales
    return pressure * T, amplitudes * U / motion_sizes(contact)


def motion_sizes(contact: CondensedContact) -> Array:
    """Largest normal component of each free motion, (k,)."""
    return np.abs(contact.rigid_motions).max(axis=0, initial=0.0)


def contact_residual(contact: CondensedContact, solution: ContactSolution) -> float:
    """Largest of |min(p/T, δ/U)|, of (12) over U and of |ℓᵀp + load| over T Σ|ℓ|, over the size of the numbers."""
    scaled = scale(contact)
    p, a = scaled_point(contact, solution.pressure, solution.rigid_amplitudes)
    residual = solution.displacement - unscaled(contact, p, a)[1]
    size = 1.0 + float(np.abs(p).max(initial=0.0) + np.abs(a).sum())
    return max(scaled.residual(p, a), float(np.abs(residual).max()) / contact.scales.displacement / size)
