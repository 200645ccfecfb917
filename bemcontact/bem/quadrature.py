"""Gauss-Legendre rules, and which one an integral over a curved element needs.

The integrands are analytic in ξ but for a pole or logarithm at the root r of the element map, ζ(r) = z, z the
collocation point. With ρ = |r + sqrt(r² - 1)| >= 1, the Bernstein ellipse through r (Trefethen, Approximation Theory
and Approximation Practice, ch. 19), the residues at r show that an n-point rule errs by about 2n ρ^-(2n-1) for the
double pole in B and by ρ^-(2n-2)/(2n) for the logarithm in L; the pole in A lies between.
"""

from functools import lru_cache

import numpy as np

from bemcontact.arrays import Array, ComplexArray, IntArray

TOLERANCE = 1e-14
"""Error of one integral over one element, relative to integrals of order one."""

ORDERS = np.array([3, 4, 5, 6, 7, 8, 10, 12, 14, 17, 20, 23])
"""Numbers of Gauss points to choose from."""

RHO_OF_T = (2 * ORDERS / TOLERANCE) ** (1 / (2 * ORDERS - 1))
"""The ρ from which each rule is good enough for the integrals of T, decreasing."""

SMALLEST_RHO = np.maximum(RHO_OF_T, (2 * ORDERS * TOLERANCE) ** (-1 / (2 * ORDERS - 2)))
"""The same for T and U; below the last one the singularity is taken out first."""


@lru_cache(maxsize=32)
def gauss_legendre(order: int) -> tuple[Array, Array]:
    """Abscissae and weights (order,) on -1 <= ξ <= 1, read-only."""
    xi, weights = np.polynomial.legendre.leggauss(order)
    xi.setflags(write=False)
    weights.setflags(write=False)
    return xi, weights


def bernstein_parameter(root: ComplexArray) -> Array:
    """ρ >= 1 of the ellipse with foci -1, 1 through each root."""
    step = np.sqrt(root - 1) * np.sqrt(root + 1)
    return np.maximum(abs(root + step), abs(root - step))


def tier(rho: Array, smallest: Array = SMALLEST_RHO) -> IntArray:
    """Index into `ORDERS` of the cheapest sufficient rule; `len(ORDERS)` where none is."""
    return np.searchsorted(-smallest, -np.asarray(rho), side="left")
