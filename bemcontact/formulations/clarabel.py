"""The one way to Clarabel: a cvxpy problem is scaled, solved to tight tolerances, and brought back with its progress.

Clarabel is called directly, because cvxpy does not pass on the progress of a solver. Clarabel stops where residuals are
small beside one, whatever the unit of a row is. So rows and columns are brought to size one before, cone by cone,
unless the problem is dimensionless already (`conic_scaling`).

No settings serve all programs. Clarabel's own regularization is too weak for Hessians that are semidefinite to
round-off, a stronger one slows down others. So a few `ATTEMPTS` are made. The residuals of each end are computed anew
from the data of the program, and so are violations of the constraints as the user wrote them, relative to their terms.
They alone decide whether it is an answer. Where no attempt has one, a proof that there is none is looked for.
"""

import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from scipy.sparse import csc_array, triu

from bemcontact.arrays import Array
from bemcontact.contact.solution import Status
from bemcontact.errors import ProblemError, SolverError
from bemcontact.formulations.conic_scaling import Scaling, equilibrated, moved, size_of, symmetric, unscaled_end
from bemcontact.formulations.linear_rays import infeasible_ray, unbounded_ray
from bemcontact.formulations.presolve import FixedVariables
from bemcontact.interrupts import interrupts

ASKED, RAY = 1e-11, 1e-13
"""Tolerances that are asked of Clarabel, for a point and for a ray."""
AT_ONCE, GOOD, POOR = 1e-9, 1e-8, 1e-5
"""Residual that ends the attempts; up to which the best of them is an optimum; up to which it is an inaccurate one."""
PROOF = 1e-6
"""Error of a ray up to which it is a proof: nothing feasible is then smaller than a million times the data."""
ITERATIONS = 200
REFINEMENT = {
    "iterative_refinement_max_iter": 50,
    "iterative_refinement_stop_ratio": 1.5,
    "iterative_refinement_reltol": 1e-14,
    "iterative_refinement_abstol": 1e-14,
}
STATUSES = {
    "optimal": Status.SOLVED,
    "optimal_inaccurate": Status.SOLVED,
    "user_limit": Status.ITERATION_LIMIT,
    "infeasible": Status.INFEASIBLE,
    "unbounded": Status.UNBOUNDED,
    "infeasible_inaccurate": Status.NO_SOLUTION_FOUND,
    "unbounded_inaccurate": Status.NO_SOLUTION_FOUND,
}
"""Status of a cvxpy problem -> ours."""


LARGEST_COUNT = 2**32 - 1
"""Largest number of iterations that Clarabel can count to."""


class ClarabelSettings(NamedTuple):
    """Settings of Clarabel; whether the program is scaled the other way; whether its largest cost becomes one."""

    words: str
    settings: Mapping[str, Any]
    rescaled: bool = False
    costly: bool = False


ATTEMPTS = (
    ClarabelSettings("", {"static_regularization_constant": 1e-7, **REFINEMENT}),
    ClarabelSettings("with less regularization", {"static_regularization_constant": 1e-8}),
    ClarabelSettings("in another scaling", {"static_regularization_constant": 1e-7, **REFINEMENT}, rescaled=True),
    ClarabelSettings("with more regularization", {"static_regularization_constant": 1e-6, **REFINEMENT}),
    ClarabelSettings("in a larger unit of costs", {"static_regularization_constant": 1e-7, **REFINEMENT}, costly=True),
)
"""Made one after the other until one gives an answer."""


class Answer(NamedTuple):
    """How the attempts on a program ended.

    Parameters
    ----------
    progress : (iterations + 1, 2) the objective without its constant, and the residual of the constraints that Clarabel
        holds against its tolerance; one row less if Clarabel gave up in the last iteration
    failed : whether all attempts failed, so that the point that is left is no optimum
    accurate : whether the tolerance was reached, or nothing was to be reached, as with a proof
    note : which attempt gave the answer, or how inaccurate it is; empty if the first one did what was asked
    """

    progress: Array
    failed: bool
    accurate: bool
    note: str


