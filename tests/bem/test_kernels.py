"""The four complex integrals against quadrature in 25 digits, and against Kelvin's kernels."""

from functools import cache
from itertools import pairwise, product

import mpmath as mp
import numpy as np
import pytest
from multiple_precision import DIGITS, rule_of_24

from bemcontact.bem import kernels, reference_element

ELEMENTS = {
    "straight": np.array([-1, 0, 1], complex),
    "arc of 22.5 degrees": np.exp(1j * np.radians([-11.25, 0, 11.25])) / np.radians(11.25),
    "arc of 60 degrees": np.exp(1j * np.radians([-30, 0, 30])) / np.radians(30),
    "arc of 90 degrees": np.exp(1j * np.radians([-45, 0, 45])) / np.radians(45),
    "skewed middle node": np.array([-1, 0.2 + 0.1j, 1], complex),
}
DISTANCES = (3, 1, 0.3, 0.1, 1e-2, 1e-4, 1e-9)
"""In element lengths, two units of ξ."""


def at(nodes: np.ndarray, xi: float) -> tuple[complex, complex]:
    """Position and derivative at ξ."""
    c0, c1, c2 = kernels.element_coefficients(nodes)
    return complex(c0 + xi * (c1 + xi * c2)), complex(c1 + 2 * xi * c2)


def reference(nodes: np.ndarray, z: complex, foot: float, distance: float) -> np.ndarray:
    """A, B, L, M (4, 3) by Gauss-Legendre rules of 24 points, on intervals that shrink fourfold towards the foot.

    The last one is no longer than the distance of the pole in ξ: ρ >= 4 on its Bernstein ellipse, 4^-48 < 1e-28.
    """
    with mp.workdps(DIGITS):
        rule = rule_of_24()
        center = min(max(mp.mpf(foot), -1), 1)
        steps = [mp.mpf(2) / 4**k for k in range(19) if k == 0 or 8 / 4**k > distance] + [mp.mpf(0)]
        ends = sorted({x for step in steps for x in (center - step, center + step) if -1 < x < 1} | {-1, 1})
        n = [mp.mpc(x) for x in nodes]
        c0, c1, c2 = n[1] - mp.mpc(z), (n[2] - n[0]) / 2, (n[0] + n[2]) / 2 - n[1]
        total = [[mp.mpc(0)] * 3 for _ in range(4)]
        for first, last in pairwise(ends):
            for node, weight in rule:
                x, w = (first + last + (last - first) * node) / 2, (last - first) / 2 * weight
                tau, slope = c0 + x * (c1 + x * c2), c1 + 2 * x * c2
                turn, log_slope = tau / mp.conj(tau), slope / tau
                fields = (log_slope, turn * (log_slope - mp.conj(log_slope)), mp.log(abs(tau)), turn)
                for k, shape in enumerate((x * (x - 1) / 2, 1 - x * x, x * (x + 1) / 2)):
                    for row, value in zip(total, fields, strict=True):
                        row[k] += w * shape * value
        return np.array([[complex(value) for value in row] for row in total])


def computed(nodes: np.ndarray, z: complex) -> np.ndarray:
    """The components for ν = 0.3 (7, 3), by the rule that the assembly would take."""
    factor = kernels.factors(0.3)
    tau = (nodes - z)[None]
    root = kernels.nearest_root(tau)
    tier = int(reference_element.tier(reference_element.bernstein_parameter(root.r))[0])
    if tier == len(reference_element.ORDERS):
        result = kernels.components(kernels.with_root_split_off(kernels.beside_element(tau, root)), factor)
    else:
        rule = kernels.gauss_rule(int(reference_element.ORDERS[tier]), factor)
        integrands = kernels.numerators(np.stack([tau.real.T, tau.imag.T], axis=1), rule)
        result = kernels.regular(integrands, rule, with_U=True)
    return np.concatenate([result.T[..., 0], result.U[..., 0]])


def components_of(reference: np.ndarray) -> np.ndarray:
    A, B, L, M = (row[None] for row in reference)
    result = kernels.components(kernels.Integrals(A, B, L.real, M), kernels.factors(0.3))
    return np.concatenate([result.T[..., 0], result.U[..., 0]])


@pytest.mark.slow
@pytest.mark.parametrize("element", ELEMENTS)
def test_integrals_near_an_element_are_exact(element):
    """To 1e-12 from three element lengths down to 1e-9 of one, on both sides, beside the element and beyond it."""
    nodes = ELEMENTS[element]
    for (d, foot), side in zip(product(DISTANCES, (-1.001, -0.6, 0.3, 1.0)), [1, -1] * 14, strict=True):
        position, slope = at(nodes, foot)
        z = position + side * 2j * d * slope / abs(slope)
        expected = components_of(reference(nodes, z, foot, 2 * d))
        assert abs(computed(nodes, z) - expected).max() <= 1e-12 * max(1, abs(expected).max()), (d, foot, side)


@pytest.mark.parametrize("element", ELEMENTS)
@pytest.mark.parametrize("local", [-2 / 3, 0.0, 0.35])
def test_point_on_an_element_is_the_limit_from_outside(element, local):
    """The integrals at distance d to the right differ by O(d ln d): 1e-9 away they agree to 1e-7."""
    nodes = ELEMENTS[element]
    position, slope = at(nodes, local)
    pair = kernels.on_element(nodes[None], np.array([local]))
    on = kernels.components(kernels.with_root_split_off(pair), kernels.factors(0.3))
    beside = computed(nodes, position - 1e-9j * slope / abs(slope))
    assert abs(np.concatenate([on.T[..., 0], on.U[..., 0]]) - beside).max() < 1e-7


