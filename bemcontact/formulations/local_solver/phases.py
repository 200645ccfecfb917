"""Phase one, phase two and the search behind zero multipliers, until something can be claimed of the point."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bemcontact.arrays import Array
from bemcontact.formulations.local_solver.factorizations import Inertia, inertia
from bemcontact.formulations.local_solver.optimality import FirstOrder, certified, cleaned_ray, examine, first_order
from bemcontact.formulations.local_solver.phase_one import reach_feasibility, violated_signs
from bemcontact.formulations.local_solver.phase_two import Descent, Ending
from bemcontact.formulations.local_solver.pivoting import nearest
from bemcontact.formulations.local_solver.progress import Progress
from bemcontact.formulations.local_solver.result import QPStatus
from bemcontact.formulations.local_solver.statement import EPS, Sides, largest
from bemcontact.formulations.local_solver.working_set import WorkingSet

FAILURES = 6
"""Times that a claim which fails when recomputed is taken up again with fresh factors."""


FINER = 1e-2
"""Part of the tolerance of phase one that counts after each failure."""


@dataclass(frozen=True, kw_only=True)
class Finding:
    """The end of a run in scaled units.

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


@np.errstate(divide="ignore", invalid="ignore", over="ignore")  # ratio tests divide by what does not move
def run_phases(progress: Progress, sides: Sides) -> tuple[Finding, Inertia]:
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
        working, certificate = reach_feasibility(progress, sides, FINER**failures)
        sides = working.sides
        if certificate is not None:
            certificate = certified(progress.statement, certificate)
            if certificate is not None:
                return _finding(progress, QPStatus.INFEASIBLE, sides, certificate=certificate), start or (0, 0, 0)
            failures += 1
            continue
        if progress.exhausted and violated_signs(progress).any():
            break
        descent = Descent(progress, working)
        start = start or reduced_inertia(descent)
        found = _second_phase(progress, descent)
        if isinstance(found, Finding):
            return found, start
        sides, failures = found.sides, failures + found.failed
        if progress.exhausted:
            break
    status = QPStatus.ITERATION_LIMIT if progress.exhausted else QPStatus.NUMERICAL_FAILURE
    return _finding(progress, status, sides), start or (0, 0, 0)


def _second_phase(progress: Progress, descent: Descent) -> Finding | Restart:
    """Descend, then check what the end of the descent suggests."""
    outcome = descent.run()
    if outcome.ending is Ending.LIMIT:
        return _finding(progress, QPStatus.ITERATION_LIMIT, descent.working.sides)
    if outcome.ending is Ending.UNBOUNDED and outcome.ray is not None:
        ray = cleaned_ray(progress, outcome.ray)
        if ray is None:
            return Restart(sides=descent.working.sides, failed=True)
        return _finding(progress, QPStatus.UNBOUNDED, descent.working.sides, ray=ray)
    if outcome.ending is Ending.INACCURATE:
        return Restart(sides=descent.working.sides, failed=True)
    multipliers = descent.working.of_all(descent.multipliers)
    conditions = first_order(progress, multipliers, descent.zero)
    if not conditions.holds:
        return Restart(sides=descent.working.sides, failed=True)
    return _second_order(progress, descent, conditions, multipliers)


def _second_order(
    progress: Progress, descent: Descent, conditions: FirstOrder, multipliers: Array
) -> Finding | Restart:
    """A minimizer if H is copositive on the critical cone; else leave along the direction that shows it is not."""
    if _strict(descent, conditions):
        return _minimizer(descent, conditions, multipliers, QPStatus.LOCAL_MINIMIZER)
    curvature = examine(progress.statement.H, conditions.cone(progress.statement), faces=progress.options.search)
    if curvature.direction is None:
        status = QPStatus.LOCAL_MINIMIZER if curvature.copositive else QPStatus.UNDECIDED
        return _minimizer(descent, conditions, multipliers, status)
    direction = curvature.direction
    along = progress.statement.values(direction)
    block = nearest(progress, along, 1.0, conditions.strong)
    if block is None:
        ray = cleaned_ray(progress, direction)
        if ray is None:
            return Restart(sides=descent.working.sides, failed=True)
        return _finding(progress, QPStatus.UNBOUNDED, descent.working.sides, ray=ray)
    slope, curved = float(progress.gradient @ direction), float(direction @ progress.statement.H @ direction)
    rounding = 100.0 * EPS * abs(progress.objective)
    if block.step * (slope + 0.5 * block.step * curved) >= -rounding:
        return _second_order(progress, descent, conditions.stricter(along, block.constraint), multipliers)
    progress.move(along, block.step, 1.0)
    progress.look()
    held = int(np.count_nonzero(conditions.strong)) + 1
    progress.write(2, progress.objective / progress.unit, block.step, block.constraint, None, held, 1)
    return Restart(sides=progress.statement.sides_reached(progress.values, progress.slack), failed=False)


def _strict(descent: Descent, conditions: FirstOrder) -> bool:
    """Whether all that is held has a multiplier, nothing else is active, and H is definite on what is left free.

    Recomputed: with W N = I and W Z = 0 the columns of Z span the null space, and Zᵀ H Z = I.
    """
    working, hessian = descent.working, descent.hessian
    if working.temporary or np.count_nonzero(conditions.weak) or np.count_nonzero(working.held != conditions.strong):
        return False
    W, N, Z, H = working.W, working.N, hessian.Z, descent.progress.statement.H
    inverse = working.size == 0 or largest(W.dot(N) - np.eye(working.size)) < 1e-6
    complete = hessian.size + working.number == working.free.size
    if hessian.size == 0:
        return inverse and complete
    null = largest(W @ Z) <= 1e-9 * largest(Z)
    definite = largest(Z.T @ (H @ Z) - np.eye(hessian.size)) < 1e-3
    return inverse and null and definite and complete


def _minimizer(descent: Descent, conditions: FirstOrder, multipliers: Array, status: QPStatus) -> Finding:
    """What can be said at a first-order point."""
    return Finding(
        status=status,
        sides=descent.working.sides,
        multipliers=multipliers,
        reduced_end=reduced_inertia(descent),
        weak=conditions.weak.nonzero()[0],
    )


def _finding(
    progress: Progress, status: QPStatus, sides: Sides, *, ray: Array | None = None, certificate: Array | None = None
) -> Finding:
    """An end other than at a first-order point."""
    return Finding(
        status=status,
        sides=sides,
        multipliers=np.zeros(progress.values.size),
        reduced_end=reduced_inertia(Descent(progress, WorkingSet(progress.statement, sides))),
        weak=np.zeros(0, dtype=np.intp),
        ray=ray,
        certificate=certificate,
    )


def reduced_inertia(descent: Descent) -> Inertia:
    """Inertia of the reduced Hessian on the null space of the constraints that are not temporary.

    H is definite on the columns of Z and conjugate between them and the directions left over (Sylvester).
    """
    working, hessian = descent.working, descent.hessian
    if hessian.pending is None and not working.temporary:
        return hessian.size, 0, 0
    others = working.N[:, working.ids < 0]
    if hessian.pending is not None:
        others = np.column_stack([others, hessian.pending])
    H = descent.progress.statement.H
    others = others - hessian.Z @ (hessian.Z.T @ (H @ others))
    size = np.abs(others)
    noise = 100.0 * EPS * size.T @ descent.progress.statement.absolute[0] @ size
    positive, zero, negative = inertia(others.T @ H @ others, noise)
    return hessian.size + positive, zero, negative
