"""The one way to Clarabel: a cvxpy problem is scaled, solved to tight tolerances, and brought back with its progress.

Clarabel is called directly, because cvxpy does not pass on the progress of a solver. Clarabel stops where residuals are
small beside one, whatever the unit of a row is. So rows and columns are brought to size one before, cone by cone,
unless the problem is dimensionless already: units are taken out by the means of logarithms (Curtis and Reid, J. Inst.
Maths Applics 10, 1972, 118-124), and the largest entries become one (Ruiz, RAL-TR-2001-034). Ruiz's method alone stops
at any matrix whose largest entries are one, and leaves small what has a unit of its own, as a variable that cvxpy adds.
Limits and costs become one, too: under a light load the gaps of far points are millions of displacements, and beside
them everything else is small.

No settings serve all programs. Clarabel's own regularization is too weak for Hessians that are semidefinite to
round-off, a stronger one slows down others. So a few `ATTEMPTS` are made. The residuals of each end are computed anew
from the data of the program, and so are violations of the constraints as the user wrote them, relative to their terms.
They alone decide whether it is an answer. Where no attempt has one, a proof that there is none is looked for.
"""

import signal
import threading
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import cache
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array, diags_array, triu

from bemcontact.arrays import Array, IntArray
from bemcontact.contact.solution import Status
from bemcontact.errors import ProblemError, SolverError
from bemcontact.formulations.linear_rays import infeasible_ray, unbounded_ray
from bemcontact.formulations.presolve import FixedVariables

ASKED, RAY = 1e-11, 1e-13
"""Tolerances that are asked of Clarabel, for a point and for a ray."""
AT_ONCE, GOOD, POOR = 1e-9, 1e-8, 1e-5
"""Residual that ends the attempts; up to which the best of them is an optimum; up to which it is an inaccurate one."""
PROOF = 1e-6
"""Error of a ray up to which it is a proof: nothing feasible is then smaller than a million times the data."""
ITERATIONS = 200
MEANS = 20
"""Iterations of the means of logarithms."""
ROUNDS = 12
"""Iterations of Ruiz's method; each takes the square root of how far rows and columns are from one."""
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


class _Scaling(NamedTuple):
    """x = D x', rows times E, costs times s: arrays or numbers."""

    D: Array | float = 1.0
    E: Array | float = 1.0
    s: float = 1.0


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
            problem.unpack_results(_unscaled(end.solution, end.status, end.scaling), chain, inverse)

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
    scaling: _Scaling


def _proved(data: dict[str, Any], end: _End) -> _End:
    """A proof that there is no solution, if there is one; else the end of the attempts."""
    scalings = _equilibrated(data), _equilibrated(data, costly=True)
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
    violation = _size(np.asarray(constraint.violation(), float))
    if violation <= AT_ONCE:  # a variable that vanishes has no size
        return 0.0
    return violation / max((_terms(part) for part in constraint.args), default=1.0)


def _terms(part: Any) -> float:
    """Largest size of an expression, and of its derivatives times the largest entries of its variables."""
    size = np.abs(np.asarray(part.value)).ravel(order="F").astype(float)
    for variable, slope in part.grad.items():
        if slope is not None:
            size = size + np.asarray(np.abs(slope).sum(axis=0)).ravel() * _size(np.asarray(variable.value))
    return max(_size(size), AT_ONCE)


