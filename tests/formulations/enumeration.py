"""Random contact problems of declared kinds, and all their contact states and first-order points by enumeration."""

import numpy as np
from numpy.typing import NDArray

from bemcontact import (
    CondensedContact,
)
from bemcontact.arrays import Array
from bemcontact.formulations import qp2, qp3
from bemcontact.formulations.scaling import scale
from bemcontact.options import SolveOptions

BoolArray = NDArray[np.bool_]


PENALTIES = (0.1, 1.0, 10.0)


STATEMENTS = [("qp1", 1.0), *(("qp2", penalty) for penalty in PENALTIES)]


REGULAR = 1e11
"""Condition number up to which the equations of a face are solved; generic data have no solution on any other."""


SAME = 1e-9
"""Difference of two points that are one, over the size of the numbers: round-off times a condition number of 1e6."""


def subsets(m: int) -> BoolArray:
    """All of m things, (2ᵐ, m), the empty one first."""
    return (np.arange(2**m)[:, None] >> np.arange(m) & 1).astype(bool)


def complementary_points(matrix: Array, vector: Array, free: int = 0) -> list[Array]:
    """All z >= 0 with w = vector + matrix z >= 0 and z·w = 0, but for the last `free` entries: z free, w = 0."""
    m = len(vector) - free
    faces = np.pad(subsets(m), ((0, 0), (0, free)), constant_values=True)
    systems = np.where(faces[:, :, None], matrix * faces[:, None, :], np.eye(m + free))
    regular = np.linalg.cond(systems) < REGULAR
    z = np.linalg.solve(systems[regular], np.where(faces[regular], -vector, 0.0)[..., None])[..., 0]
    w = vector + z @ matrix.T
    right = np.minimum(z, w)[:, :m].min(axis=1) >= -SAME * (1 + np.abs(z).max(axis=1))
    return distinct(list(z[right]))


def distinct(points: list[Array]) -> list[Array]:
    """Each point once."""
    result: list[Array] = []
    for point in points:
        if not among(point, result):
            result.append(point)
    return result


def among(point: Array, points: list[Array]) -> bool:
    return any(np.abs(point - other).max() <= SAME * (1 + np.abs(other).max()) for other in points)


def contact_states(condensed: CondensedContact) -> list[Array]:
    """The scaled pressures (n,) of all contact states, from all 2ⁿ contact sets, equilibrium included."""
    scaled = scale(condensed)
    n, k = scaled.rigid_motions.shape
    system = np.block([[scaled.compliance, scaled.rigid_motions], [scaled.equilibrium.T, np.zeros((k, k))]])
    points = complementary_points(system, np.append(scaled.offset, scaled.motion_load), free=k)
    return distinct([z[:n] for z in points])


def first_order_points_of_qp1(condensed: CondensedContact) -> list[Array]:
    """The scaled pressures at which min pᵀJ(q + M p), q + M p >= 0, p >= 0 is stationary, of a held body.

    With multipliers λ of the gaps: Jq + (JM + MᵀJ)p - Mᵀλ >= 0 complementary to p, q + M p >= 0 to λ.
    """
    scaled = scale(condensed)
    n, M = condensed.size, scaled.compliance
    weighted = scaled.weights[:, None] * M
    system = np.block([[weighted + weighted.T, -M.T], [M, np.zeros((n, n))]])
    points = complementary_points(system, np.append(scaled.weights * scaled.offset, scaled.offset))
    return distinct([z[:n] for z in points])


def first_order_points_of_qp2(condensed: CondensedContact, penalty: float) -> list[Array]:
    """The scaled (δ, p) of a held body at which QP2 is stationary: x >= lower complementary to H x + c >= 0."""
    program = qp2.program_of(condensed, SolveOptions.of("qp2", penalty=penalty))
    return complementary_points(program.hessian, program.linear + program.hessian @ program.lower)


def is_p_matrix(M: Array) -> bool:
    """Whether all 2ⁿ - 1 principal minors are positive."""
    return all(np.linalg.det(M[np.ix_(rows, rows)]) > 0 for rows in map(np.flatnonzero, subsets(len(M))[1:]))


def curvature(problem: CondensedContact) -> float:
    """Smallest eigenvalue of JM + MᵀJ on the equilibrium space, scaled."""
    scaled = scale(problem)
    value = qp3.smallest_eigenvalue(scaled, np.diag(scaled.weights))
    assert value is not None
    return value


def definite(rng: np.random.Generator, n: int) -> CondensedContact:
    """An unsymmetric M with sym(JM) positive definite."""
    A, S = rng.standard_normal((2, n, n))
    J = rng.uniform(0.3, 1.5, n)
    M = (A @ A.T / n + 0.05 * np.eye(n) + 0.3 * (S - S.T)) / J[:, None]
    return CondensedContact.from_compliance(M, rng.standard_normal(n), J)


def ring(rng: np.random.Generator, n: int) -> CondensedContact:
    """A P-matrix, and no diagonal D > 0 makes sym(DM) positive definite: I + aC, a > 2, C an odd cycle.

    Its proper principal minors are 1, being triangular up to a permutation, and its determinant is 1 + aⁿ; it has an
    eigenvalue of negative real part. Even n have a triangular coupling to one point more. Positive factors of rows and
    columns, and renumbering, leave a P-matrix one.
    """
    m = n - 1 + n % 2
    M = np.eye(n)
    M[np.arange(m), (np.arange(m) + 1) % m] = rng.uniform(2.2, 4.0, m)
    M[:m, m:] = rng.normal(0, 3, (m, n - m))
    order, rows, columns = rng.permutation(n), *rng.uniform(0.5, 2, (2, n))
    M = rows[:, None] * M[np.ix_(order, order)] * columns
    return CondensedContact.from_compliance(M, rng.standard_normal(n), rng.uniform(0.3, 1.5, n))


def dominated(rng: np.random.Generator, n: int) -> CondensedContact:
    """A P-matrix by dominant diagonals, with columns of sizes from 1 to 100, drawn until sym(JM) is indefinite."""
    while True:
        M = rng.uniform(-1, 1, (n, n))
        np.fill_diagonal(M, 0)
        np.fill_diagonal(M, 1.05 * np.abs(M).sum(axis=1))
        M *= rng.permutation(np.geomspace(1, 100, n))
        problem = CondensedContact.from_compliance(M, rng.standard_normal(n), rng.uniform(0.3, 1.5, n))
        if curvature(problem) < -0.05:
            return problem


def not_p(rng: np.random.Generator, n: int) -> CondensedContact:
    """Some principal minor is negative."""
    while is_p_matrix(M := rng.standard_normal((n, n)) + 0.5 * np.eye(n)):
        pass
    return CondensedContact.from_compliance(M, rng.standard_normal(n), rng.uniform(0.3, 1.5, n))


def free_body(rng: np.random.Generator, n: int, k: int) -> CondensedContact:
    """A body that a plane holds against rising (k = 1) and turning (k = 2), pressed down at some of the points."""
    held = definite(rng, n)
    R = np.column_stack([np.ones(n), np.linspace(-1, 1, n)])[:, :k]
    pressed = rng.uniform(0, 1, n)
    return CondensedContact.from_compliance(
        held.compliance, rng.uniform(0, 1, n), held.weights,
        rigid_motions=R, motion_load=-(held.weights[:, None] * R).T @ pressed,
    )  # fmt: skip