@np.errstate(over="ignore", invalid="ignore")  # an attempt may diverge: what is not finite is no answer
def minimize_convex(
    problem: Any,
    max_iterations: int | None = None,
    *,
    equilibrate: bool = True,
    leave_point: bool = False,
    as_stated: bool = False,
) -> Answer:
    """Solve a convex cvxpy problem; its status and values are set as by its own `solve`, which has coarser tolerances.

    Rows and columns are scaled (`equilibrate`), unless the problem is dimensionless. `ProblemError` if a parameter has
    no value. `SolverError` if Clarabel cannot state the problem, or no attempt is an answer; with `leave_point` the
    best point is left as an inaccurate one. With `as_stated` the constraints are checked as they were written, too.
    """
    import cvxpy as cp

    if unset := [parameter.name() for parameter in problem.parameters() if parameter.value is None]:
        raise ProblemError(f"parameter '{unset[0]}' has no value; set its value before the model is solved")
    try:
        data, chain, inverse = problem.get_problem_data(cp.CLARABEL, solver_opts={})
    except cp.SolverError as error:
        raise SolverError(f"Clarabel cannot solve this model: {error}; state it without integers") from error

    def put(end: _End) -> None:
        with warnings.catch_warnings(action="ignore", category=UserWarning):  # the status says the same
            problem.unpack_results(unscaled_end(end.solution, end.status, end.scaling), chain, inverse)

    ends = _ends(data, max_iterations, equilibrate=equilibrate)
    if as_stated:
        ends = (_as_stated(end, problem, put) for end in ends)
    end = _best_end(ends, max_iterations)
    if end.residual > GOOD and end.status != LIMIT:
        end = _proved(data, end)
    failed = end.residual > POOR and end.status != LIMIT
    if (failed and not leave_point) or not np.isfinite(end.residual):
        raise SolverError(
            "Clarabel found no solution of this model; look for terms of very different size, or loosen what was added"
        )
    put(end)
    return Answer(_finite(end.progress / np.array([end.scaling.s, 1.0])), failed, end.residual <= GOOD, end.note)


LIMIT = "MaxIterations"
RAYS = "PrimalInfeasible", "DualInfeasible"
"""Ends of Clarabel that are proofs."""


class _End(NamedTuple):
    """End of an attempt, with its status as Clarabel names it, and its residuals computed anew."""

    status: str
    residual: float
    note: str
    solution: Any
    progress: Array
    scaling: Scaling


def _proved(data: dict[str, Any], end: _End) -> _End:
    """A proof that there is no solution, if there is one; else the end of the attempts."""
    scalings = equilibrated(data), equilibrated(data, costly=True)
    for ray_of in (infeasible_ray, _end_without_costs, unbounded_ray):
        for scaled, scaling in scalings:
            ray = ray_of(scaled)
            status, residual = _judged_in(scalings, ray, scaling) if ray else ("", np.inf)
            if status in RAYS and residual == 0.0:
                return end._replace(status=status, residual=0.0, note="", solution=ray, scaling=scaling)
    return end


def _end_without_costs(data: dict[str, Any]) -> Any:
    """Clarabel's end of a program without its costs, of which it may otherwise see nothing else."""
    nothing = {name: 0.0 * data[name] for name in ("P", "c") if name in data}
    return _solve(data | nothing, ATTEMPTS[0].settings, ITERATIONS)[0]


def _best_end(made: Iterator[_End], max_iterations: int | None) -> _End:
    """The first end that is an answer or at the limit of iterations, or the best one."""
    ends: list[_End] = []
    for end in made:
        ends.append(end)
        if end.status in RAYS or end.residual <= AT_ONCE or end.solution.iterations >= (max_iterations or np.inf):
            return end
    return min(ends, key=lambda end: end.residual)


def _as_stated(end: _End, problem: Any, put: Callable[[_End], None]) -> _End:
    """An end, with the violation of the constraints as they were written where that is larger than its residual."""
    if end.status in (*RAYS, LIMIT) or not np.isfinite(end.residual):
        return end
    put(end)
    violation = max((_violation(constraint) for constraint in problem.constraints), default=0.0)
    if violation <= max(GOOD, end.residual):
        return end
    note = f"constraints of the model are violated by {violation:.0e} of their terms"
    return end._replace(status="AlmostSolved", residual=violation, note="; ".join(filter(None, (end.note, note))))


