"""The reference element -1 <= ξ <= 1: quadratic shape functions with nodes at -1, 0, 1, and Gauss-Legendre rules.

The last axis of shape functions counts the local nodes. Displacement, geometry and t·J (traction times Jacobian) share
them.

The integrands over a curved element are analytic in ξ but for a pole or a logarithm at the root r of the element map,
ζ(r) = z, with z the collocation point. With ρ = |r + sqrt(r² - 1)| >= 1, the Bernstein ellipse through r (Trefethen,
Approximation Theory and Approximation Practice, ch. 19), the residues at r show that an n-point rule errs by about
2n ρ^-(2n-1) for the double pole in B and by ρ^-(2n-2)/(2n) for the logarithm in L; the pole in A lies between.
"""

from functools import lru_cache

import numpy as np

from bemcontact.arrays import Array, ComplexArray, IntArray

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


DERIVATIVES_AT_NODES = derivatives(NODES)
"""dN_k/dξ (3, 3) at each node."""

TOLERANCE = 1e-14
"""Error of one integral over one element, relative to integrals of order one."""

ORDERS = np.array([3, 4, 5, 6, 7, 8, 10, 12, 14, 17, 20, 23])
"""Numbers of Gauss points to choose from."""

RHO_OF_T = (2 * ORDERS / TOLERANCE) ** (1 / (2 * ORDERS - 1))
"""Least ρ for which each rule is accurate enough for the integrals of T, decreasing."""

SMALLEST_RHO = np.maximum(RHO_OF_T, (2 * ORDERS * TOLERANCE) ** (-1 / (2 * ORDERS - 2)))
"""Least ρ of each rule for the integrals of T and U; below the last one the singularity is split off first."""


@lru_cache(maxsize=32)
def gauss_legendre(order: int) -> tuple[Array, Array]:
    """Abscissae and weights (order,) on -1 <= ξ <= 1, read-only."""
    xi, weights = np.polynomial.legendre.leggauss(order)
    xi.setflags(write=False)
    weights.setflags(write=False)
    return xi, weights


@lru_cache(maxsize=4)
def half_rule(order: int) -> tuple[Array, Array]:
    """dN_k/dξ (2 order, 3) at the Gauss points of both halves of the element, and the weights (order,), read-only."""
    xi, weights = gauss_legendre(order)
    slopes = derivatives(np.concatenate([xi / 2 - 0.5, xi / 2 + 0.5]))
    slopes.setflags(write=False)
    return slopes, weights


def bernstein_parameter(root: ComplexArray) -> Array:
    """ρ >= 1 of the ellipse with foci -1, 1 through each root."""
    half = np.maximum((abs(root - 1) + abs(root + 1)) / 2, 1.0)  # the larger half-axis, (ρ + 1/ρ) / 2
    return half + np.sqrt((half - 1) * (half + 1))


def tier(rho: Array, smallest: Array = SMALLEST_RHO) -> IntArray:
    """Index into `ORDERS` of the cheapest sufficient rule; `len(ORDERS)` where none is."""
    return np.searchsorted(-smallest, -np.asarray(rho), side="left")
