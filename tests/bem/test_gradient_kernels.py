"""Integrals of the displacement gradient against multiple precision."""

from itertools import pairwise

import mpmath as mp
import numpy as np
import pytest
from multiple_precision import DIGITS, rule_of_24

from bemcontact.bem import gradient_kernels, kernels, reference_element

ELEMENTS = {
    "straight": np.array([-0.5, 0, 0.5], complex),
    "skewed middle node": np.array([-0.5, 0.1 + 0.05j, 0.5]),
    "arc of 22.5 degrees": 2.5 * np.exp(1j * np.array([-1, 0, 1]) * np.pi / 16),
    "arc of 90 degrees": np.exp(1j * np.array([-1, 0, 1]) * np.pi / 4),
}
FOOTS = (-1.05, -0.5, 1.0)


def exact(tau: np.ndarray) -> np.ndarray:
    """J and K (2, 3) by Gauss rules of 24 points, between points that close in on the roots of the element map.

    Rules of 48 points give the same to 1e-24.
    """
    with mp.workdps(DIGITS):
        first, middle, last = (mp.mpc(complex(value)) for value in tau)
        c = [(first + last) / 2 - middle, (last - first) / 2, middle]
        root = mp.sqrt(c[1] ** 2 - 4 * c[0] * c[2])
        roots = [(sign * root - c[1]) / (2 * c[0]) for sign in (1, -1)] if c[0] else [-c[2] / c[1]]
        near = [mp.re(r) + side * abs(mp.im(r)) * 4**j for r in roots for side in (-1, 0, 1) for j in range(18)]
        points = sorted({mp.mpf(-1), mp.mpf(1), *(x for x in near if -1 < x < 1)})
        moments = [[mp.mpc(0)] * 3 for _ in range(2)]
        for start, end in pairwise(points):
            for node, weight in rule_of_24():
                x, w = (start + end + (end - start) * node) / 2, (end - start) / 2 * weight
                t = (c[0] * x + c[1]) * x + c[2]
                for row, value in zip(moments, (w / t, w * t / mp.conj(t) ** 2), strict=True):
                    row[:] = row[0] + value, row[1] + x * value, row[2] + x * x * value
        shapes = [[mp.mpf(value) for value in row] for row in reference_element.MONOMIALS]
        return np.array([[complex(mp.fdot(shape, row)) for shape in shapes] for row in moments])


@pytest.mark.slow
@pytest.mark.parametrize("distance", [1e-9, 1e-4, 1e-2, 0.1, 0.3, 0.6])
@pytest.mark.parametrize("name", ELEMENTS)
def test_integrals(name: str, distance: float):
    """At both sides of an element and beyond its ends; the bound is that of the Gauss rules, 1e-14 a few times."""
    nodes = ELEMENTS[name]
    for foot in FOOTS:
        at = np.array([foot])
        place, slope = (shapes(at) @ nodes for shapes in (reference_element.values, reference_element.derivatives))
        for side in (1, -1):
            tau = nodes[None] - (place + side * 1j * slope / abs(slope) * distance * abs(nodes[2] - nodes[0]))[:, None]
            root = kernels.nearest_root(tau)
            tier = int(
                reference_element.tier(reference_element.bernstein_parameter(root.r), reference_element.RHO_OF_T)[0]
            )
            if tier < len(reference_element.ORDERS):
                found = gradient_kernels.far_integrals(tau, int(reference_element.ORDERS[tier]))
            else:
                found = gradient_kernels.near_integrals(tau, root)
            true = exact(tau[0])
            assert abs(np.array([found.J[0], found.K[0]]) - true).max() < 2e-13 * max(1, abs(true).max())
