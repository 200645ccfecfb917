"""The one way to Clarabel: a cvxpy problem is scaled, solved to tight tolerances, and brought back with its progress.

Clarabel is called directly, because cvxpy does not pass on the progress of a solver. Clarabel stops where residuals are
small beside one, whatever the unit of a row is. So rows and columns are brought to size one before (Ruiz,
RAL-TR-2001-034), cone by cone, unless the problem is dimensionless already.
"""

import warnings
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array, diags_array, triu

from bemcontact.arrays import Array, IntArray
from bemcontact.contact.solution import Status
from bemcontact.errors import SolverError

TOLERANCES = 1e-11, 1e-8
"""Asked of Clarabel one after the other: the second if the first cannot be reached."""
ITERATIONS = 200
ROUNDS = 12
"""Iterations of Ruiz's method; each takes the square root of how far rows and columns are from one."""
FAILED = "InsufficientProgress", "NumericalError", "Unsolved"
"""Ends of Clarabel without an answer."""
STATUSES = {
    "optimal": Status.SOLVED,
    "optimal_inaccurate": Status.SOLVED,
    "user_limit": Status.ITERATION_LIMIT,
    "infeasible": Status.INFEASIBLE,
    "infeasible_inaccurate": Status.INFEASIBLE,
    "unbounded": Status.UNBOUNDED,
    "unbounded_inaccurate": Status.UNBOUNDED,
}
"""Status of a cvxpy problem -> ours."""


LARGEST_COUNT = 2**32 - 1
"""Largest number of iterations that Clarabel can count to."""


class _Scaling(NamedTuple):
    """x = D x', rows times E, costs times s: arrays or numbers."""

    D: Array | float = 1.0
    E: Array | float = 1.0
    s: float = 1.0


def minimize(problem: Any, max_iterations: int | None = None, *, equilibrate: bool = True, size: float = 1.0) -> Array:
    """Solve a convex cvxpy problem; its status and values are set as by its own `solve`, which has coarser tolerances.

    Rows and columns are scaled (`equilibrate`), unless the problem is dimensionless: then all variables and right sides
    are divided by `size`. The result (iterations + 1, 2) is the objective without its constant and the residual of the
    constraints that Clarabel holds against its tolerance. It has one row less if Clarabel gave up in the last
    iteration. `SolverError` if Clarabel cannot state or solve the problem.
    """
    import cvxpy as cp

    try:
        data, chain, inverse = problem.get_problem_data(cp.CLARABEL, solver_opts={})
    except cp.SolverError as error:
        raise SolverError(f"Clarabel cannot solve this model: {error}; state it without integers") from error
    scaled, scaling = _equilibrated(data) if equilibrate else _divided(data, size)
    ends = (_solve(scaled, tolerance, max_iterations or ITERATIONS) for tolerance in TOLERANCES)
    end = next((end for end in ends if str(end[0].status) not in FAILED), None)
    if end is None:
        raise SolverError(
            "Clarabel found no solution of this model; look for terms of very different size, or loosen what was added"
        )
    solution, progress = end
    with warnings.catch_warnings(action="ignore", category=UserWarning):  # the status says the same
        problem.unpack_results(_unscaled(solution, *scaling), chain, inverse)
    return progress / np.array([scaling.s, 1.0])


def _solve(data: dict[str, Any], tolerance: float, max_iterations: int) -> tuple[Any, Array]:
    """Clarabel's solution of the cone program of cvxpy, and its progress as of `minimize`."""
    from clarabel import DefaultSettings, DefaultSolver  # pyright: ignore (has no stubs)
    from cvxpy.reductions.solvers.conic_solvers.clarabel_conif import dims_to_solver_cones

    settings = DefaultSettings()
    settings.verbose, settings.max_iter = False, min(max_iterations, LARGEST_COUNT)
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = tolerance
    n = len(data["c"])
    P = triu(data["P"], format="csc") if "P" in data else csc_array((n, n))
    solver = DefaultSolver(P, data["c"], data["A"], data["b"], dims_to_solver_cones(data["dims"]), settings)
    rows: list[tuple[float, float]] = []

    def look(info: Any) -> bool:
        rows.append((info.cost_primal, info.res_primal))
        return False  # go on

    solver.set_termination_callback(look)
    solution = solver.solve()
    if rows and np.isfinite(solution.obj_val):
        rows[-1] = solution.obj_val, solution.r_prim  # Clarabel may have withdrawn its last step
    progress = np.array(rows).reshape(-1, 2)
    return solution, progress[np.logical_and.accumulate(np.isfinite(progress).all(axis=1))]


def _divided(data: dict[str, Any], size: float) -> tuple[dict[str, Any], _Scaling]:
    """Variables and right sides over a size, the objective over its square."""
    return {**data, "b": data["b"] / size, "c": data["c"] / size}, _Scaling(size, 1 / size, size**-2)


def _equilibrated(data: dict[str, Any]) -> tuple[dict[str, Any], _Scaling]:
    """Bring min ½xᵀP x + cᵀx, b - A x in cones, to size one.

    D contains the size of b if that is below one, the least that Clarabel compares with.
    """
    # by the constraints alone: costs have a unit of their own, which would pull the columns along
    A, c, b = csc_array(data["A"]), data["c"], data["b"]
    P = csc_array(data["P"]) if "P" in data else csc_array((len(c), len(c)))
    cone, work = _cone_of_rows(data["dims"]), A.tocoo()
    D, E = np.ones(len(c)), np.ones(len(b))
    for _ in range(ROUNDS):
        entries = E[work.row] * np.abs(work.data) * D[work.col]
        column = _largest(entries, work.col, len(c))
        row = _largest(entries, cone[work.row], len(b))[cone]
        D, E = D / np.sqrt(np.where(column > 0, column, 1.0)), E / np.sqrt(np.where(row > 0, row, 1.0))
    size = min(float(np.abs(E * b).max(initial=0.0)), 1.0) or 1.0
    D, E = size * D, E / size
    P, c = diags_array(D) @ P @ diags_array(D), D * c
    s = 1.0 / (max(float(np.abs(P.data).max(initial=0.0)), float(np.abs(c).max(initial=0.0))) or 1.0)
    scaled = {**data, "A": csc_array(diags_array(E) @ A @ diags_array(D)), "b": E * b, "c": s * c}
    return scaled | ({"P": csc_array(s * P)} if "P" in data else {}), _Scaling(D, E, s)


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


def _unscaled(solution: Any, D: Array | float, E: Array | float, s: float) -> SimpleNamespace:
    """Clarabel's solution of the scaled problem, in the numbers of the problem itself."""
    return SimpleNamespace(
        x=D * np.array(solution.x),
        z=E * np.array(solution.z) / s,
        status=solution.status,
        obj_val=solution.obj_val / s,
        solve_time=solution.solve_time,
        iterations=solution.iterations,
    )
