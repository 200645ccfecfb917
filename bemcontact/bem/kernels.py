"""Kelvin's plane kernels, integrated over quadratic elements: four complex integrals per shape function.

With τ = ζ - z, ζ on the element and z the collocation point, in complex notation (shear modulus G, κ = 3 - 4ν):

    ∫ U t ds = 1/(8πG(1-ν)) Σ_k [-κ L_k t_k + w_k t_k / 2 + M_k conj(t_k) / 2]
    ∫ T u ds = i/(8π(1-ν)) Σ_k [(κ A_k - conj(A_k)) u_k + B_k conj(u_k)]

    A_k = ∫ N_k d ln τ      B_k = ∫ N_k d(τ / conj τ)      L_k = ∫ N_k ln|τ| dξ      M_k = ∫ N_k (τ / conj τ) dξ

Here t_k stands for traction times Jacobian, which is what the shape functions interpolate; w_k = ∫ N_k dξ.
All integrals are the limits for z coming from *outside* the body (the body is on the left of the element's direction):
the free term of Somigliana's identity is then part of A, at corners of any angle.

Far from z, Gauss's rules (`regular`). Near z, the root r of the element map, τ = (ξ - r)(c2 ξ + c1 + c2 r), is split
off exactly and what is left is smooth (`Singular`). The idea of integrating against the pole found by
continuation of the map: Helsing and Ojala (2008), af Klinteberg and Barnett (2021); the closed forms are ours.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from bemcontact.arrays import Array, ComplexArray
from bemcontact.bem.reference_element import (
    DERIVATIVE_MONOMIALS,
    INTEGRALS,
    MONOMIALS,
    NODES,
    ORDERS,
    bernstein_parameter,
    derivatives,
    gauss_legendre,
    tier,
    values,
)

SMOOTH_ORDERS = np.append(ORDERS, 96)
"""Gauss points for what is left after the nearest root was split off, by the rule that the second root needs."""
FAR_ROOT = 100.0
"""Distance from which the second root counts as far away."""


class Integrals(NamedTuple):
    """A, B, L, M for a set of p (point, element) pairs, each (p, 3)."""

    A: ComplexArray
    B: ComplexArray
    L: Array
    M: ComplexArray


class Components(NamedTuple):
    """The integrals of T and U by components: T (4, 3, …) in the order of `T_ORDER`, U (3, 3, …) likewise, or None.

    The second axis counts the local nodes, the others are those of the pairs.
    """

    T: Array
    U: Array | None


T_ORDER = ((0, 0), (1, 1), (0, 1), (1, 0))
"""Equation and displacement component of each entry of T."""
U_ORDER = ((0, 0), (1, 1), (0, 1))
"""Equation and traction component of each entry of U, which is symmetric."""


class Factors(NamedTuple):
    """Factors of the integrals, with κ = 3 - 4ν, c = 1/(8π(1-ν)), stresses over the shear modulus.

    T_xx, T_yy = normal Im A ∓ skew Re S, T_xy, T_yx = ∓tangential Re A - skew Im S with B = 2i S;
    U_xx, U_yy = -log L + turn (w ± Re M), U_xy = turn Im M.
    """

    normal: float
    tangential: float
    skew: float
    log: float
    turn: float


def factors(poisson_ratio: float) -> Factors:
    """Factors for an effective Poisson ratio of plane strain."""
    c, kappa = 1 / (8 * np.pi * (1 - poisson_ratio)), 3 - 4 * poisson_ratio
    return Factors(normal=-c * (kappa + 1), tangential=c * (kappa - 1), skew=2 * c, log=c * kappa, turn=c / 2)


def components(integrals: Integrals, factor: Factors) -> Components:
    """Turn complex integrals (p, 3) into components, T (4, 3, p) and U (3, 3, p)."""
    A, B, L, M = integrals.A.T, integrals.B.T, integrals.L.T, integrals.M.T
    n, t = factor.normal * A.imag, factor.tangential * A.real
    cos, sin = factor.skew * (B / 2j).real, factor.skew * (B / 2j).imag
    log, turn = factor.turn * INTEGRALS[:, None] - factor.log * L, factor.turn * M
    T = np.array([n - cos, n + cos, -t - sin, t - sin])
    return Components(T, np.array([log + turn.real, log - turn.real, turn.imag]))


class GaussRule(NamedTuple):
    """A Gauss rule with n points, and the matrices by which it sums the integrands of `regular`.

    shapes, derivatives : (3, n) N_k and dN_k/dξ
    both : (2n, 3) their transposes, one below the other
    weighted : (3, n) N_k times the weights
    T_diagonal, T_cross : (6, 2n) for [Re S, Im A] and [Im S, Re A]
    U_diagonal, U_cross : (6, 2n) for [ln|τ|², Re τ/conj τ] and (3, n) for Im τ/conj τ
    U_constant : (6, 1) what is added to the former
    """

    shapes: Array
    derivatives: Array
    both: Array
    weighted: Array
    T_diagonal: Array
    T_cross: Array
    U_diagonal: Array
    U_cross: Array
    U_constant: Array


@lru_cache(maxsize=64)
def gauss_rule(order: int, factor: Factors) -> GaussRule:
    """Prepare a rule of so many points; its arrays are shared and must not be changed."""
    xi, weights = gauss_legendre(order)
    shapes = values(xi).T
    S = shapes * weights
    normal, tangential, skew = factor.normal * S, factor.tangential * S, factor.skew * S
    log, turn = factor.log / 2 * S, factor.turn * S
    return GaussRule(
        shapes=shapes,
        derivatives=derivatives(xi).T,
        both=np.vstack([shapes.T, derivatives(xi)]),
        weighted=S,
        T_diagonal=np.block([[-skew, normal], [skew, normal]]),
        T_cross=np.block([[-skew, -tangential], [-skew, tangential]]),
        U_diagonal=np.block([[-log, turn], [-log, -turn]]),
        U_cross=turn,
        U_constant=factor.turn * np.tile(INTEGRALS, 2)[:, None],
    )


def numerators(nodes: Array, rule: GaussRule) -> Array:
    """|τ|², Re τ², Im(conj(τ) ζ'), Im τ², Re(conj(τ) ζ') (5, n, p) at the Gauss points of p pairs.

    `nodes` (3, 2, p) are the real and the imaginary parts of τ = ζ - z at the nodes.
    """
    at = (rule.both @ nodes.reshape(3, -1)).reshape(2, len(rule.both) // 2, 2, -1)
    (x, dx), (y, dy) = at[:, :, 0], at[:, :, 1]
    result = np.empty((5, *x.shape))
    xx, yy = x * x, y * y
    np.add(xx, yy, out=result[0])
    np.subtract(xx, yy, out=result[1])
    np.subtract(np.multiply(x, dy, out=xx), np.multiply(y, dx, out=yy), out=result[2])
    np.multiply(x, y, out=result[3])
    result[3] *= 2
    np.add(np.multiply(x, dx, out=xx), np.multiply(y, dy, out=yy), out=result[4])
    return result


def numerator_polynomials(zeta: ComplexArray, tangent: ComplexArray) -> Array:
    """`numerators` as polynomials in the point z: coefficients (6, 5, n, e) at Gauss points ζ, ζ' (n, e) of e elements.

    Their product with `point_powers` is every pair of an element and a point. With ζ and z counted from the middle of
    the points, elements farther away from all points than half their radius lose one digit.
    """
    square, along = zeta * zeta, zeta.conj() * tangent
    result = np.zeros((6, 5, *zeta.shape))
    result[0] = (zeta * zeta.conj()).real, square.real, along.imag, square.imag, along.real
    result[1] = -2 * zeta.real, -2 * zeta.real, -tangent.imag, -2 * zeta.imag, -tangent.real
    result[2] = -2 * zeta.imag, 2 * zeta.imag, tangent.real, -2 * zeta.real, -tangent.imag
    result[3, 1] = result[4, 3] = result[5, 0] = 1
    return result


def point_powers(z: ComplexArray) -> Array:
    """1, x, y, Re z², Im z², |z|² (6, R) of points z."""
    return np.stack([np.ones(len(z)), z.real, z.imag, (z * z).real, (z * z).imag, (z * z.conj()).real])


def regular(integrands: Array, rule: GaussRule, *, with_U: bool) -> Components:
    """Gauss's rule, for pairs with a root that is far enough away.

    Parameters
    ----------
    integrands : (5, n, …) as from `numerators`, or `numerator_polynomials` at points; overwritten
    rule : with n points
    with_U : whether the integrals of U are wanted
    """
    _, n, *pairs = integrands.shape
    square, cos, normal, sin, _ = integrands
    rows = integrands.reshape(5 * n, -1)
    integrands[1:] *= np.divide(1, square, out=None if with_U else square)
    U = None
    if with_U:
        np.log(square, out=square)
        U = np.empty((9, rows.shape[1]))
        np.matmul(rule.U_diagonal, rows[: 2 * n], out=U[:6])
        np.matmul(rule.U_cross, rows[3 * n : 4 * n], out=U[6:])
        U[:6] += rule.U_constant
        U = U.reshape(3, 3, *pairs)
    cos *= normal
    sin *= normal
    T = np.empty((12, rows.shape[1]))
    np.matmul(rule.T_diagonal, rows[n : 3 * n], out=T[:6])
    np.matmul(rule.T_cross, rows[3 * n :], out=T[6:])
    return Components(T.reshape(4, 3, *pairs), U)


def element_coefficients(nodes: ComplexArray) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
    """c0, c1, c2 of ζ = c0 + c1 ξ + c2 ξ² from the three nodes (..., 3)."""
    first, middle, last = nodes[..., 0], nodes[..., 1], nodes[..., 2]
    return middle, (last - first) / 2, ((first - middle) + (last - middle)) / 2


class Root(NamedTuple):
    """The root r of the element map nearest to the element, with r - 1 and r + 1 to full relative accuracy."""

    r: ComplexArray
    minus: ComplexArray
    plus: ComplexArray


def nearest_root(tau: ComplexArray) -> Root:
    """Solve τ(r) = 0 for τ = ζ - z (p, 3) at the nodes, counted from the nearest one, so that no digit is lost."""
    _, c1, c2 = element_coefficients(tau)
    nearest = abs(tau).argmin(axis=1)
    start, at_start = NODES[nearest], tau[np.arange(len(tau)), nearest]
    slope = c1 + 2 * c2 * start
    root = np.sqrt(slope * slope - 4 * c2 * at_start)
    root = np.where((slope.conj() * root).real < 0, -root, root)
    step = -2 * at_start / (slope + root)
    return Root(start + step, (start - 1) + step, (start + 1) + step)


def root_from_middle(at_middle: ComplexArray, c1: ComplexArray, c2: ComplexArray) -> ComplexArray:
    """The root of τ = at_middle + c1 ξ + c2 ξ² nearest to the middle; digits are lost near the ends of an element."""
    root = np.sqrt(c1 * c1 - 4 * c2 * at_middle)
    root = np.where((c1.conj() * root).real < 0, -root, root)
    return -2 * at_middle / (c1 + root)


class Singular(NamedTuple):
    """Pairs (p, …) whose root is split off.

    Parameters
    ----------
    nodes : (p, 3) ζ at the nodes, or τ
    root : nearest to the element
    log_ratio : (p,) ∫ dξ/(ξ - r)
    end_turn : (p, 2) τ/conj τ at both ends, zero where τ vanishes
    """

    nodes: ComplexArray
    root: Root
    log_ratio: ComplexArray
    end_turn: ComplexArray

    def and_those(self, other: "Singular") -> "Singular":
        """These pairs, then others."""
        nodes, log_ratio, turn = (np.concatenate([self[i], other[i]]) for i in (0, 2, 3))
        return Singular(nodes, Root(*map(np.concatenate, zip(self.root, other.root, strict=True))), log_ratio, turn)


def beside_element(tau: ComplexArray, root: Root) -> Singular:
    """Pairs whose point is near the element but not on it, from τ = ζ - z (p, 3) at the nodes and its nearest root."""
    ends = tau[:, ::2]
    return Singular(tau, root, np.log(root.minus / root.plus), ends / ends.conj())


def on_element(nodes: ComplexArray, local: Array) -> Singular:
    """Pairs whose point lies on the element of nodes (p, 3), at ξ0 (p,); one-sided limits from outside the body.

    At an end of the element A_k of the node there diverges like ln|τ|; that part cancels against the neighbor's and
    is left out here: with the neighbor's share goes -i times the interior angle.
    """
    _, c1, c2 = element_coefficients(nodes)
    r = local.astype(complex)
    root = Root(r, r - 1, r + 1)
    at_end = abs(local) == 1
    inside = np.where(at_end, 0.0, local)
    interior = np.log((1 - inside) / (1 + inside)) - 1j * np.pi
    slope = abs(c1 + 2 * c2 * local)
    log_ratio = np.where(at_end, -local * np.log(2 * slope), interior)
    here = local * (c1 + local * c2)  # from the middle, for short elements have their digits in differences
    tau = np.column_stack([(c2 - c1) - here, (c2 + c1) - here])
    tau[local == -1, 0] = 0
    tau[local == 1, 1] = 0
    turn = np.divide(tau, tau.conj(), out=np.zeros_like(tau), where=tau != 0)
    return Singular(nodes, root, log_ratio, turn)


def with_root_split_off(pairs: Singular) -> Integrals:
    """A, B, L, M of pairs whose Gauss rules would need too many points."""
    nodes, root, log_ratio, end_turn = pairs
    _, c1, c2 = element_coefficients(nodes)
    r = root.r
    d = c1 + c2 * r
    xi, weights = gauss_legendre(_order_beside(c1, c2, r))
    powers = np.stack([np.ones_like(xi), xi, xi * xi])
    smooth = c2[:, None] * xi + d[:, None]

    shape_at_root = np.stack([r * root.minus, -2 * root.minus * root.plus, r * root.plus], axis=1) / 2
    quotient = np.stack([root.minus, -2 * r, root.plus], axis=1)
    A = shape_at_root * log_ratio[:, None] + quotient
    A += (c2[:, None] * weights / smooth) @ powers.T @ MONOMIALS.T

    moments = _turn_moments(c2, d, r, log_ratio, smooth, weights, powers)
    B = -moments @ DERIVATIVE_MONOMIALS.T
    B[:, 0] -= end_turn[:, 0]
    B[:, 2] += end_turn[:, 1]
    L = (_log_moments(root) + (weights * np.log(abs(smooth))) @ powers.T) @ MONOMIALS.T
    return Integrals(A, B, L, moments @ MONOMIALS.T)


def _order_beside(c1: ComplexArray, c2: ComplexArray, r: ComplexArray) -> int:
    """Gauss points for the smooth remainder: few where the second roots, of curved elements, are far."""
    curved = abs(c2) > abs(c1) / FAR_ROOT
    second = -c1[curved] / c2[curved] - r[curved]
    rho = bernstein_parameter(second).min(initial=FAR_ROOT)
    return int(SMOOTH_ORDERS[tier(rho)])


def _turn_moments(
    c2: ComplexArray, d: ComplexArray, r: ComplexArray, log_ratio: ComplexArray, smooth: ComplexArray,
    weights: Array, powers: Array,
) -> ComplexArray:  # fmt: skip
    """∫ ξ^j τ/conj(τ) dξ, j = 0, 1, 2, as (p, 3).

    τ/conj τ = h(ξ) (ξ - r)/(ξ - s) with s = conj(r), h = (c2 ξ + d)/(conj(c2) ξ + conj(d)), and
    ξ^j h = s^j h(s) + (ξ - s) [(ξ^j - s^j)/(ξ - s) h + s^j h[ξ, s]], h[ξ, s] the divided difference.
    """
    s = r.conj()
    h = smooth / smooth.conj()
    result = (h * weights) @ powers.T
    off = s != r
    if not off.any():
        return result
    c2, d, s, h, smooth = c2[off], d[off], s[off], h[off], smooth[off]
    at_s = c2.conj() * s + d.conj()
    h_at_s = (c2 * s + d) / at_s
    difference = (2j * (c2 * d.conj()).imag / at_s)[:, None] / smooth.conj()
    s_powers = np.stack([np.ones_like(s), s, s * s], axis=1)
    h_moments = (h * weights) @ powers[:2].T
    quotient = np.stack([np.zeros_like(s), h_moments[:, 0], h_moments[:, 1] + s * h_moments[:, 0]], axis=1)
    pole = (h_at_s * log_ratio[off].conj() + difference @ weights)[:, None] * s_powers + quotient
    result[off] += (s - r[off])[:, None] * pole
    return result


def _log_moments(root: Root) -> Array:
    """∫ ξ^j ln|ξ - r| dξ, j = 0, 1, 2, as (p, 3), by parts from ξ = r."""
    r, one = root.r, np.ones_like(root.r)
    at_end = [-root.plus, -root.minus]  # ξ - r at ξ = -1, 1
    logs = [value * np.log(np.where(value == 0, 1, value)) for value in at_end]
    primitive = [np.stack([one, (x + r) / 2, (1 + x * r + r * r) / 3], axis=1) for x in (-1, 1)]
    inner = np.stack([2 * one, r, (2 / 3 + 2 * r * r) / 3], axis=1)
    return (primitive[1] * logs[1][:, None] - primitive[0] * logs[0][:, None] - inner).real