def _violation(constraint: Any) -> float:
    """Violation of a constraint at the present values, relative to the largest of the terms in it."""
    violation = size_of(np.asarray(constraint.violation(), float))
    if violation <= AT_ONCE:  # a variable that vanishes has no size
        return 0.0
    return violation / max((_terms(part) for part in constraint.args), default=1.0)


def _terms(part: Any) -> float:
    """Largest size of an expression, and of its derivatives times the largest entries of its variables."""
    size = np.abs(np.asarray(part.value)).ravel(order="F").astype(float)
    for variable, slope in part.grad.items():
        if slope is not None:
            size = size + np.asarray(np.abs(slope).sum(axis=0)).ravel() * size_of(np.asarray(variable.value))
    return max(size_of(size), AT_ONCE)


def _ends(data: dict[str, Any], max_iterations: int | None, *, equilibrate: bool) -> Iterator[_End]:
    """Make the attempts. A point of another scaling is judged in the first one too, where sizes are one.

    A proof has to hold in each scaling: what is small beside the numbers of one may be all there is in another.
    """
    first = equilibrated(data) if equilibrate else (data, Scaling())
    costly = cache(lambda: equilibrated(data, costly=True))
    for attempt in ATTEMPTS:
        chosen = first
        if attempt.costly:
            chosen = costly()
        elif attempt.rescaled:
            chosen = (data, Scaling()) if equilibrate else equilibrated(data)
        solution, progress = _solve(chosen[0], attempt.settings, max_iterations or ITERATIONS)
        status, residual = _judged(chosen[0], solution)
        others = [first, costly()] if status in RAYS else [first]
        status, residual = max(
            (status, residual),
            _judged_in([other for other in others if other is not chosen], solution, chosen[1]),
            key=lambda end: end[1],
        )
        if status not in RAYS and residual > GOOD and solution.iterations >= (max_iterations or np.inf):
            status = LIMIT
        yield _End(status, residual, _note(attempt, status, residual), solution, progress, chosen[1])


def _judged_in(
    scalings: Sequence[tuple[dict[str, Any], Scaling]], solution: Any, scaling: Scaling
) -> tuple[str, float]:
    """The worst that `_judged` says of a point or ray of one scaling in others; nothing, with none of them."""
    ends = (_judged(scaled, moved(solution, scaling, other)) for scaled, other in scalings)
    return max(ends, key=lambda end: end[1], default=("", -np.inf))


def _note(attempt: ClarabelSettings, status: str, residual: float) -> str:
    """Say which attempt this was, unless it is the first, and how inaccurate its end is."""
    notes = [f"Clarabel answered {attempt.words}, after other attempts"] if attempt.words else []
    if status not in (*RAYS, LIMIT) and residual > GOOD:
        notes.append(f"the tolerance asked of the solver was not reached: residual {residual:.0e}")
    return "; ".join(notes)


def _judged(data: dict[str, Any], solution: Any) -> tuple[str, float]:
    """The status that the residuals of an end allow, and the largest of them: relative for a point, 0 for a proof.

    A row is held against its own terms, or one. A column is held against its own terms, one, or the part of the largest
    terms that was asked of Clarabel.
    """
    x, z, s = (np.array(part) for part in (solution.x, solution.z, solution.s))
    A, b, c = data["A"], data["b"], data["c"]
    curved = symmetric(data) @ x
    status = str(solution.status).removeprefix("Almost")
    if status == RAYS[0]:
        z = _balanced(csc_array(A), z, data["dims"])
        return (status, 0.0) if _is_ray(b, z, A.T @ z) else ("Unsolved", np.inf)
    if status == RAYS[1]:
        return (status, 0.0) if _is_ray(c, x, np.append(curved, A @ x + s)) else ("Unsolved", np.inf)
    primal, dual = c @ x + x @ curved / 2, -(b @ z) - x @ curved / 2
    terms = np.maximum(1.0, np.abs(curved) + np.abs(c) + abs(A).T @ np.abs(z))
    residuals = (
        size_of((A @ x + s - b) / np.maximum(1.0, abs(A) @ np.abs(x) + np.abs(b))),
        size_of((curved + c + A.T @ z) / np.maximum(terms, ASKED / GOOD * size_of(terms))),
        abs(primal - dual) / max(1.0, min(abs(primal), abs(dual))),
        _outside(data["dims"], s, z),
    )
    residual = float(np.max(residuals))  # with nan if one is
    if not np.isfinite(residual):
        return "Unsolved", np.inf
    return "Solved" if residual <= GOOD else "AlmostSolved", residual