def _ends(data: dict[str, Any], max_iterations: int | None, *, equilibrate: bool) -> Iterator[_End]:
    """Make the attempts. A point of another scaling is judged in the first one too, where sizes are one.

    A proof has to hold in each scaling: what is small beside the numbers of one may be all there is in another.
    """
    first = _equilibrated(data) if equilibrate else (data, _Scaling())
    costly = cache(lambda: _equilibrated(data, costly=True))
    for attempt in ATTEMPTS:
        chosen = first
        if attempt.costly:
            chosen = costly()
        elif attempt.rescaled:
            chosen = (data, _Scaling()) if equilibrate else _equilibrated(data)
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
    scalings: Sequence[tuple[dict[str, Any], _Scaling]], solution: Any, scaling: _Scaling
) -> tuple[str, float]:
    """The worst that `_judged` says of a point or ray of one scaling in others; nothing, with none of them."""
    ends = (_judged(scaled, _moved(solution, scaling, other)) for scaled, other in scalings)
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
    curved = _symmetric(data) @ x
    status = str(solution.status).removeprefix("Almost")
    if status == RAYS[0]:
        z = _balanced(csc_array(A), z, data["dims"])
        return (status, 0.0) if _is_ray(b, z, A.T @ z) else ("Unsolved", np.inf)
    if status == RAYS[1]:
        return (status, 0.0) if _is_ray(c, x, np.append(curved, A @ x + s)) else ("Unsolved", np.inf)
    primal, dual = c @ x + x @ curved / 2, -(b @ z) - x @ curved / 2
    terms = np.maximum(1.0, np.abs(curved) + np.abs(c) + abs(A).T @ np.abs(z))
    residuals = (
        _size((A @ x + s - b) / np.maximum(1.0, abs(A) @ np.abs(x) + np.abs(b))),
        _size((curved + c + A.T @ z) / np.maximum(terms, ASKED / GOOD * _size(terms))),
        abs(primal - dual) / max(1.0, min(abs(primal), abs(dual))),
        _outside(data["dims"], s, z),
    )
    residual = float(np.max(residuals))  # with nan if one is
    if not np.isfinite(residual):
        return "Unsolved", np.inf
    return "Solved" if residual <= GOOD else "AlmostSolved", residual


def _symmetric(data: dict[str, Any]) -> Any:
    """P, of which cvxpy gives all entries."""
    n = len(data["c"])
    return csc_array(data["P"]) if "P" in data else csc_array((n, n))


def _balanced(A: csc_array, z: Array, dims: Any) -> Array:
    """Multipliers for which Aᵀz is zero up to rounding: the least change of equations and of inequalities in use."""
    row = np.arange(len(z))
    signed = (row >= dims.zero) & (row < dims.zero + dims.nonneg) & (z > PROOF * _size(z))
    used, changed = signed | (row < dims.zero), z.copy()
    changed[used] -= np.linalg.lstsq(A[used].T.toarray(), A.T @ z)[0]
    return changed if (changed[signed] >= 0.0).all() else z


def _is_ray(slope: Array, ray: Array, rest: Array) -> bool:
    """Whether a ray goes down, and by more than the rest, which should vanish, could feign where the slope is large."""
    down = -float(slope @ ray) - len(ray) * float(np.finfo(float).eps) * float(np.abs(slope) @ np.abs(ray))
    return bool(down > 0.0 and max(1.0, _size(slope)) * _size(rest) <= PROOF * down)


def _outside(dims: Any, s: Array, z: Array) -> float:
    """How far slacks and multipliers of equations and inequalities are outside; other cones Clarabel never leaves."""
    inequalities = slice(dims.zero, dims.zero + dims.nonneg)
    return max(_size(s[: dims.zero]), *(_size(np.minimum(part[inequalities], 0.0)) for part in (s, z)))


def _size(values: Array) -> float:
    """Largest magnitude."""
    return float(np.abs(values).max(initial=0.0))


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
    for name, value in chosen.items():
        setattr(settings, name, value)
    P = triu(_symmetric(data), format="csc")
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


@contextmanager
def interrupts() -> Iterator[list[int]]:
    """Collect interrupts (Ctrl-C) in a list, and handle one at the end: what Clarabel calls cannot raise them."""
    came: list[int] = []
    before = signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread() or not callable(before):
        yield came
        return
    signal.signal(signal.SIGINT, lambda number, _: came.append(number))
    try:
        yield came
    finally:
        signal.signal(signal.SIGINT, before)
    if came:
        before(came[0], None)


def _finite(progress: Array) -> Array:
    """The rows before the first that is not finite."""
    return progress[np.logical_and.accumulate(np.isfinite(progress).all(axis=1))]


def _equilibrated(data: dict[str, Any], *, costly: bool = False) -> tuple[dict[str, Any], _Scaling]:
    """Bring min ½xᵀP x + cᵀx, b - A x in cones, to size one: constraints, then limits, then costs.

    Limits that are wide become one by their rows, so that they do not hide the others. Costs have a unit of their own.
    It is that of the Hessian, and variables with larger costs have a smaller unit, unless the program is `costly`.
    """
    A, b = csc_array(data["A"]), data["b"]
    cone = _cone_of_rows(data["dims"])
    D, E = _of_constraints(A, b, cone)
    D, s = _of_costs(data, D, costly=costly)
    P, c = diags_array(D) @ _symmetric(data) @ diags_array(D), D * data["c"]
    scaled = {**data, "A": csc_array(diags_array(E) @ A @ diags_array(D)), "b": E * b, "c": s * c}
    return scaled | ({"P": csc_array(s * P)} if "P" in data else {}), _Scaling(D, E, s)


