"""A few points of a block whose values give the influence of far elements on all points of the block.

With z = c + r w, c the middle and r the radius of the block, and q = r/(ζ - c), the kernels at z are sums over p of
q^p w^p and (p + 1) q^p conj(w) w^p with factors that do not depend on z (Taylor series of 1/τ, 1/τ² and ln τ). The
values of these few functions at the points of a block span the influence of all elements with |q| <= RATIO up to
TOLERANCE. On a smooth boundary most of them depend on each other. An interpolative decomposition by QR with pivoting
gives the points and the weights [CGMR05]. The description of the far field by a basis instead of its sources is from
[MR05].
"""

from typing import NamedTuple

import numpy as np
from scipy.linalg import get_lapack_funcs

from bemcontact.arrays import Array, ComplexArray, IntArray
from bemcontact.bem.reference_element import TOLERANCE

RATIO = 0.5
"""Radius of a block over the distance from its middle up to which an element is far."""


TERMS = next(p for p in range(200) if (p + 1) * RATIO**p < TOLERANCE)
"""Number of powers until (p + 1) RATIO^p is below TOLERANCE."""


class Skeleton(NamedTuple):
    """k of R points, and the weights that give the influence on all of them.

    at : (k,) indices of the points
    weights : (k, R) influence at the k points times these weights is the influence at the R points
    """

    at: IntArray
    weights: Array

    def extend(self, influence: Array, space: Array) -> Array:
        """Influence (…, R) from that on the k points (…, k), written into given memory."""
        k, R = self.weights.shape
        result = space[: influence.size // k * R].reshape(*influence.shape[:-1], R)
        np.matmul(influence.reshape(-1, k), self.weights, out=result.reshape(-1, R))
        return result


def disc(z: ComplexArray) -> tuple[complex, float]:
    """Middle and radius of a block of consecutive points (R,)."""
    middle = (z[0] + z[-1]) / 2
    return middle, abs(z - middle).max()


def skeleton(z: ComplexArray) -> Skeleton:
    """Choose points among z (R,) that represent all of them."""
    geqp3, trtrs = get_lapack_funcs(("geqp3", "trtrs"), dtype=float)
    values = _far_functions(z)
    triangle, pivots, *_ = geqp3(values)
    size = abs(triangle.diagonal())
    k = int(np.count_nonzero(size > TOLERANCE * size[0]))
    at, rest = np.split(pivots - 1, [k])
    weights = np.zeros((k, len(z)))
    weights[np.arange(k), at] = 1
    weights[:, rest] = trtrs(triangle[:k, :k], triangle[:k, k:])[0]
    return Skeleton(at, weights)


def _far_functions(z: ComplexArray) -> Array:
    """Functions (4 TERMS, R) that span the influence of far elements on the points, each at its largest size."""
    middle, radius = disc(z)
    w = (z - middle) / (radius or 1)
    p = np.arange(TERMS)[:, None]
    powers = (p + 1) * (RATIO * w) ** p
    return np.concatenate([powers.real, powers.imag, (powers * w.conj()).real, (powers * w.conj()).imag])