def _balanced(A: csc_array, z: Array, dims: Any) -> Array:
    """Multipliers for which Aᵀz is zero up to rounding: the least change of equations and of inequalities in use."""
    row = np.arange(len(z))
    signed = (row >= dims.zero) & (row < dims.zero + dims.nonneg) & (z > PROOF * size_of(z))
    used, changed = signed | (row < dims.zero), z.copy()
    changed[used] -= np.linalg.lstsq(A[used].T.toarray(), A.T @ z)[0]
    return changed if (changed[signed] >= 0.0).all() else z


def _is_ray(slope: Array, ray: Array, rest: Array) -> bool:
    """Whether a ray goes down, and by more than the rest, which should vanish, could feign where the slope is large."""
    down = -float(slope @ ray) - len(ray) * float(np.finfo(float).eps) * float(np.abs(slope) @ np.abs(ray))
    return bool(down > 0.0 and max(1.0, size_of(slope)) * size_of(rest) <= PROOF * down)


def _outside(dims: Any, s: Array, z: Array) -> float:
    """How far slacks and multipliers of equations and inequalities are outside; other cones Clarabel never leaves."""
    inequalities = slice(dims.zero, dims.zero + dims.nonneg)
    return max(size_of(s[: dims.zero]), *(size_of(np.minimum(part[inequalities], 0.0)) for part in (s, z)))


def _solve(data: dict[str, Any], chosen: Mapping[str, Any], max_iterations: int) -> tuple[Any, Array]:
    """Clarabel's solution of the cone program of cvxpy, and its progress as of `Answer`.

    Clarabel does not see variables that one equation alone fixes.
    """
    fixed = FixedVariables(data)
    solution, progress = _solve_rest(fixed.rest(), chosen, max_iterations)
    proof, descent = (str(solution.status).endswith(ray) for ray in RAYS)
    return fixed.whole(solution, proof=proof, descent=descent), progress + np.array([fixed.constant, 0.0])


def _solve_rest(data: dict[str, Any], chosen: Mapping[str, Any], max_iterations: int) -> tuple[Any, Array]:
    """Clarabel's own solution of a cone program, and its progress."""
    from clarabel import DefaultSettings, DefaultSolver  # pyright: ignore (has no stubs)
    from cvxpy.reductions.solvers.conic_solvers.clarabel_conif import dims_to_solver_cones

    settings = DefaultSettings()
    settings.verbose, settings.max_iter = False, min(max_iterations, LARGEST_COUNT)
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = ASKED
    settings.tol_infeas_abs = settings.tol_infeas_rel = RAY
    settings.max_threads = 1  # more take longer with hundreds of points, as of BLAS
    for name, value in chosen.items():
        setattr(settings, name, value)
    P = triu(symmetric(data), format="csc")
    solver = DefaultSolver(P, data["c"], data["A"], data["b"], dims_to_solver_cones(data["dims"]), settings)
    rows: list[tuple[float, float]] = []

    with interrupts() as interrupted:

        def look(info: Any) -> bool:
            rows.append((info.cost_primal, info.res_primal))
            return bool(interrupted)

        solver.set_termination_callback(look)
        solution = solver.solve()
    if rows and np.isfinite(solution.obj_val):
        rows[-1] = solution.obj_val, solution.r_prim  # Clarabel may have withdrawn its last step
    return solution, _finite(np.array(rows).reshape(-1, 2))


def _finite(progress: Array) -> Array:
    """The rows before the first that is not finite."""
    return progress[np.logical_and.accumulate(np.isfinite(progress).all(axis=1))]