def _of_constraints(A: csc_array, b: Array, cone: IntArray) -> tuple[Array, Array]:
    """Factors of columns and rows with which the largest entry of each is one, and no limit is above one.

    If all limits are small, the unit of all variables is their size: the least that Clarabel compares with is one.
    """
    work = A.tocoo()
    D, E = _without_units(work, cone, A.shape)
    for limit in (np.zeros(len(b)), np.abs(b)):
        for _ in range(ROUNDS):
            entries = E[work.row] * np.abs(work.data) * D[work.col]
            column = _largest(entries, work.col, len(D))
            row = np.maximum(_largest(entries, work.row, len(b)), E * limit)
            row = _largest(row, cone, len(b))[cone]
            D, E = D / np.sqrt(np.where(column > 0, column, 1.0)), E / np.sqrt(np.where(row > 0, row, 1.0))
        size = min(_size(E * b) or 1.0, 1.0)
        D, E = size * D, E / size
    return D, E


def _of_costs(data: dict[str, Any], D: Array, *, costly: bool) -> tuple[Array, float]:
    """Factors of columns, which make costs above one to one unless the program is `costly`, and of the costs."""
    P, c = diags_array(D) @ _symmetric(data) @ diags_array(D), np.abs(D * data["c"])
    curved, costs = float(np.abs(P.data).max(initial=0.0)), c[c > 0]
    if costly:
        return D, 1.0 / (max(curved, _size(c)) or 1.0)
    s = 1.0 / (curved or float(np.exp(np.log(costs).mean() if costs.size else 0.0)))
    return D / np.maximum(1.0, s * c), s


def _without_units(entries: Any, cone: IntArray, shape: Any) -> tuple[Array, Array]:
    """Factors of columns and rows with which the logarithms of entries have the mean zero in each column and cone."""
    present = entries.data != 0
    row, column, logs = cone[entries.row[present]], entries.col[present], np.log(np.abs(entries.data[present]))
    cones = int(cone.max(initial=-1)) + 1
    in_row, in_column = (np.maximum(np.bincount(i, minlength=m), 1) for i, m in ((row, cones), (column, shape[1])))
    r, d = np.zeros(cones), np.zeros(shape[1])
    for _ in range(MEANS):
        r = -np.bincount(row, logs + d[column], cones) / in_row
        d = -np.bincount(column, logs + r[row], shape[1]) / in_column
    return np.exp(d), np.exp(r)[cone]


def _largest(entries: Array, index: NDArray[np.integer], size: int) -> Array:
    """Largest of the entries (none negative) of each index, (size,)."""
    largest = np.zeros(size)
    np.maximum.at(largest, index, entries)
    return largest


def _cone_of_rows(dims: Any) -> IntArray:
    """Number of the cone of each row; each equation and inequality is a cone by itself."""
    sizes = [1] * (dims.zero + dims.nonneg) + list(dims.soc) + [k * (k + 1) // 2 for k in dims.psd]
    sizes += [3] * (dims.exp + len(dims.p3d)) + [len(powers) + 1 for powers in getattr(dims, "pnd", ())]
    return np.repeat(np.arange(len(sizes)), sizes)


def _moved(solution: Any, scaling: _Scaling, other: _Scaling) -> SimpleNamespace:
    """A point of one scaled problem in the numbers of another."""
    x, z, s = (np.array(part) for part in (solution.x, solution.z, solution.s))
    return SimpleNamespace(
        x=scaling.D * x / other.D,
        z=scaling.E * z / scaling.s * other.s / other.E,
        s=s / scaling.E * other.E,
        status=solution.status,
    )


def _unscaled(solution: Any, status: str, scaling: _Scaling) -> SimpleNamespace:
    """Clarabel's solution of the scaled problem, in the numbers of the problem itself."""
    D, E, s = scaling
    return SimpleNamespace(
        x=D * np.array(solution.x),
        z=E * np.array(solution.z) / s,
        status=status,
        obj_val=solution.obj_val / s,
        solve_time=solution.solve_time,
        iterations=solution.iterations,
    )
