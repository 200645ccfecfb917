"""QP1 and QP2 of half-planes, a cylinder and a slender beam: p and u_n right to 1e-8 of their scales, in any units.

Compliances by the logarithmic kernel in closed form: strips of constant pressure, and three-noded quadratic elements.
The programs are put to the local solver twice: written down here from scaled numbers, and by the formulations, which
scale inside. The reference is the direct solver; Hertz's pressure is the check on both.
"""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

import bemcontact
from bemcontact import CondensedContact, QPResult, QPStatus, Status, minimize_qp
from bemcontact.arrays import Array
from bemcontact.formulations import FORMULATIONS, complementarity, qp3
from bemcontact.formulations.scaling import scale
from bemcontact.formulations.starts import draw_starts
from bemcontact.options import SolveOptions

CYLINDER = Path(__file__).parents[3] / "models" / "cylinder_on_plane.yaml"
SIZES = (11, 21, 41)
MODULI = (1e3, 2e6, 2e11)
RIGHT = 1e-8
"""Largest error of p and of u_n over their largest entries that is promised; cond K times round-off is 1e-13 here."""
FAR = 40.0
"""Where a half-plane is held [cm]: ten half-lengths, so that M is positive definite on any sum of pressures."""


@dataclass(frozen=True, kw_only=True)
class Units:
    """Values of one centimetre and of one kN/cm² in units of length and stress."""

    length: float
    stress: float


UNITS = {"kN cm": Units(length=1.0, stress=1.0), "N m": Units(length=1e-2, stress=1e7)}


@dataclass(frozen=True, kw_only=True, eq=False)
class Surface:
    """The part of a half-plane that may touch.

    Parameters
    ----------
    x : (n,) contact points [L]
    compliance : (n, n) M [L/p]
    weights : (n,) tributary weights [L]
    """

    x: Array
    compliance: Array
    weights: Array


def strips(n: int, half: float, modulus: float, far: float) -> Surface:
    """Constant pressure on n equal strips of [-half, half]: u = -2/(πE') Σ p_k ∫ ln(|x - s|/far) ds."""
    edges = np.linspace(-half, half, n + 1)
    x = (edges[1:] + edges[:-1]) / 2
    left, right = x[:, None] - edges[:-1], x[:, None] - edges[1:]
    integral = left * np.log(np.abs(left) / far) - right * np.log(np.abs(right) / far) - (left - right)
    return Surface(x=x, compliance=-2 / (np.pi * modulus) * integral, weights=np.diff(edges))


def quadratic_elements(n: int, half: float, modulus: float, far: float) -> Surface:
    """The same with (n - 1)/2 three-noded elements; ∫ tʲ ln|t| dt = tʲ⁺¹(ln|t| - 1/(j+1))/(j+1), t = s - x."""
    x = np.linspace(-half, half, n)
    h = x[1] - x[0]
    integral, weights = np.zeros((n, n)), np.zeros(n)
    for first in range(0, n - 1, 2):
        nodes = np.arange(first, first + 3)
        t = x[nodes] - x[:, None]
        weights[nodes] += h * np.array([1, 4, 1]) / 3
        moments = np.stack([primitive(t[:, 2], far, j) - primitive(t[:, 0], far, j) for j in range(3)], axis=1)
        for local, node in enumerate(nodes):
            a, b = np.delete(t, local, axis=1).T  # N = (t - a)(t - b) / ((t_k - a)(t_k - b))
            shape = np.stack([a * b, -(a + b), np.ones(n)], axis=1) / ((t[:, local] - a) * (t[:, local] - b))[:, None]
            integral[:, node] += (shape * moments).sum(axis=1)
    return Surface(x=x, compliance=-2 / (np.pi * modulus) * integral, weights=weights)


def primitive(t: Array, far: float, j: int) -> Array:
    """That of tʲ ln|t|/far."""
    logarithm = np.log(np.where(t == 0, 1.0, np.abs(t) / far))
    return t ** (j + 1) * (logarithm - 1 / (j + 1)) / (j + 1)


Meshing = Callable[[int, float, float, float], Surface]
MESHINGS: list[Meshing] = [strips, quadratic_elements]


def profile(n: int, modulus: float, units: Units, mesh: Meshing) -> CondensedContact:
    """A round and wavy profile, sunk by a centimetre into a half-plane that is held far away: two patches touch."""
    cm = units.length
    surface = mesh(n, 4 * cm, modulus * units.stress, FAR * cm)
    x = surface.x / cm
    gap = x**2 / 16 + 0.15 * np.cos(2.6 * x + 0.7)
    return CondensedContact.from_compliance(surface.compliance, (gap - gap.min() - 1.0) * cm, surface.weights)


HALF_WIDTH, RADIUS = 1.0, 8.0
"""Of the Hertz problem [cm]."""


