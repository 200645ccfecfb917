"""The three quadratic shape functions on -1 <= ξ <= 1, with nodes at -1, 0, 1.

Axes: the last one counts the local nodes. Displacement, geometry and t·J (traction times Jacobian) share them.
"""

import numpy as np

from bemcontact.arrays import Array

NODES = np.array([-1.0, 0.0, 1.0])
"""Local coordinate of each node."""

MONOMIALS = np.array([[0.0, -0.5, 0.5], [1.0, 0.0, -1.0], [0.0, 0.5, 0.5]])
"""N_k = Σ_j MONOMIALS[k, j] ξ^j."""

DERIVATIVE_MONOMIALS = np.array([[-0.5, 1.0, 0.0], [0.0, -2.0, 0.0], [0.5, 1.0, 0.0]])
"""dN_k/dξ = Σ_j DERIVATIVE_MONOMIALS[k, j] ξ^j."""

INTEGRALS = np.array([1.0, 4.0, 1.0]) / 3
"""∫ N_k dξ: Simpson's rule, and the tributary share of each node."""


def values(xi: Array) -> Array:
    """N_k at ξ: shape of `xi` plus (3,)."""
    return np.stack([np.ones_like(xi), xi, xi * xi], axis=-1) @ MONOMIALS.T


def derivatives(xi: Array) -> Array:
    """dN_k/dξ at ξ: shape of `xi` plus (3,)."""
    return np.stack([np.ones_like(xi), xi, xi * xi], axis=-1) @ DERIVATIVE_MONOMIALS.T
