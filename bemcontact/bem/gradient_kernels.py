"""The displacement gradient at points inside a body: two complex integrals per shape function, no double pole left.

With τ = ζ - z, ζ on the element and z the point inside, in complex notation u + iv for displacement:

    ∂u/∂z  = c ((κ-1) Re S + i (κ+1) Im S)                            S = Σ_k J_k W_k
    ∂u/∂z̄ = c Σ_k [conj(J_k) (κ P_k + i D_k) + K_k conj(W_k)]         W_k = P_k - i D_k

    J_k = ∫ N_k dξ / τ        K_k = ∫ N_k (τ / conj τ²) dξ        c = 1/(8π(1-ν)), κ = 3 - 4ν

P_k is traction times Jacobian over 2G and D_k is du/dξ, at the local nodes. This is Somigliana's identity of `kernels`,
differentiated at z and integrated by parts along the closed boundary, on which displacement is continuous. Only the
change of displacement stands in it: a rigid translation gives no gradient at all, and no kernel is stronger than 1/τ.

Far from z, Gauss's rules. Near z, the root r of the element map τ = (ξ - r)(c2 ξ + d), d = c1 + c2 r, is split off as
in `kernels`: the poles at r and at s = conj r are integrated in closed form, and the divided differences that are left
are formed without subtracting equal numbers.
"""

from functools import cache
from typing import NamedTuple

import numpy as np

from bemcontact.arrays import Array, ComplexArray, IntArray
from bemcontact.bem import reference_element
from bemcontact.bem.kernels import SMOOTH_ORDERS, Root, element_coefficients
from bemcontact.bem.reference_element import MONOMIALS, bernstein_parameter, gauss_legendre

STRAIGHT = 1e-9
"""|c2| over |c1| below which the second root is too far away to matter."""


class GradientIntegrals(NamedTuple):
    """J and K for a set of p (point, element) pairs, each (p, 3)."""

    J: ComplexArray
    K: ComplexArray


def far_integrals(tau: ComplexArray, order: int) -> GradientIntegrals:
    """Gauss's rule, for pairs with a root that is far enough away, from τ = ζ - z (p, 3) at the nodes."""
    shapes, weighted = _shapes(order)
    at = tau @ shapes
    inverse = 1 / at
    return GradientIntegrals(inverse @ weighted, (at * (inverse * inverse).conj()) @ weighted)


@cache
def _shapes(order: int) -> tuple[ComplexArray, ComplexArray]:
    """Shape functions (3, order) at the Gauss points, and (order, 3) times the weights; complex as their factors."""
    xi, weights = gauss_legendre(order)
    shapes = reference_element.values(xi)
    return shapes.T.astype(complex), (shapes * weights[:, None]).astype(complex)


def near_integrals(tau: ComplexArray, root: Root) -> GradientIntegrals:
    """Pairs whose point is near the element but not on it, from τ (p, 3) at the nodes and its nearest root."""
    _, c1, c2 = element_coefficients(tau)
    J, K = np.empty((2, *tau.shape), complex)
    orders = _smooth_orders(c1, c2, root.r)
    for order in np.unique(orders):
        at = np.flatnonzero(orders == order)
        part = Root(root.r[at], root.minus[at], root.plus[at])
        J[at], K[at] = _split_off(c1[at], c2[at], part, int(order))
    return GradientIntegrals(J, K)


def _smooth_orders(c1: ComplexArray, c2: ComplexArray, r: ComplexArray) -> IntArray:
    """Gauss points (p,) for what is left after the nearest root has been split off: the second root decides."""
    curved = abs(c2) > STRAIGHT * abs(c1)
    rho = np.full(len(r), np.inf)
    rho[curved] = bernstein_parameter(-c1[curved] / c2[curved] - r[curved])
    return SMOOTH_ORDERS[reference_element.tier(rho)]


def _split_off(c1: ComplexArray, c2: ComplexArray, root: Root, order: int) -> GradientIntegrals:
    """J and K with a Gauss rule for the smooth parts."""
    xi, weights = gauss_legendre(order)
    r, d = root.r, c1 + c2 * root.r
    powers = np.stack([np.ones_like(xi), xi, xi * xi], axis=1) * weights[:, None]
    inverse = 1 / (c2[:, None] * xi + d[:, None])
    at_root, log_ratio = 1 / (c1 + 2 * c2 * r), np.log(root.minus / root.plus)
    rest = inverse @ powers
    simple = at_root * (log_ratio - c2 * rest[:, 0])  # ∫ dξ / τ
    once = r * simple + rest[:, 0]
    J = np.stack([simple, once, r * once + rest[:, 1]], axis=1)
    return GradientIntegrals(J @ MONOMIALS.T, _double_pole(c2, d, root, inverse.conj(), powers) @ MONOMIALS.T)


def _double_pole(c2: ComplexArray, d: ComplexArray, root: Root, w: ComplexArray, powers: Array) -> ComplexArray:
    """∫ ξ^j τ / conj(τ)² dξ, j = 0, 1, 2, as (p, 3), from w = 1/conj(c2 ξ + d) (p, n) and weights times 1, ξ, ξ².

    With s = conj(r) and ξ - r = (ξ - s) + (s - r) it is the sum of (c2 ξ + d) ξ^j w² over ξ - s and, times s - r, over
    (ξ - s)². For j = 0, with divided differences of w²:

        ∫ w²/(ξ - s)  = w(s)² Λ + ∫ w²[ξ, s]            Λ = ∫ dξ/(ξ - s)
        ∫ w²/(ξ - s)² = w(s)² Λ' + (w²)'(s) Λ + ∫ w²[ξ, s, s]

    Higher powers follow from ξ^(j+1)/(ξ - s) = ξ^j + s ξ^j/(ξ - s).
    """
    minus, plus, s, b = root.minus.conj(), root.plus.conj(), root.r.conj(), c2.conj()
    log_ratio, log_slope = np.log(minus / plus), 1 / minus - 1 / plus
    at_s = 1 / (b * s + d.conj())
    factor, at = -(b * at_s)[:, None], at_s[:, None]  # w[ξ, s] = factor w
    moments = (w * w) @ powers
    weights = powers[:, 0]
    pole = at_s**2 * log_ratio + (factor * w * (w + at)) @ weights
    double = at_s**2 * log_slope - 2 * b * at_s**3 * log_ratio + (factor**2 * w * (w + 2 * at)) @ weights
    terms = []
    for j in range(4):
        terms.append(pole + (s - root.r) * double)
        if j < 3:
            pole, double = s * pole + moments[:, j], s * double + pole
    return np.stack([d * terms[j] + c2 * terms[j + 1] for j in range(3)], axis=1)