def peak(modulus: float) -> float:
    """Hertz: p0 = E' b/(2R)."""
    return modulus * HALF_WIDTH / (2 * RADIUS)


def hertz_held(n: int, modulus: float, units: Units, mesh: Meshing) -> CondensedContact:
    """A parabola sunk by d = p0 b/E' (1/2 + ln 2 + ln far/b), the closed form of -2/(πE') ∫ p ln(|s|/far) ds."""
    cm, E = units.length, modulus * units.stress
    surface = mesh(n, 2 * HALF_WIDTH * cm, E, FAR * cm)
    depth = peak(E) * HALF_WIDTH * cm / E * (0.5 + np.log(2) + np.log(FAR / HALF_WIDTH))
    return CondensedContact.from_compliance(
        surface.compliance, surface.x**2 / (2 * RADIUS * cm) - depth, surface.weights
    )


def hertz_pressed(n: int, modulus: float, units: Units, mesh: Meshing) -> CondensedContact:
    """The same parabola pressed down by P = π b p0/2, free to sink: one free motion."""
    cm, E = units.length, modulus * units.stress
    surface = mesh(n, 2 * HALF_WIDTH * cm, E, FAR * cm)
    load = -np.pi / 2 * HALF_WIDTH * cm * peak(E)
    return CondensedContact.from_compliance(
        surface.compliance, surface.x**2 / (2 * RADIUS * cm), surface.weights,
        rigid_motions=np.ones(n), motion_load=load,
    )  # fmt: skip


def slender_beam(n: int) -> CondensedContact:
    """A cantilever a twentieth as thick as long, on a surface that asks for p = 1 everywhere, q = -M 1.

    Bending and shear of a beam, and the dent of strips of pressure in a half-plane as near as the beam is thick.
    """
    edges, height = np.linspace(0, 1, n + 1), 0.05
    x = (edges[1:] + edges[:-1]) / 2
    least, most = np.minimum.outer(x, x), np.maximum.outer(x, x)
    beam = 2 * least**2 * (3 * most - least) / height**3 + 2.4 * least / height
    left, right = x[:, None] - edges[:-1], x[:, None] - edges[1:]
    dent = right * np.log(np.abs(right) / height) - left * np.log(np.abs(left) / height) + left - right
    near = np.abs(x[:, None] - x) < height
    compliance = beam * np.diff(edges) + 2 / np.pi * dent * near
    return CondensedContact.from_compliance(compliance, -compliance.sum(axis=1), np.diff(edges))


Body = Callable[[int, float, Units, Meshing], CondensedContact]
BODIES: list[Body] = [profile, hertz_held, hertz_pressed]


def without_units(condensed: CondensedContact) -> CondensedContact:
    """The same problem in dimensionless numbers; its ε is the q of the other."""
    scaled = scale(condensed)
    return CondensedContact.from_compliance(
        scaled.compliance, scaled.offset, scaled.weights,
        rigid_motions=scaled.rigid_motions, motion_load=scaled.motion_load,
    )  # fmt: skip


def by_hand(statement: str, problem: CondensedContact) -> QPResult:
    """(27)-(29) or (30)-(34) with μ = 1 over (u_n, p), stiffness rows, put straight to the local solver."""
    n, J = problem.size, np.diag(problem.weights)
    K, B, r = problem.stiffness_rows
    E, zero = np.hstack([K, -B]), np.zeros((n, n))
    H, c = np.block([[zero, J], [J, zero]]), np.append(np.zeros(n), J @ problem.initial_gap)
    lower = np.append(-problem.initial_gap, np.zeros(n))
    if statement == "qp1":
        return minimize_qp(H, c, A=E, cl=r, cu=r, bl=lower)
    balance = np.hstack([np.zeros((problem.free_motions, n)), problem.equilibrium.T])
    load = problem.motion_load
    return minimize_qp(H + 2 * E.T @ E, c - 2 * E.T @ r, A=balance, cl=-load, cu=-load, bl=lower)


def assert_right(result: Array, truth: Array) -> None:
    assert np.abs(result - truth).max() <= RIGHT * np.abs(truth).max()


on_all = [
    pytest.mark.parametrize("body", BODIES, ids=lambda body: body.__name__),
    pytest.mark.parametrize("mesh", MESHINGS, ids=lambda mesh: mesh.__name__),
    pytest.mark.parametrize("modulus", MODULI, ids="E={:g}".format),
    pytest.mark.parametrize("units", UNITS.values(), ids=UNITS.keys()),
]


def everywhere(test: Callable[..., None]) -> Callable[..., None]:
    """Run a test for all bodies, meshes, moduli and units."""
    for mark in on_all:
        test = mark(test)
    return test


