"""Few points of a block that represent all of them: the influence of far elements on the others is a combination.

With z = c + r w, c the middle and r the radius of the block, and q = r/(ζ - c), the kernels at z are sums over p of
q^p w^p and (p + 1) q^p conj(w) w^p times what does not depend on z (Taylor's series of 1/τ, 1/τ² and ln τ). So
the influence of all elements with |q| <= RATIO upon the points of a block is spanned, but for TOLERANCE, by the values
of these few functions there, and on a smooth boundary most of these depend on each other. An interpolative
decomposition by QR with pivoting finds points and weights [CGMR05]; that the far field may be stated by a basis instead
of by its sources is from [MR05].
"""

from typing import NamedTuple

import numpy as np
from scipy.linalg import get_lapack_funcs

from bemcontact.arrays import Array, ComplexArray, IntArray
from bemcontact.bem.reference_element import TOLERANCE

RATIO = 0.5
"""Radius of a block over the distance from its middle up to which an element is far."""


def _number_of_terms() -> int:
    """Number of powers until (p + 1) RATIO^p is below TOLERANCE."""
    p = np.arange(200)
    return int(np.argmax((p + 1) * RATIO**p < TOLERANCE))


TERMS = _number_of_terms()


class Skeleton(NamedTuple):
    """k of R points, and how the influence upon all of them follows from that upon these.

    at : (k,) which points
    weights : (k, R) influence at the k points times these is influence at the R points
    """

    at: IntArray
    weights: Array

    def extend(self, influence: Array, space: Array) -> Array:
        """Influence (…, R) from that upon the few points (…, k), written into some space."""
        k, R = self.weights.shape
        result = space[: influence.size // k * R].reshape(*influence.shape[:-1], R)
        np.matmul(influence.reshape(-1, k), self.weights, out=result.reshape(-1, R))
        return result


def disc(z: ComplexArray) -> tuple[complex, float]:
    """Middle and radius of a block of points (R,) that follow each other."""
    middle = (z[0] + z[-1]) / 2
    return middle, abs(z - middle).max()


def skeleton(z: ComplexArray) -> Skeleton:
    """Choose points among z (R,) that stand for all of them."""
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
    """The functions that span what far elements do to points, as large as they can be, (4 TERMS, R)."""
    middle, radius = disc(z)
    w = (z - middle) / (radius or 1)
    p = np.arange(TERMS)[:, None]
    powers = (p + 1) * (RATIO * w) ** p
    return np.concatenate([powers.real, powers.imag, (powers * w.conj()).real, (powers * w.conj()).imag])
