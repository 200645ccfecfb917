"""Contact problems whose solution is known beforehand: Hertz, beams, a cylinder, and few points drawn at random."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import bemcontact
from bemcontact import CondensedContact, Problem
from bemcontact.formulations.scaling import scale

Array = NDArray[np.float64]
BoolArray = NDArray[np.bool_]
Kind = Callable[[np.random.Generator, int], CondensedContact]

CYLINDER = Path(__file__).parents[2] / "models" / "cylinder_on_plane.yaml"
FAR = 40.0
"""Where the half-plane of `hertz` is held [cm]: at twenty times the half-length, so that M is positive definite."""
METRE, NEWTON_PER_SQUARE_METRE = 1e-2, 1e7
"""Values of one centimetre and of one kN/cm² in N and m."""
SAME = 1e-8
"""Difference of two scaled pressures that are one, over the size of the numbers."""


def hertz(n: int, modulus: float) -> CondensedContact:
    """A parabola of radius 8 cm sunk into n strips of a half-plane by the depth of a half-width of 1 cm.

    u(x) = -2/(πE) Σ p_k ∫ ln(|x - s|/40) ds; the depth is p0 b/E (1/2 + ln 2 + ln 40/b) in closed form, p0 = E b/(2R).
    """
    edges = np.linspace(-2, 2, n + 1)
    x, radius = (edges[1:] + edges[:-1]) / 2, 8.0
    left, right = x[:, None] - edges[:-1], x[:, None] - edges[1:]
    integral = left * np.log(np.abs(left) / FAR) - right * np.log(np.abs(right) / FAR) - (left - right)
    depth = (0.5 + np.log(2 * FAR)) / (2 * radius)
    return CondensedContact.from_compliance(
        -2 / (np.pi * modulus) * integral, x**2 / (2 * radius) - depth, np.diff(edges)
    )


def in_newton_metres(contact: CondensedContact) -> CondensedContact:
    """A held body given in kN and cm, in N and m."""
    return CondensedContact.from_compliance(
        contact.compliance * METRE / NEWTON_PER_SQUARE_METRE, contact.offset * METRE, contact.weights * METRE
    )


def cylinder() -> CondensedContact:
    """The shipped model, held by contact."""
    return bemcontact.condense(bemcontact.load(CYLINDER))


def beam_on_its_own_shape(along: int) -> CondensedContact:
    """[SS92] Fig. 2: a cantilever under twice the load whose deflection under the single load is the rigid surface.

    The surface is flat to the mesh, and the deflection goes into the gap by hand, ε = -v. Away from the clamp p = 50.

    Parameters
    ----------
    along : elements of a long face, which is as many contact points over two
    """
    once, twice = (bemcontact.condense(_long_beam(along, pressure)) for pressure in (50.0, 100.0))
    return replace(twice, initial_gap=-once.free_displacement, name=f"beam on its own shape, n = {twice.size}")


def _long_beam(along: int, pressure: float) -> Problem:
    across = max(5, along // 4)
    edges = [
        {"name": "lower", "start": [0, 0], "elements": along, "grading": {"ratio": 3, "towards": "start"}},
        {"name": "tip", "start": [100, 0], "elements": across},
        {"name": "upper", "start": [100, 10], "elements": along, "grading": {"ratio": 3, "towards": "end"}},
        {"name": "clamp", "start": [0, 10], "elements": across},
    ]
    return _cantilever(edges, zone="lower", level=0, modulus=2e6, poisson=0.0, pressure=pressure)


def beam_above_a_plane(in_zone: int) -> CondensedContact:
    """[SS92] Fig. 6 with E = 2e4: a cantilever bent down onto a plane 1 cm below it, in contact from x = 42.4 on.

    Parameters
    ----------
    in_zone : elements on 40 <= x <= 50, where it may touch; twice as many contact points and one more
    """
    share = max(1, in_zone // 10)
    edges = [
        {"name": "root", "start": [0, 0], "elements": 6 * share, "grading": {"ratio": 3, "towards": "end"}},
        {"name": "lower", "start": [40, 0], "elements": in_zone},
        {"name": "tip", "start": [50, 0], "elements": 3 * share},
        {"name": "upper", "start": [50, 5], "elements": 14 * share},
        {"name": "clamp", "start": [0, 5], "elements": 3 * share},
    ]
    contact = bemcontact.condense(_cantilever(edges, zone="lower", level=-1, modulus=2e4, poisson=0.29, pressure=3.6))
    return replace(contact, name=f"beam above a plane, n = {contact.size}")


def _cantilever(
    edges: list[dict], *, zone: str, level: float, modulus: float, poisson: float, pressure: float
) -> Problem:
    """Clamped at x = 0, pressed down on its upper face, above the plane y = level."""
    return Problem.model_validate({
        "name": "cantilever",
        "material": {"young_modulus": modulus, "poisson_ratio": poisson, "state": "plane_strain"},
        "boundary": {"outer": edges},
        "conditions": {"clamp": {"displacement": {"x": 0, "y": 0}}, "upper": {"pressure": pressure}},
        "contact_zones": {
            "under": {"edges": [zone], "surface": {"kind": "plane", "point": [0, level], "normal": [0, 1]}}
        },
    })  # fmt: skip


def contact_sets(n: int) -> BoolArray:
    """All of them, (2ⁿ, n)."""
    return (np.arange(2**n)[:, None] >> np.arange(n) & 1).astype(bool)


def is_p_matrix(M: Array) -> bool:
    """Whether all principal minors are positive."""
    return all(np.linalg.det(M[np.ix_(A, A)]) > 0 for A in map(np.flatnonzero, contact_sets(len(M))[1:]))


def is_definite(contact: CondensedContact) -> bool:
    """Whether sym(JM) is positive definite."""
    weighted = contact.weights[:, None] * contact.compliance
    return bool(np.linalg.eigvalsh(weighted + weighted.T)[0] > 0)


def contact_states(contact: CondensedContact) -> list[Array]:
    """The scaled pressures (n,) of all contact states, one for each contact set that gives one."""
    scaled = scale(contact)
    n, k = scaled.rigid_motions.shape
    system = np.block([[scaled.compliance, scaled.rigid_motions], [scaled.equilibrium.T, np.zeros((k, k))]])
    right = -np.append(scaled.offset, scaled.motion_load)
    states: list[Array] = []
    for touching in contact_sets(n):
        rows = np.append(np.flatnonzero(touching), n + np.arange(k))
        if touching.sum() < k or np.linalg.matrix_rank(system[np.ix_(rows, rows)]) < len(rows):
            continue
        z = np.zeros(n + k)
        z[rows] = np.linalg.solve(system[np.ix_(rows, rows)], right[rows])
        p, gap = z[:n], system[:n] @ z - right[:n]
        if min(p.min(), gap.min()) >= -SAME * (1 + np.abs(z).max()) and not is_among(p, states):
            states.append(p)
    return states


def is_among(p: Array, states: list[Array]) -> bool:
    """Whether a pressure is one of these."""
    return any(np.abs(p - state).max() <= SAME * (1 + np.abs(state).max()) for state in states)


def definite(rng: np.random.Generator, n: int) -> CondensedContact:
    """An unsymmetric M with sym(JM) positive definite."""
    A, S = rng.standard_normal((2, n, n))
    J = rng.uniform(0.3, 1.5, n)
    M = (A @ A.T / n + 0.05 * np.eye(n) + 0.3 * (S - S.T)) / J[:, None]
    return CondensedContact.from_compliance(M, rng.standard_normal(n), J)


def p_matrix(rng: np.random.Generator, n: int) -> CondensedContact:
    """M = (I - X)⁻¹(I + X) with ‖X‖∞ < 1, a P-matrix, its rows and columns resized until sym(JM) is indefinite."""
    while True:
        X = rng.standard_normal((n, n)) * rng.choice([0.1, 1.0, 10.0], n)
        X *= 0.95 / np.abs(X).sum(axis=1, keepdims=True)
        rows, columns = np.exp(rng.normal(0, 1, (2, n)))
        M = rows[:, None] * np.linalg.solve(np.eye(n) - X, np.eye(n) + X) * columns
        contact = CondensedContact.from_compliance(M, rng.standard_normal(n), rng.uniform(0.3, 1.5, n))
        if is_p_matrix(M) and not is_definite(contact):
            return contact


def ring(rng: np.random.Generator, n: int) -> CondensedContact:
    """A P-matrix for which no D > 0 makes sym(DM) definite: I + aC, a > 2, C an odd cycle; even n have a tail."""
    m = n - 1 + n % 2
    M = np.eye(n)
    M[np.arange(m), (np.arange(m) + 1) % m] = rng.uniform(2.2, 4.0, m)
    M[:m, m:] = rng.normal(0, 3, (m, n - m))
    rows, columns = rng.uniform(0.5, 2, (2, n))
    return CondensedContact.from_compliance(
        rows[:, None] * M * columns, rng.standard_normal(n), rng.uniform(0.3, 1.5, n)
    )


def not_p(rng: np.random.Generator, n: int) -> CondensedContact:
    """Some principal minor is negative, and there is a contact state."""
    while True:
        M = rng.standard_normal((n, n)) + 0.5 * np.eye(n)
        contact = CondensedContact.from_compliance(M, rng.standard_normal(n), rng.uniform(0.3, 1.5, n))
        if not is_p_matrix(M) and contact_states(contact):
            return contact


def rising(rng: np.random.Generator, n: int) -> CondensedContact:
    """A body that contact alone keeps from moving up and down."""
    return _pressed(rng, np.ones((n, 1)))


def rising_and_turning(rng: np.random.Generator, n: int) -> CondensedContact:
    """A body that contact alone keeps from moving up and down and from turning."""
    return _pressed(rng, np.column_stack([np.ones(n), np.linspace(-1, 1, n)]))


def _pressed(rng: np.random.Generator, motions: Array) -> CondensedContact:
    held = definite(rng, n := len(motions))
    load = -(held.weights[:, None] * motions).T @ rng.uniform(0, 1, n)
    return CondensedContact.from_compliance(
        held.compliance, rng.uniform(0, 1, n), held.weights, rigid_motions=motions, motion_load=load
    )


HELD: tuple[Kind, ...] = (definite, p_matrix, ring, not_p)
FREE: tuple[Kind, ...] = (rising, rising_and_turning)