@everywhere
@pytest.mark.parametrize("statement", ["qp1", "qp2"])
def test_written_by_hand_in_scaled_numbers(statement, body, mesh, modulus, units):
    """The local solver alone, called with its defaults from its default start."""
    for n in SIZES:
        condensed = body(n, modulus, units, mesh)
        truth = complementarity.solve(condensed)
        problem = without_units(condensed)
        result = by_hand(statement, problem)
        assert result.status is QPStatus.LOCAL_MINIMIZER
        gap = (problem.initial_gap + result.x[:n]) * condensed.scales.displacement
        assert_right(result.x[n:] * condensed.scales.pressure, truth.pressure)
        assert_right(gap - condensed.initial_gap, truth.displacement)


@pytest.mark.slow
@everywhere
@pytest.mark.parametrize("formulation", ["qp1", "qp2"])
def test_formulations_in_raw_units(formulation, body, mesh, modulus, units):
    """Unpolished, so that it is the solver that is right."""
    for n in (*SIZES, 81):
        condensed = body(n, modulus, units, mesh)
        truth = complementarity.solve(condensed)
        result = FORMULATIONS[formulation](condensed, SolveOptions.of(formulation, polish=False))
        assert result.status is Status.SOLVED
        assert_right(result.pressure, truth.pressure)
        assert_right(result.displacement, truth.displacement)


@everywhere
def test_reference_is_the_only_solution(body, mesh, modulus, units):
    """sym(JM) positive definite on the equilibrium space, and min(p/T, δ/U) = 0 to round-off."""
    for n in SIZES:
        condensed = body(n, modulus, units, mesh)
        scaled, truth = scale(condensed), complementarity.solve(condensed)
        eigenvalue = qp3.smallest_eigenvalue(scaled, np.diag(scaled.weights))
        assert eigenvalue is not None
        assert eigenvalue > 0
        p, gap = truth.pressure / condensed.scales.pressure, condensed.gap(truth.pressure, truth.rigid_amplitudes)
        assert np.abs(np.minimum(p, gap / condensed.scales.displacement)).max() <= 1e-12 * (1 + p.max())
        assert 2 < truth.pressure.astype(bool).sum() < n


@pytest.mark.parametrize("mesh", MESHINGS, ids=lambda mesh: mesh.__name__)
@pytest.mark.parametrize("body", [hertz_held, hertz_pressed], ids=lambda body: body.__name__)
@pytest.mark.parametrize("formulation", ["qp1", "qp2"])
def test_hertz_is_approached(formulation, body, mesh):
    """Half-width within one spacing of points; p0 and P by the second order in it, P exactly where it is the load."""
    E, load = 1e3, np.pi / 2 * HALF_WIDTH * peak(1e3)
    for n in SIZES:
        condensed = body(n, E, UNITS["kN cm"], mesh)
        p = FORMULATIONS[formulation](condensed, SolveOptions.of(formulation)).pressure
        order = 2.5 / n**2
        assert condensed.weights[p > 0].sum() / 2 == pytest.approx(HALF_WIDTH, abs=4 * HALF_WIDTH / (n - 1))
        assert p.max() == pytest.approx(peak(E), rel=order)
        assert condensed.weights @ p == pytest.approx(load, rel=1e-12 if body is hertz_pressed else order)


@pytest.mark.parametrize("formulation", ["qp1", "qp2"])
def test_cylinder_from_random_starts(formulation):
    """The shipped Hertz problem of a body that contact alone holds: each of ten searches, unpolished."""
    condensed = bemcontact.condense(bemcontact.load(CYLINDER, variant="stated mesh"))
    truth = complementarity.solve(condensed)
    result = bemcontact.random_starts(condensed, formulation, count=10)
    assert result.solved == 10
    for end in result.ends:
        assert_right(end.solution.pressure, truth.pressure)
        assert_right(end.solution.displacement, truth.displacement)


@pytest.mark.slow
@pytest.mark.parametrize(("n", "condition"), [(20, 5e4), (80, 5e5)])
@pytest.mark.parametrize("formulation", ["qp1", "qp2"])
def test_slender_beam_from_random_starts(formulation, n, condition):
    """A compliance of bad condition, unpolished: p = 1 by construction, and known to cond M times round-off, 1e-10."""
    condensed = slender_beam(n)
    weighted = condensed.weights[:, None] * condensed.compliance
    assert np.linalg.cond(condensed.compliance) > condition
    assert np.linalg.eigvalsh(weighted + weighted.T)[0] > 0
    for start in (None, *draw_starts(condensed, 135)[100:]):  # from three of these a phase one once gave up
        result = FORMULATIONS[formulation](condensed, SolveOptions.of(formulation, polish=False, start=start))
        assert result.status is Status.SOLVED
        assert_right(result.pressure, np.ones(n))
        assert_right(result.displacement, -condensed.offset)
