"""`minimize_qp`: the data read and scaled, both phases, and its end in the units of the data."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from bemcontact.arrays import BoolArray
from bemcontact.errors import ProblemError
from bemcontact.formulations.local_solver.factorizations import Inertia
from bemcontact.formulations.local_solver.phases import Finding, run_phases
from bemcontact.formulations.local_solver.progress import Progress
from bemcontact.formulations.local_solver.result import QPOptions, QPResult
from bemcontact.formulations.local_solver.statement import Scales, Statement, equilibrate, numbers, read, unscaled


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
        Linear term.
    A : (m, n) array or sparse matrix, optional
        Rows.
    cl, cu : (m,) arrays, optional
        Bounds of the rows; infinite, or 1e20 and more in size, where there is none; cl = cu is an equality.
    bl, bu : (n,) arrays, optional
        Bounds of the variables, likewise.
    x0 : (n,) array, optional
        Start; the null vector if absent. It is moved to the nearest point between bl and bu.
    options : QPOptions, optional
        Tolerances, limits, log.
    working_set : (n + m,) int array, optional
        Start of the working set, as in `QPResult.working_set`; all that is active at x0 if absent.

    Returns
    -------
    QPResult
        The point, what is claimed of it, and what shows it.

    Raises
    ------
    ProblemError
        The data do not state a quadratic program.
    """
    if options is None:
        options = QPOptions()
    else:
        _check(options)
    stated = read(H, c, A, cl, cu, bl, bu)
    n = stated.c.size
    start = np.zeros(n) if x0 is None else numbers("x0", x0, n)
    start = np.minimum(np.maximum(start, stated.lower[:n]), stated.upper[:n])
    scaled, scales = equilibrate(stated) if options.scale else unscaled(stated)
    progress = Progress(statement=scaled, options=options, unit=scales.objective, x=start / scales.variables)
    sides = progress.statement.sides_reached(progress.values, progress.slack)
    if working_set is not None:
        sides = np.where(_wanted(working_set, sides.size), sides, 0).astype(np.int8)
    finding, reduced_start = run_phases(progress, sides)
    return _result(stated, scales, progress, finding, reduced_start)


def _check(options: QPOptions) -> None:
    """Refuse options without sense."""
    if not isinstance(options, QPOptions):
        raise ProblemError(
            f"options is a {type(options).__name__}: give a QPOptions, as in QPOptions(max_iterations=50)"
        )
    for name in ("feasibility_tolerance", "optimality_tolerance"):
        value = getattr(options, name)
        if not _is_number(value) or not 0.0 < value < 1e-2:
            raise ProblemError(f"{name} is {value!r}: give a number between 0 and 0.01, such as 1e-9")
    if options.max_iterations is not None and not _counts(options.max_iterations):
        raise ProblemError(f"max_iterations is {options.max_iterations!r}: give a whole number >= 0, or None")
    if not _counts(options.search):
        raise ProblemError(f"search is {options.search!r}: give the number of faces to examine, >= 0")
    if options.log is not None and not callable(options.log):
        raise ProblemError(f"log is {options.log!r}: give a function of a LogLine, such as print")


def _is_number(value: object) -> bool:
    """Whether this is a real number."""
    return isinstance(value, int | float | np.integer | np.floating) and not isinstance(value, bool)


def _counts(value: object) -> bool:
    """Whether this is a whole number that is not negative."""
    return isinstance(value, int | np.integer) and not isinstance(value, bool) and bool(value >= 0)


def _wanted(working_set: ArrayLike, size: int) -> BoolArray:
    """Which constraints a warm start names."""
    wanted = np.asarray(working_set)
    if wanted.shape != (size,) or not np.isin(wanted, (-1, 0, 1, 2)).all():
        raise ProblemError(f"working_set must be ({size},) integers of -1, 0, 1, 2, as in QPResult.working_set")
    return wanted != 0


def _result(stated: Statement, scales: Scales, progress: Progress, finding: Finding, start: Inertia) -> QPResult:
    """All of it in the units of the data."""
    n = stated.c.size
    x = np.minimum(np.maximum(scales.variables * progress.x, stated.lower[:n]), stated.upper[:n])
    multipliers = scales.multipliers(finding.multipliers) / scales.objective
    first = [line.phase for line in progress.lines].count(1)
    return QPResult(
        x=x,
        status=finding.status,
        objective=stated.objective(x),
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
        violation=float(stated.violation(stated.values(x)).max()),
        log=tuple(progress.lines),
    )
