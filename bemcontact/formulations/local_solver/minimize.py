"""`minimize_qp`: scale the data, run both phases until a claim passes its check, and return to the given units."""

from collections.abc import Callable
from functools import lru_cache
from importlib import import_module
from math import isfinite
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bemcontact import compilation
from bemcontact.arrays import Array, BoolArray, whole_array
from bemcontact.errors import ProblemError
from bemcontact.formulations.local_solver.equilibration import (
    Scales,
    Scaling,
    equilibrate,
    scaled_data,
    unequilibrated,
)
from bemcontact.formulations.local_solver.factorizations import Inertia, inertia
from bemcontact.formulations.local_solver.infeasibility import proof_of_infeasibility
from bemcontact.formulations.local_solver.optimality import FirstOrder, cleaned_ray, examine, first_order
from bemcontact.formulations.local_solver.phase_one import is_violated, reach_feasibility
from bemcontact.formulations.local_solver.phase_two import WORTH_EDGES, Descent, Ending
from bemcontact.formulations.local_solver.progress import FINER, PARALLEL, SearchState
from bemcontact.formulations.local_solver.ratio_test import nearest
from bemcontact.formulations.local_solver.result import QPOptions, QPResult, QPStatus
from bemcontact.formulations.local_solver.statement import (
    EPS,
    Sides,
    Statement,
    largest,
    numbers,
    read_statement,
)
from bemcontact.formulations.local_solver.working_set import WorkingSet, supporting
from bemcontact.frozen import frozen_value
from bemcontact.threads import one_thread

Iterations = Callable[[SearchState, Sides], Sides]
"""A function with the parameters of `tableau.regular_iterations`."""
MachineCode = tuple[Scaling, Iterations | None]
"""What machine code can do: the scaling, and the regular iterations of both phases."""
IN_NUMPY: MachineCode = scaled_data, None
DEFAULTS = QPOptions()
RENEWALS = 3
"""Largest number of restarts from a stationary point that is doubtful, or which the run has reached from far away."""
FAILURES = 6
"""Largest number of restarts with new factors after a claim failed its check."""


@frozen_value
class Finding:
    """Result of a run in scaled units.

    Parameters
    ----------
    status : what is claimed
    sides : (n + m,) working set
    multipliers : (n + m,) of all constraints; zero where no first-order point is claimed
    reduced_end : inertia of the reduced Hessian
    weak : active inequalities without a multiplier
    ray, certificate : of unboundedness, of infeasibility
    """

    status: QPStatus
    sides: Sides
    multipliers: Array
    reduced_end: Inertia
    weak: NDArray[np.intp]
    ray: Array | None = None
    certificate: Array | None = None


@frozen_value
class Restart:
    """The working set to continue from, and whether a claim failed."""

    sides: Sides
    failed: bool


def run_phases(
    progress: SearchState, sides: Sides, by_machine_code: Iterations | None = None
) -> tuple[Finding, Inertia]:
    """Repeat both phases until a claim passes its check, or until iterations or attempts are exhausted.

    Machine code, if there is any, takes the regular iterations before each of the first attempts.
    The second result is the inertia of the reduced Hessian at the start of phase two; zeros if it was not reached.
    """
    failures = renewals = 0
    start: Inertia | None = None
    while failures < FAILURES:
        if by_machine_code is not None and failures == 0:
            sides = by_machine_code(progress, sides)
        working, certificate = reach_feasibility(progress, sides, FINER**failures)
        sides = working.sides
        if certificate is not None:
            statement = progress.statement
            rows = certificate[progress.x.size :]
            certificate = proof_of_infeasibility(statement.A, statement.lower, statement.upper, rows, progress.x)
            if certificate is not None:
                return _finding(progress, QPStatus.INFEASIBLE, sides, certificate=certificate), start or (0, 0, 0)
            failures += 1
            continue
        if progress.exhausted and is_violated(progress):
            break
        descent = Descent(progress, working)
        start = start or reduced_inertia(descent)
        end = _second_phase(progress, descent, renewals)
        if isinstance(end, Finding):
            return end, start
        sides, renewals = end.sides, renewals + 1
        if end.failed:
            failures += 1
            progress.tighten()
        if progress.exhausted:
            break
    status = QPStatus.ITERATION_LIMIT if progress.exhausted else QPStatus.NUMERICAL_FAILURE
    return _finding(progress, status, sides), start or (0, 0, 0)


