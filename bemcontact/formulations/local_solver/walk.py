"""Phase one, phase two and the search behind zero multipliers, until something can be claimed of the point."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigvalsh

from bemcontact.formulations.local_solver.dead_point import examine
from bemcontact.formulations.local_solver.factors import Factors
from bemcontact.formulations.local_solver.phase_one import reach_feasibility
from bemcontact.formulations.local_solver.phase_two import Ending, descend, zero_gradient
from bemcontact.formulations.local_solver.progress import Progress
from bemcontact.formulations.local_solver.ratio_test import nearest
from bemcontact.formulations.local_solver.result import QPStatus
from bemcontact.formulations.local_solver.verdict import FirstOrder, certified, cleaned_ray, first_order

Array = NDArray[np.float64]
Sides = NDArray[np.int8]
Inertia = tuple[int, int, int]

FAILURES = 6
"""Times that a claim which fails when recomputed is taken up again with fresh factors."""


@dataclass(frozen=True, kw_only=True)
class Finding:
    """The end of the walk in scaled units.

    Parameters
    ----------
    status : QPStatus
        What is claimed.
    sides : (n + m,) int8 array
        Working set.
    multipliers : (n + m,) array
        Of all constraints; zero where no first-order point is claimed.
    reduced_end : (int, int, int)
        Inertia of the reduced Hessian.
    weak : int array
        Active inequalities without a multiplier.
    ray, certificate : array or None
        Of unboundedness, of infeasibility.
    """

    status: QPStatus
    sides: Sides
    multipliers: Array
    reduced_end: Inertia
    weak: NDArray[np.intp]
    ray: Array | None = None
    certificate: Array | None = None


@dataclass(frozen=True, kw_only=True)
class Restart:
    """The working set to go on from, and whether a claim failed."""

    sides: Sides
    failed: bool


def walk(progress: Progress, sides: Sides) -> tuple[Finding, Inertia]:
    """Rounds of both phases until a claim survives its check, or the iterations or attempts are used up.

    Returns
    -------
    finding : Finding
        What can be claimed.
    reduced_start : (int, int, int)
        Inertia of the reduced Hessian at the start of phase two; zeros if it was not reached.
    """
    failures = 0
    start: Inertia | None = None
    while failures < FAILURES:
        sides, certificate = reach_feasibility(progress, sides)
        if certificate is not None:
            certificate = certified(progress.statement, certificate)
            if certificate is not None:
                return _finding(progress, QPStatus.INFEASIBLE, sides, certificate=certificate), start or (0, 0, 0)
            failures += 1
            continue
        if progress.exhausted and failures + sum(progress.iterations):
            break
        # phase one ends within the tolerance; equalities are met as exactly as the arithmetic allows
        sides = np.where(progress.statement.lower == progress.statement.upper, 2, sides).astype(np.int8)
        factors = Factors(progress.statement, sides, curved=True)
        progress.place(progress.x + factors.onto(progress.values))
        start = start or reduced_inertia(factors)
        found = _second_phase(progress, factors)
        if isinstance(found, Finding):
            return found, start
        sides, failures = found.sides, failures + found.failed
    return _finding(progress, QPStatus.ITERATION_LIMIT, sides), start or (0, 0, 0)


def _second_phase(progress: Progress, factors: Factors) -> Finding | Restart:
    """Descend, then check what the end of the descent suggests."""
    outcome = descend(progress, factors)
    if outcome.ending is Ending.LIMIT:
        return _finding(progress, QPStatus.ITERATION_LIMIT, factors.sides)
    if outcome.ending is Ending.UNBOUNDED and outcome.ray is not None:
        ray = cleaned_ray(progress, outcome.ray)
        if ray is None:
            return Restart(sides=factors.sides, failed=True)
        return _finding(progress, QPStatus.UNBOUNDED, factors.sides, ray=ray)
    multipliers = _refined(progress, factors)
    conditions = first_order(progress, multipliers, zero_gradient(progress))
    if outcome.ending is Ending.INACCURATE or not conditions.holds:
        return Restart(sides=factors.sides, failed=True)
    return _second_order(progress, factors, conditions, multipliers)


def _second_order(
    progress: Progress, factors: Factors, conditions: FirstOrder, multipliers: Array
) -> Finding | Restart:
    """A minimiser if H is copositive on the critical cone; else leave along the direction that shows it is not."""
    cone = conditions.cone(progress.statement)
    curvature = examine(progress.statement.H, cone, faces=progress.options.search)
    if curvature.direction is None:
        return Finding(
            status=QPStatus.LOCAL_MINIMISER if curvature.copositive else QPStatus.UNDECIDED,
            sides=factors.sides,
            multipliers=multipliers,
            reduced_end=reduced_inertia(factors),
            weak=np.flatnonzero(conditions.weak),
        )
    direction = curvature.direction
    along = progress.statement.values(direction)
    block = nearest(progress, along, 1.0, ~conditions.strong)
    if block is None:
        ray = cleaned_ray(progress, direction)
        if ray is None:
            return Restart(sides=factors.sides, failed=True)
        return _finding(progress, QPStatus.UNBOUNDED, factors.sides, ray=ray)
    progress.move(direction, along, block.step)
    progress.write(
        phase=2,
        value=progress.statement.objective(progress.x),
        step=block.step,
        added=block.constraint,
        dropped=None,
        working=int(np.count_nonzero(conditions.strong)) + 1,
        nonpositive=1,
    )
    return Restart(sides=active(progress), failed=block.step <= 0.0)


def _finding(
    progress: Progress, status: QPStatus, sides: Sides, *, ray: Array | None = None, certificate: Array | None = None
) -> Finding:
    """An end other than at a first-order point."""
    return Finding(
        status=status,
        sides=sides,
        multipliers=np.zeros(progress.values.size),
        reduced_end=reduced_inertia(Factors(progress.statement, sides, curved=True)),
        weak=np.zeros(0, dtype=np.intp),
        ray=ray,
        certificate=certificate,
    )


def active(progress: Progress) -> Sides:
    """The side of each constraint that the point is on; 0 for the others."""
    statement, values = progress.statement, progress.values
    lower = np.abs(values - statement.lower) <= progress.slack
    upper = np.abs(values - statement.upper) <= progress.slack
    sides = np.where(lower, -1, np.where(upper, 1, 0))
    return np.where((sides != 0) & (statement.lower == statement.upper), 2, sides).astype(np.int8)


def _refined(progress: Progress, factors: Factors) -> Array:
    """Refine the equations of the working set from the data, twice; multipliers of all constraints."""
    for _ in range(2):
        progress.place(progress.x + factors.onto(progress.values))
        progress.place(progress.x + factors.newton(progress.statement.gradient(progress.x)))
    ids = np.array(factors.ids, dtype=np.intp)
    real = ids >= 0
    multipliers = np.zeros(progress.values.size)
    multipliers[ids[real]] = factors.multipliers(progress.statement.gradient(progress.x))[real]
    return multipliers


def inertia(matrix: Array, size: float) -> Inertia:
    """Numbers of positive, zero and negative eigenvalues; zero is relative to `size`."""
    eigenvalues = eigvalsh(matrix) if matrix.shape[0] else np.zeros(0)
    zero = 1e-12 * max(10, matrix.shape[0]) * size
    negative, positive = int(np.sum(eigenvalues < -zero)), int(np.sum(eigenvalues > zero))
    return positive, matrix.shape[0] - positive - negative, negative


def reduced_inertia(factors: Factors) -> Inertia:
    """Inertia of the reduced Hessian on the null space of the constraints that are not temporary."""
    temporary = np.array(factors.ids, dtype=np.intp) < 0
    if factors.pending is None and not temporary.any():
        return factors.Z.shape[1], 0, 0  # its Cholesky factor exists
    Z = np.hstack([factors.Z, factors.Y[:, temporary]])
    if factors.pending is not None:
        Z = np.column_stack([Z, factors.pending[0]])
    return inertia(Z.T @ factors.statement.H @ Z, factors.size)