@pytest.mark.parametrize("local", [-1, -2 / 3, 0, 2 / 3, 1])
def test_a_point_on_a_short_element_far_from_the_origin_keeps_all_digits(local):
    """A shift that is exact in binary numbers changes nothing. Differences of rounded positions are off by 1e-10."""
    short = np.array([-1, 0.25 + 0.125j, 1]) * 2.0**-20
    here, there = (kernels.on_element(nodes[None], np.array([local])) for nodes in (short, short + (3 + 2j)))
    assert there.end_turn == pytest.approx(here.end_turn, rel=1e-15)


@pytest.mark.parametrize("element", ELEMENTS)
def test_integrals_do_not_depend_on_those_of_other_pairs(element):
    """Beside a strongly curved element, with its second root, all pairs take more Gauss points."""
    both = np.array([ELEMENTS[element], ELEMENTS["skewed middle node"]])
    pairs = [kernels.on_element(nodes, np.zeros(len(nodes))) for nodes in (both[:1], both)]
    alone, first = map(kernels.with_root_split_off, pairs)
    for one, other in zip(alone, first, strict=True):
        assert abs(one[0] - other[0]).max() <= 1e-13


def test_regular_rule_sums_kelvins_kernels():
    """U and T as printed in textbooks (Banerjee and Butterfield 1981), summed by the same rule, give the same."""
    nodes, z, nu = ELEMENTS["arc of 60 degrees"], 2.5 - 1.5j, 0.3
    xi, weights = reference_element.gauss_legendre(int(reference_element.ORDERS[-1]))
    N, dN = reference_element.values(xi), reference_element.derivatives(xi)
    d, slope = N @ nodes - z, dN @ nodes
    J, r = abs(slope), abs(d)
    unit, n = np.stack([d.real, d.imag]) / r, np.stack([slope.imag, -slope.real]) / abs(slope)
    along, delta = np.sum(unit * n, axis=0), np.eye(2)
    T = np.zeros((2, 2, 3))
    U = np.zeros((2, 2, 3))
    for i, j in product(range(2), repeat=2):
        kernel = -(
            along * ((1 - 2 * nu) * delta[i, j] + 2 * unit[i] * unit[j])
            - (1 - 2 * nu) * (unit[i] * n[j] - unit[j] * n[i])
        ) / (4 * np.pi * (1 - nu) * r)
        T[i, j] = (kernel * J * weights) @ N
        U[i, j] = ((-(3 - 4 * nu) * np.log(r) * delta[i, j] + unit[i] * unit[j]) / (8 * np.pi * (1 - nu)) * weights) @ N
    result = computed(nodes, z)
    assert result[:4] == pytest.approx(np.array([T[ij] for ij in kernels.T_ORDER]), abs=1e-13)
    assert result[4:] == pytest.approx(np.array([U[ij] for ij in kernels.U_ORDER]), abs=1e-13)


def legendre(order: int, x: mp.mpc) -> tuple[mp.mpc, mp.mpc]:
    """P_n and its derivative."""
    before, now = mp.mpf(1), x
    for k in range(1, order):
        before, now = now, ((2 * k + 1) * x * now - k * before) / (k + 1)
    return now, order * (x * now - before) / (x * x - 1)


@cache
def gauss(order: int) -> list[tuple[mp.mpf, mp.mpf]]:
    """Abscissae and weights in 25 digits, by a Newton step from those in 16."""
    points = [mp.mpf(x) for x in reference_element.gauss_legendre(order)[0]]
    points = [x - value / slope for x in points for value, slope in [legendre(order, x)]]
    return [(x, 2 / ((1 - x * x) * legendre(order, x)[1] ** 2)) for x in points]


TIERS = [*zip(reference_element.ORDERS.tolist(), reference_element.SMALLEST_RHO.tolist(), strict=True)]


@pytest.mark.parametrize(("n", "rho"), TIERS)
@pytest.mark.parametrize("angle", [0.0, 0.7, np.pi / 2, 2.5])
def test_each_rule_has_the_accuracy_of_its_tier(n: int, rho: float, angle: float):
    """Im r/(ξ - r)² and ln|ξ - r|, times N_1 = ξ (ξ - 1)/2, with r on the ellipse of the rule: below π tolerances.

    A rule integrates N/(ξ - r) with the error N(r) e(r), e = -2 Q_n/P_n, |e| < 2π/ρ^(2n+1) (Davis and Rabinowitz,
    Methods of Numerical Integration, 4.6). The double pole is the derivative, with e' = 2/((r² - 1) P_n²) from the
    Wronskian. The logarithm is the integral from r to infinity, on the way to which |r| <= cρ/2 and |dr| <= c/2 dρ with
    c = 1 + 1/ρ².
    """
    u = mp.mpf(rho) * mp.expj(angle)
    r = (u + 1 / u) / 2
    with mp.workdps(25):
        e, c = 2 * mp.pi / rho ** (2 * n + 1), 1 + rho**-2
        pole = abs(r.imag) * (abs(r - 0.5) * e + abs(r * (r - 1) / ((r * r - 1) * legendre(n, r)[0] ** 2)))
        log = mp.pi * c / 2 * (c**2 / 4 * rho ** (2 - 2 * n) / (2 * n - 2) + c / 2 * rho ** (1 - 2 * n) / (2 * n - 1))
        for f, bound in ((lambda x: r.imag / (x - r) ** 2, pole), (lambda x: mp.log(abs(x - r)), log)):
            exact, coarse = (
                mp.fsum(weight * x * (x - 1) / 2 * f(x) for x, weight in gauss(points)) for points in (60, n)
            )
            assert abs(coarse - exact) <= bound <= mp.pi * reference_element.TOLERANCE