def _second_phase(progress: SearchState, descent: Descent, renewals: int) -> Finding | Restart:
    """Run phase two, then check the claim that its end suggests; `renewals` is the number of restarts from it."""
    outcome = descent.run()
    if outcome.ending is Ending.LIMIT:
        return _finding(progress, QPStatus.ITERATION_LIMIT, descent.working.sides)
    if outcome.ending is Ending.UNBOUNDED and outcome.ray is not None:
        progress.place(descent.working.onto(progress.x))  # the rounding of the steps has a slope too
        ray = cleaned_ray(progress, outcome.ray)
        if ray is None:
            return Restart(sides=descent.working.sides, failed=True)
        _inwards(progress, ray)
        return _finding(progress, QPStatus.UNBOUNDED, descent.working.sides, ray=ray)
    if outcome.ending is Ending.INACCURATE:
        return Restart(sides=descent.working.sides, failed=descent.broken or renewals >= RENEWALS)
    working = descent.working
    multipliers, zeros = working.of_all(descent.multipliers), working.of_all(descent.zeros)
    conditions = first_order(progress, working.held, multipliers, zeros, lambda: working.of_all(descent.sizes))
    if (progress.worn or conditions.doubtful) and renewals < RENEWALS:
        return Restart(sides=descent.working.sides, failed=False)
    if not conditions.holds:
        return Restart(sides=descent.working.sides, failed=True)
    return _second_order(progress, descent, conditions, multipliers)


def _inwards(progress: SearchState, ray: Array) -> None:
    """Move along the ray until it no longer reduces a violation; a violation within tolerance may be a large part."""
    speed = np.abs(progress.statement.values(ray))
    steps = progress.violation / speed
    step = steps[speed > PARALLEL].max(initial=0.0)
    if step > 0.0:
        progress.place(progress.x + step * ray)


def _second_order(
    progress: SearchState, descent: Descent, conditions: FirstOrder, multipliers: Array
) -> Finding | Restart:
    """Claim a minimizer if H is copositive on the critical cone; else move along a direction of negative curvature."""
    if not conditions.doubtful and _strict(descent, conditions):
        return _minimizer(descent, conditions, multipliers, QPStatus.LOCAL_MINIMIZER)
    curvature = examine(progress.statement.H, conditions.cone(progress.statement), faces=progress.options.search)
    if curvature.direction is None:
        proved = curvature.copositive and not conditions.doubtful
        status = QPStatus.LOCAL_MINIMIZER if proved else QPStatus.UNDECIDED
        return _minimizer(descent, conditions, multipliers, status)
    direction = curvature.direction
    along = progress.statement.values(direction)
    block = nearest(progress, along, 1.0, conditions.strong)
    if block is None:
        ray = cleaned_ray(progress, direction)
        if ray is None:
            return Restart(sides=descent.working.sides, failed=True)
        _inwards(progress, ray)
        return _finding(progress, QPStatus.UNBOUNDED, descent.working.sides, ray=ray)
    slope, curved = float(progress.gradient @ direction), float(direction @ progress.statement.H @ direction)
    rounding = 100.0 * EPS * float(progress.terms(direction[:0], progress.statement.A[:0]) @ np.abs(direction))
    if slope + 0.5 * block.step * curved >= -rounding or block.step <= EPS * max(1.0, largest(progress.x)):
        return _second_order(progress, descent, conditions.stricter(along, block.constraint), multipliers)
    progress.move(along, block.step, 1.0)
    progress.look()
    held = int(np.count_nonzero(conditions.strong)) + 1
    progress.write(2, progress.objective / progress.unit, block.step, block.constraint, None, held, 1)
    return Restart(sides=progress.statement.sides_reached(progress.values, progress.sharp), failed=False)


def _strict(descent: Descent, conditions: FirstOrder) -> bool:
    """Whether the held constraints are the active ones, all have multipliers, and the reduced Hessian is definite."""
    # computed from the data: W N = I, W Z = 0, Zᵀ H Z = I, and the columns of Z span the null space
    working, hessian = descent.working, descent.hessian
    if working.temporary or np.count_nonzero(conditions.weak) or np.count_nonzero(working.held != conditions.strong):
        return False
    W, N, Z, H = working.W, working.N, hessian.Z, descent.progress.statement.H
    if hessian.size + working.number != working.free.size or (working.size and not _off_identity(W.dot(N)) < 1e-6):
        return False
    if hessian.size == 0:
        return True
    return largest(W.dot(Z)) <= 1e-9 * largest(Z) and _off_identity(Z.T.dot(H.dot(Z))) < 1e-3


def _off_identity(matrix: Array) -> float:
    """The largest entry of a square matrix from which the identity is subtracted."""
    matrix.reshape(-1)[:: len(matrix) + 1] -= 1.0
    return largest(matrix)


def _minimizer(descent: Descent, conditions: FirstOrder, multipliers: Array, status: QPStatus) -> Finding:
    """Finding at a first-order point."""
    return Finding(
        status=status,
        sides=descent.working.sides,
        multipliers=multipliers,
        reduced_end=reduced_inertia(descent),
        weak=conditions.weak.nonzero()[0],
    )


def _finding(
    progress: SearchState, status: QPStatus, sides: Sides, *, ray: Array | None = None, certificate: Array | None = None
) -> Finding:
    """Finding at a point that is not claimed to be of first order."""
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

    H is definite on the columns of Z. The other directions are made conjugate to them (Sylvester).
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


