"""The quadratic program over (u_n, p) that QP1 and QP2 share, and its minimization by the local solver.

x = (u_n, p), or (u_n, p, a) where the compliance rows bring in the amplitudes; all of it dimensionless as in
`bemcontact.formulations.scaling`, but with u_n itself and not the gap, so that the null vector is that of [SS92].
"""

from dataclasses import replace

import numpy as np
from numpy.linalg import matrix_rank
from scipy.linalg import block_diag

from bemcontact.arrays import Array
from bemcontact.cached import cached_property
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.formulations.local_solver.factorizations import inertia
from bemcontact.formulations.local_solver.minimize import minimize_qp
from bemcontact.formulations.local_solver.result import QPOptions, QPResult, QPStatus
from bemcontact.formulations.scaling import ScaledContact, scale
from bemcontact.frozen import frozen
from bemcontact.options import Rows

WORTH_ELIMINATION = 250
"""Number of variables from which QP1 is minimized over the gaps alone."""


@frozen
class Equations:
    """A x = b over x of N entries: `matrix` (m, N) and `right` (m,)."""

    matrix: Array
    right: Array

    def and_also(self, other: "Equations") -> "Equations":
        """These equations and others below them."""
        return Equations(matrix=np.vstack([self.matrix, other.matrix]), right=np.concatenate([self.right, other.right]))

    @property
    def of_unit_size(self) -> "Equations":
        """These equations with the largest entry of each row 1."""
        size = np.abs(self.matrix).max(axis=1, initial=0.0)
        size = np.where(size > 0, size, 1.0)
        return Equations(matrix=self.matrix / size[:, None], right=self.right / size)


@frozen
class Program:
    """Minimize pᵀJ(ε + u_n) + (1/μ)|E x - e|² subject to equations and ε + u_n >= 0, p >= 0.

    Parameters
    ----------
    weights : (n, n) scaled J
    penalized : E x = e; none of them, (0, N), in QP1
    penalty : μ
    equations : that hold exactly
    lower : (N,) bounds of x, -ε, 0 and for amplitudes -inf
    """

    weights: Array
    penalized: Equations
    penalty: float
    equations: Equations
    lower: Array

    @cached_property
    def hessian(self) -> Array:
        """H (N, N) of ½ xᵀH x + cᵀx + d."""
        n, J, E = len(self.weights), self.weights, self.penalized.matrix
        hessian = (2 / self.penalty) * (E.T @ E)
        hessian[:n, n : 2 * n] += J.T
        hessian[n : 2 * n, :n] += J
        return hessian

    @cached_property
    def linear(self) -> Array:
        """C (N,) of ½ xᵀH x + cᵀx + d."""
        n = len(self.weights)
        linear = -(2 / self.penalty) * (self.penalized.matrix.T @ self.penalized.right)
        linear[n : 2 * n] -= self.weights @ self.lower[:n]
        return linear

    @property
    def gives_pressure(self) -> bool:
        """Whether nothing is penalized, and the equations give each pressure, as stiffness rows do."""
        return not self.penalized.matrix.size and _pressure_factors(self.equations, len(self.weights)) is not None

    @property
    def inertia(self) -> tuple[int, int, int]:
        """Numbers of positive, zero and negative eigenvalues of the Hessian Q + (2/μ) EᵀE, Q = [[0, Jᵀ], [J, 0]].

        From [[Q, Eᵀ], [E, -μ/2]], whose inertia is that and m negative ones (Haynsworth 1968): it is free of 1/μ. With
        E = [K, -D], D diagonal, it is (n, 0, n) and that of JᵀD⁻¹K + KᵀD⁻¹J - (μ/2) JᵀD⁻²J.
        """
        n, J, (m, N) = len(self.weights), self.weights, self.penalized.matrix.shape
        if m == 0:
            diagonal = J.diagonal()
            rank = np.count_nonzero(diagonal) if np.count_nonzero(J - np.diag(diagonal)) == 0 else matrix_rank(J)
            return int(rank), N - 2 * int(rank), int(rank)
        if (D := _pressure_factors(self.penalized, n)) is not None:
            weighted = J / D[:, None]
            work = weighted.T @ self.penalized.matrix[:, :n]
            positive, zero, negative = inertia(work + work.T - 0.5 * self.penalty * (weighted.T @ weighted))
            return n + positive, zero, negative
        bordered = np.zeros((N + m, N + m))
        bordered[:n, n : 2 * n], bordered[n : 2 * n, :n] = J.T, J
        bordered[N:, :N], bordered[:N, N:] = self.penalized.matrix, self.penalized.matrix.T
        bordered[N:, N:] = -0.5 * self.penalty * np.eye(m)
        positive, zero, negative = inertia(bordered)
        return positive, zero, negative - m

    def value(self, x: Array) -> float:
        """Objective at x (N, more may follow); multiplied out, it would cancel to round-off."""
        n, x = len(self.weights), x[: len(self.lower)]
        residual = self.penalized.matrix @ x - self.penalized.right
        work = x[n : 2 * n] @ self.weights @ (x[:n] - self.lower[:n])
        return float(work + residual @ residual / self.penalty)


