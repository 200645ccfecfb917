"""The far part of a block of rows as machine code, by numba if it is installed (the extra ``fast``).

NumPy computes these sums as products of matrices over all (Gauss point, element, point). The machine code computes one
element after the other in two small arrays. It releases the lock of the interpreter, so that threads share the work.
"""

import math
from collections.abc import Callable
from functools import lru_cache

import numpy as np

from bemcontact.arrays import Array, ComplexArray, IntArray
from bemcontact.bem.kernels import Factors
from bemcontact.bem.reference_element import INTEGRALS

FarSums = Callable[[Array, Array, ComplexArray, IntArray, int, ComplexArray, ComplexArray, Array, Factors], None]
"""A function with the parameters of `add_far`."""


@lru_cache(maxsize=1)
def far_sums() -> FarSums | None:
    """`add_far` as machine code, or None without numba.

    Its first call compiles it, which takes a few seconds once; the machine code is kept for later processes.
    """
    try:
        import numba
    except ImportError:
        return None
    # Neither option changes a result by more than round-off: no check for division by zero, fused multiply-add.
    options = {"nogil": True, "error_model": "numpy", "fastmath": {"contract"}}
    try:
        return numba.njit(add_far, cache=True, **options)
    except RuntimeError:  # there is no directory to keep the machine code in
        return numba.njit(add_far, **options)


def add_far(
    F: Array, G: Array, z: ComplexArray, elements: IntArray, slot: int,
    zeta: ComplexArray, tangent: ComplexArray, weighted: Array, factor: Factors,
) -> None:  # fmt: skip
    """Add the integrals of `kernels.regular` over a run of elements for every point, in loops for a compiler.

    Parameters
    ----------
    F : (4, N, R) as in `influence.Block`; added to
    G : (3, 3, e, R) as in `influence.Block`; written, from place `slot` on, unless `slot` is negative
    z : (R,) points
    elements : (r, 3) nodes of the run
    slot : place of the first one in G, or a negative number if G is not wanted
    zeta, tangent : (n, r) ζ and ζ' at the Gauss points
    weighted : (3, n) shape functions times weights
    """
    n, R, kinds = len(zeta), len(z), 4 if slot < 0 else 7
    x0, y0 = z.real.copy(), z.imag.copy()
    f, s = np.empty((n, 7, R)), np.empty((7, R))  # integrands, and their sums for one local node
    for e in range(len(elements)):
        for g in range(n):
            X, Y, dx, dy = zeta[g, e].real, zeta[g, e].imag, tangent[g, e].real, tangent[g, e].imag
            for i in range(R):
                x, y = X - x0[i], Y - y0[i]
                square = x * x + y * y
                inverse = 1 / square
                normal, cos, sin = (x * dy - y * dx) * inverse, (x * x - y * y) * inverse, 2 * x * y * inverse
                f[g, 0, i], f[g, 1, i] = normal, (x * dx + y * dy) * inverse
                f[g, 2, i], f[g, 3, i] = cos * normal, sin * normal
                f[g, 4, i], f[g, 5, i], f[g, 6, i] = cos, sin, square
            if slot >= 0:
                for i in range(R):
                    f[g, 6, i] = math.log(f[g, 6, i])
        for k in range(3):
            s[:] = 0
            for g in range(n):
                for c in range(kinds):
                    for i in range(R):
                        s[c, i] += weighted[k, g] * f[g, c, i]
            node, place = elements[e, k], slot + e
            for i in range(R):
                diagonal, cross = factor.normal * s[0, i], factor.tangential * s[1, i]
                cos, sin = factor.skew * s[2, i], factor.skew * s[3, i]
                F[0, node, i] += diagonal - cos
                F[1, node, i] += diagonal + cos
                F[2, node, i] -= cross + sin
                F[3, node, i] += cross - sin
            if slot >= 0:
                for i in range(R):
                    log = factor.turn * INTEGRALS[k] - factor.log / 2 * s[6, i]
                    G[0, k, place, i] = log + factor.turn * s[4, i]
                    G[1, k, place, i] = log - factor.turn * s[4, i]
                    G[2, k, place, i] = factor.turn * s[5, i]
