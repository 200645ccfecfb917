"""Primal-dual active set for the contact problem: guess who touches, solve linear equations, correct the guess.

It is Newton's method on min(p, δ) = 0 (Hintermüller, Ito and Kunisch, SIAM J. Optim. 13(3), 2002, 865-888): exact when
it stops, a handful of steps on contact problems, but it may cycle.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import get_lapack_funcs

from bemcontact.arrays import Array, BoolArray
from bemcontact.formulations.scaling import ScaledContact

EPS = float(np.finfo(float).eps)
STEP_LIMIT = 100
SETTLED = 1e-14
"""Residual of `ScaledContact.residual` that no further step can lower."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ActiveSetEnd:
    """The best point that the iteration has seen: p >= 0 (n,), a (k,), and the relative residual after each step."""

    pressure: Array
    amplitudes: Array
    residuals: tuple[float, ...]

    @property
    def residual(self) -> float:
        """That of the best point."""
        return min(self.residuals)

    @property
    def steps(self) -> int:
        """How many were made."""
        return len(self.residuals)


def first_active_set(problem: ScaledContact) -> BoolArray:
    """Points (n,) that would penetrate without pressure, {q < 0}; for a free body once it is laid as close as can be.

    "Close" is in the least squares of the weights: q is replaced by P q, P = I - R(ℓᵀR)⁻¹ℓᵀ.
    """
    R = problem.rigid_motions
    if not R.shape[1]:
        return problem.offset < 0
    return problem.offset <= R @ problem.amplitudes_of(problem.offset)


def primal_dual(problem: ScaledContact, active: BoolArray, limit: int = STEP_LIMIT) -> ActiveSetEnd:
    """Iterate from an active set until nothing changes, a set comes back, or the limit is reached.

    Each step solves `contact_equations`, then releases the points in tension and adds the points that penetrate.

    Parameters
    ----------
    problem : ScaledContact
    active : (n,) the points thought to be in contact
    limit : most steps to make

    Returns
    -------
    ActiveSetEnd
        The point of smallest residual; only the residual says whether it is a solution.
    """
    points: list[tuple[Array, Array]] = []
    residuals: list[float] = []
    visited: set[bytes] = set()
    while len(points) < limit and active.tobytes() not in visited:
        visited.add(active.tobytes())
        p, a = contact_equations(problem, active)
        points.append((np.maximum(p, 0.0), a))
        residuals.append(problem.residual(*points[-1]))
        if residuals[-1] <= SETTLED:
            break
        active = np.where(active, p > 0, problem.gap(p, a) < 0)
    pressure, amplitudes = points[residuals.index(min(residuals))]
    return ActiveSetEnd(pressure=pressure, amplitudes=amplitudes, residuals=tuple(residuals))


def contact_equations(problem: ScaledContact, active: BoolArray) -> tuple[Array, Array]:
    """Solve δ = 0 on the active set A, p = 0 off it, and ℓᵀp = -load.

    Parameters
    ----------
    problem : ScaledContact
    active : (n,) True on A

    Returns
    -------
    pressure : (n,), of either sign
    amplitudes : (k,)
        The shortest least-squares solution where A holds the body too little or too often.
    """
    A = np.flatnonzero(active)
    M, R, ell = problem.compliance[np.ix_(A, A)], problem.rigid_motions[A], problem.equilibrium[A]
    k = R.shape[1]
    unknowns = _solve(np.block([[M, R], [ell.T, np.zeros((k, k))]]), -np.append(problem.offset[A], problem.motion_load))
    pressure = np.zeros(len(active))
    pressure[A] = unknowns[: len(A)]
    return pressure, unknowns[len(A) :]


def _solve(matrix: Array, right: Array) -> Array:
    """LU with one step of iterative refinement; least squares where the matrix is singular to working precision."""
    if not right.size:
        return right
    factorise, condition, substitute = get_lapack_funcs(("getrf", "gecon", "getrs"), (matrix,))
    lu, pivots, singular = factorise(matrix)
    norm = np.abs(matrix).sum(axis=0).max()
    if singular or condition(lu, norm)[0] < len(right) * EPS:
        return np.asarray(np.linalg.lstsq(matrix, right, rcond=None)[0], float)
    x = substitute(lu, pivots, right)[0]
    return x + substitute(lu, pivots, right - matrix @ x)[0]
