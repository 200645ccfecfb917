"""Kelvin's plane kernels, integrated over quadratic elements: four complex integrals per shape function.

With τ = ζ - z, ζ on the element and z the collocation point, in complex notation (shear modulus G, κ = 3 - 4ν):

    ∫ U t ds = 1/(8πG(1-ν)) Σ_k [-κ L_k t_k + w_k t_k / 2 + M_k conj(t_k) / 2]
    ∫ T u ds = i/(8π(1-ν)) Σ_k [(κ A_k - conj(A_k)) u_k + B_k conj(u_k)]

    A_k = ∫ N_k d ln τ      B_k = ∫ N_k d(τ / conj τ)      L_k = ∫ N_k ln|τ| dξ      M_k = ∫ N_k (τ / conj τ) dξ

Here t_k stands for traction times Jacobian, which is what the shape functions interpolate; w_k = ∫ N_k dξ.
All integrals are the limits for z coming from *outside* the body (the body is on the left of the element's direction):
the free term of Somigliana's identity is then part of A, at corners of any angle.

Far from z, Gauss's rules (`regular`). Near z, the root r of the element map, τ = (ξ - r)(c2 ξ + c1 + c2 r), is split
off exactly and what is left is smooth (`near_singular`, `singular`). The idea of integrating against the pole found by
continuation of the map: Helsing and Ojala (2008), af Klinteberg and Barnett (2021); the closed forms are ours.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bemcontact.bem.quadrature import bernstein_parameter, gauss_legendre
from bemcontact.bem.shape_functions import DERIVATIVE_MONOMIALS, MONOMIALS, NODES

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

SMOOTH_ORDER = 24
"""Gauss points for what is left when the near root has been split off."""

SMOOTH_RHO = 2.0
"""Bernstein parameter that the second root must have for that: 2^-48 < 1e-14."""


class Integrals(NamedTuple):
    """A, B, L, M for a set of (point, element) pairs, each (..., 3); L and M are None where only F is wanted."""

    A: ComplexArray
    B: ComplexArray
    L: Array | None
    M: ComplexArray | None


class RealFields(NamedTuple):
    """The same in real form, as the blocks of assembly want it, each (..., 3).

    A = tangential + i normal; B = -2 (skew_cos + i skew_sin) / i; M = cos + i sin; log = L.
    """

    tangential: Array
    normal: Array
    skew_cos: Array
    skew_sin: Array
    log: Array | None
    cos: Array | None
    sin: Array | None


def regular(dx: Array, dy: Array, tx: Array, ty: Array, shapes: Array, *, with_U: bool) -> RealFields:
    """Gauss's rule, for pairs whose root is far enough away.

    Parameters
    ----------
    dx, dy : (..., n) τ at the Gauss points
    tx, ty : (..., n) dζ/dξ there, broadcast against `dx`
    shapes : (n, 3) Gauss weights times N_k
    with_U : whether the integrals of U are wanted

    Returns
    -------
    RealFields
    """
    inverse = dx * dx
    yy = dy * dy
    cos = inverse - yy
    inverse += yy
    log = np.log(inverse) if with_U else None
    np.reciprocal(inverse, out=inverse)
    cos *= inverse
    sin = dx * dy
    sin *= inverse
    sin *= 2
    tangential = dx * tx
    product = dy * ty
    tangential += product
    tangential *= inverse
    normal = dx * ty
    np.multiply(dy, tx, out=product)
    normal -= product
    normal *= inverse
    U = (log @ (0.5 * shapes), cos @ shapes, sin @ shapes) if log is not None else (None, None, None)
    cos *= normal
    sin *= normal
    return RealFields(tangential @ shapes, normal @ shapes, cos @ shapes, sin @ shapes, *U)


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
    """Solve τ(r) = 0, counted from the node nearest to z so that no digit is lost however close z lies.

    Parameters
    ----------
    tau : (p, 3) ζ - z at the element nodes

    Returns
    -------
    Root
    """
    _, c1, c2 = element_coefficients(tau)
    nearest = abs(tau).argmin(axis=1)
    start = NODES[nearest]
    at_start = np.take_along_axis(tau, nearest[:, None], axis=1)[:, 0]
    slope = c1 + 2 * c2 * start
    root = np.sqrt(slope * slope - 4 * c2 * at_start)
    root = np.where((slope.conj() * root).real < 0, -root, root)
    step = -2 * at_start / (slope + root)
    return Root(start + step, (start - 1) + step, (start + 1) + step)


def near_singular(tau: ComplexArray, root: Root, *, with_U: bool) -> Integrals:
    """Pairs whose point is near the element but not on it.

    Parameters
    ----------
    tau : (p, 3) ζ - z at the element nodes
    root : as from `nearest_root`
    with_U : whether the integrals of U are wanted

    Returns
    -------
    Integrals
    """
    log_ratio = np.log(root.minus / root.plus)
    ends = tau[:, [0, 2]]
    return _with_root_split_off(tau, root, log_ratio, ends / ends.conj(), with_U=with_U)


def singular(nodes: ComplexArray, local: Array, *, with_U: bool) -> Integrals:
    """Pairs whose point lies on the element, at local coordinate ξ0; one-sided limits from outside the body.

    At an end of the element A_k of the node there diverges like ln|τ|; that part cancels against the neighbour's and
    is left out here: with the neighbour's share goes -i times the interior angle (`corner_term`).

    Parameters
    ----------
    nodes : (p, 3) element nodes
    local : (p,) ξ0 of the collocation point
    with_U : whether the integrals of U are wanted

    Returns
    -------
    Integrals
    """
    _, c1, c2 = element_coefficients(nodes)
    root = Root(local + 0j, local - 1 + 0j, local + 1 + 0j)
    at_end = abs(local) == 1
    inside = np.where(at_end, 0.0, local)
    interior = np.log((1 - inside) / (1 + inside)) - 1j * np.pi
    slope = abs(c1 + 2 * c2 * local)
    log_ratio = np.where(at_end, -local * np.log(2 * slope), interior)
    tau = nodes[:, [0, 2]] - (nodes[:, 1] + local * (c1 + local * c2))[:, None]
    tau[local == -1, 0] = 0
    tau[local == 1, 1] = 0
    turn = np.divide(tau, tau.conj(), out=np.zeros_like(tau), where=tau != 0)
    return _with_root_split_off(nodes, root, log_ratio, turn, with_U=with_U)


def corner_term(before: ComplexArray, after: ComplexArray) -> ComplexArray:
    """-i times the interior angle at a node, from the tangents dζ/dξ before and after it (body on the left)."""
    return -1j * np.mod(np.angle(-before) - np.angle(after), 2 * np.pi)


def _with_root_split_off(
    nodes: ComplexArray, root: Root, log_ratio: ComplexArray, end_turn: ComplexArray, *, with_U: bool
) -> Integrals:
    """A, B, L, M from the root, ∫ dξ/(ξ - r), and τ / conj τ at both ends (zero where τ vanishes)."""
    _, c1, c2 = element_coefficients(nodes)
    r = root.r
    d = c1 + c2 * r
    order = SMOOTH_ORDER if _second_root_is_far(c1, c2, r) else 4 * SMOOTH_ORDER
    xi, weights = gauss_legendre(order)
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
    if not with_U:
        return Integrals(A, B, None, None)
    L = (_log_moments(root) + (weights * np.log(abs(smooth))) @ powers.T) @ MONOMIALS.T
    return Integrals(A, B, L, moments @ MONOMIALS.T)


def _second_root_is_far(c1: ComplexArray, c2: ComplexArray, r: ComplexArray) -> bool:
    curved = abs(c2) > 1e-3 * abs(c1)
    second = -c1[curved] / c2[curved] - r[curved]
    return bool((bernstein_parameter(second) > SMOOTH_RHO).all())


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