@one_thread
@np.errstate(divide="ignore", invalid="ignore", over="ignore")  # ratio tests divide by slopes that may be zero
def minimize_qp(
    H: Any,
    c: ArrayLike,
    A: Any = None,
    cl: ArrayLike | None = None,
    cu: ArrayLike | None = None,
    bl: ArrayLike | None = None,
    bu: ArrayLike | None = None,
    x0: ArrayLike | None = None,
    options: QPOptions | None = None,
    working_set: ArrayLike | None = None,
) -> QPResult:
    """Find a local minimizer of cᵀx + xᵀHx/2 over cl <= A x <= cu, bl <= x <= bu, H of any inertia.

    An inertia-controlling active-set method (Gill, Murray, Saunders and Wright, SIAM Review 33 (1991) 1-36).

    Parameters
    ----------
    H : (n, n) array or sparse matrix
        Symmetric.
    c : (n,) array
    A : (m, n) array or sparse matrix, optional
    cl, cu : (m,) arrays, optional
        Bounds of the rows; infinite, or 1e20 and more in size, where there is none; cl = cu is an equality.
    bl, bu : (n,) arrays, optional
        Bounds of the variables, likewise.
    x0 : (n,) array, optional
        Start; the null vector if absent. It is moved to the nearest point between bl and bu.
    options : QPOptions, optional
        Tolerances, limits, log.
    working_set : (n + m,) int array, optional
        Start of the working set, as in the ``working_set`` of `QPResult`; all that is active at x0 if absent.

    Returns
    -------
    QPResult
        The point, its status, and the evidence for it.

    Raises
    ------
    ProblemError
        The data do not state a quadratic program.
    """
    if options is None:
        options = DEFAULTS
    elif not isinstance(options, QPOptions):
        found = type(options).__name__
        raise ProblemError(f"options is a {found}: give a QPOptions, as in QPOptions(max_iterations=50)")
    stated = read_statement(H, c, A, cl, cu, bl, bu)
    n = stated.c.size
    start = np.zeros(n) if x0 is None else numbers("x0", x0, n)
    start = np.minimum(np.maximum(start, stated.lower[:n]), stated.upper[:n])
    scaling, regular_iterations = _machine_code(options, n)
    scaled, scales = equilibrate(stated, scaling) if options.scale else unequilibrated(stated)
    progress = SearchState(statement=scaled, options=options, unit=scales.objective, x=start / scales.variables)
    sides = progress.statement.sides_reached(progress.values, progress.slack)
    if working_set is not None:
        sides = np.where(_wanted(working_set, sides.size), sides, 0).astype(np.int8)
    elif x0 is not None:
        sides = supporting(progress, sides)
    finding, reduced_start = run_phases(progress, sides, regular_iterations)
    return _result(stated, scales, progress, finding, reduced_start)


def _machine_code(options: QPOptions, n: int) -> MachineCode:
    """`IN_NUMPY` without numba, where machine code is not wanted, and where the program is large."""
    wanted = compilation.numba_is_imported() if options.by_numba is None else options.by_numba
    return _by_numba() if wanted and n <= WORTH_EDGES else IN_NUMPY


@lru_cache(maxsize=1)
def _by_numba() -> MachineCode:
    """The functions of this package that import numba; the first call of each compiles it, which takes seconds once."""
    package = "bemcontact.formulations.local_solver"
    try:
        scaling, tableau = (import_module(f"{package}.{module}") for module in ("compiled_scaling", "tableau"))
    except ImportError:
        return IN_NUMPY
    return scaling.scaled_data_by_loops, tableau.regular_iterations


def _wanted(working_set: ArrayLike, size: int) -> BoolArray:
    """Whether the given working set contains each constraint (n + m,)."""
    wanted = whole_array(working_set, "working_set")
    if wanted.shape != (size,) or not np.isin(wanted, (-1, 0, 1, 2)).all():
        raise ProblemError(f"working_set must be ({size},) integers of -1, 0, 1, 2, as in QPResult.working_set")
    return wanted != 0


def _result(stated: Statement, scales: Scales, progress: SearchState, finding: Finding, start: Inertia) -> QPResult:
    """The result in the units of the data."""
    n = stated.c.size
    x = np.minimum(np.maximum(scales.variables * progress.x, stated.lower[:n]), stated.upper[:n])
    multipliers = scales.multipliers(finding.multipliers) / scales.objective
    objective = stated.objective(x)
    finite = isfinite(largest(x)) and isfinite(largest(multipliers)) and isfinite(objective)
    first = [line.phase for line in progress.lines].count(1)
    return QPResult(
        x=x,
        status=finding.status if finite else QPStatus.NUMERICAL_FAILURE,
        objective=objective,
        bound_multipliers=multipliers[:n],
        constraint_multipliers=multipliers[n:],
        working_set=finding.sides,
        phase_one_iterations=first,
        phase_two_iterations=len(progress.lines) - first,
        working_set_changes=progress.changes,
        hessian=stated.H,
        reduced_inertia_start=start,
        reduced_inertia_end=finding.reduced_end,
        weakly_active=finding.weak,
        ray=None if finding.ray is None else scales.variables * finding.ray,
        certificate=None if finding.certificate is None else scales.multipliers(finding.certificate),
        by_numba=progress.by_numba,
        violation=largest(stated.violation(stated.values(x))),
        log=tuple(progress.lines),
    )