def contact_equations(contact: CondensedContact, rows: Rows) -> Equations:
    """K u_n - B p = r, (12), in scaled numbers, so that a residual is a part of the scale T or U.

    The stiffness rows are over (u_n, p), the compliance rows over (u_n, p, a).
    """
    U, T = contact.scales
    if rows is Rows.STIFFNESS:
        K, B, r = contact.stiffness_rows
        return Equations(matrix=np.hstack([K * (U / T), -B]), right=r / T)
    scaled = scale(contact)
    matrix = np.hstack([np.eye(contact.size), -scaled.compliance, -scaled.rigid_motions])
    return Equations(matrix=matrix, right=contact.free_displacement / U)


def equilibrium(scaled: ScaledContact, size: int) -> Equations:
    """ℓᵀp = -load over x of `size` entries."""
    n, k = scaled.rigid_motions.shape
    matrix = np.zeros((k, size))
    matrix[:, n : 2 * n] = scaled.equilibrium.T
    return Equations(matrix=matrix, right=-scaled.motion_load)


def _pressure_factors(equations: Equations, n: int) -> Array | None:
    """D (n,), positive, if the equations are K u_n - D p = r over (u_n, p), with D diagonal; else None."""
    m, N = equations.matrix.shape
    if not m == n == N - n or np.count_nonzero(equations.matrix[:, n:]) != n:
        return None
    D = -equations.matrix[:, n:].diagonal()
    return D if (D > 0.0).all() else None


def no_equations(size: int) -> Equations:
    """No equations, over x of `size` entries."""
    return Equations(matrix=np.zeros((0, size)), right=np.zeros(0))


def lower_bounds(contact: CondensedContact, size: int) -> Array:
    """Lower bounds of x of `size` entries: -ε, 0, and -inf for amplitudes."""
    n = contact.size
    gap = contact.initial_gap / contact.scales.displacement
    return np.concatenate([-gap, np.zeros(n), np.full(size - 2 * n, -np.inf)])


def minimize_program(program: Program, start: Array, max_iterations: int | None) -> QPResult:
    """Minimize a program by the local solver from a start (N,); the point and ray of the result are over x.

    Penalized equations become √μ s = E x - e with |s|² in the objective, which avoids the condition of EᵀE; s follows
    x in the point and the ray. In large programs pressures that the equations give are eliminated.
    """
    start = np.maximum(start, program.lower)
    if len(program.lower) > WORTH_ELIMINATION and program.gives_pressure:
        result = _minimize_over_gaps(program, start, max_iterations)
        if result.status is not QPStatus.INFEASIBLE:  # the rows of a singular compliance are round-off: all decide
            return result
    E, e = program.penalized.matrix, program.penalized.right
    A, b = program.equations.matrix, program.equations.right
    n, (m, N), root = len(program.weights), E.shape, np.sqrt(program.penalty)
    J, zero = program.weights, np.zeros((n, n))
    H = block_diag(np.block([[zero, J.T], [J, zero]]), np.zeros((N - 2 * n, N - 2 * n)), 2 * np.eye(m))
    c = np.zeros(N + m)
    c[n : 2 * n] = -J @ program.lower[:n]
    right = np.concatenate([b, e])
    return minimize_qp(
        H,
        c,
        A=np.block([[A, np.zeros((len(b), m))], [E, -root * np.eye(m)]]),
        cl=right,
        cu=right,
        bl=np.concatenate([program.lower, np.full(m, -np.inf)]),
        x0=np.concatenate([start, (E @ start - e) / root]),
        options=QPOptions(max_iterations=max_iterations),
    )


def _minimize_over_gaps(program: Program, start: Array, max_iterations: int | None) -> QPResult:
    """Minimize QP1 over the gaps ε + u_n, with p = D⁻¹(K u_n - r) from its equations K u_n - D p = r, D > 0 diagonal.

    The bounds of the pressures are the rows K u_n >= r. The points on the way are those of a start in (u_n, p) that
    satisfies the equations.
    """
    J, n = program.weights, len(program.weights)
    K, r, low = program.equations.matrix[:, :n], program.equations.right, program.lower[:n]
    D, right = -program.equations.matrix[:, n:].diagonal(), r - K @ low
    work = J.T @ (K / D[:, None])
    result = minimize_qp(
        work + work.T,
        -J.T @ (right / D),
        A=K,
        cl=right,
        bl=np.zeros(n),
        x0=start[:n] - low,
        options=QPOptions(max_iterations=max_iterations),
    )
    gap, ray = result.x, result.ray
    pressure = np.where(result.working_set[n:], 0.0, np.maximum((K @ gap - right) / D, 0.0))
    return replace(
        result,
        x=np.concatenate([low + gap, pressure]),
        ray=None if ray is None else np.concatenate([ray, (K @ ray) / D]),
    )
