"""Solve a cvxpy problem by Clarabel so that the units of what is in it do not matter.

Clarabel stops where residuals are small beside one, whatever the unit of a row is. So rows and columns are brought to
size one before (Ruiz, RAL-TR-2001-034), cone by cone, and the answer is brought back.
"""

import warnings
from types import SimpleNamespace
from typing import Any

import cvxpy as cp
import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array, diags_array

from bemcontact.arrays import Array, IntArray
from bemcontact.errors import SolverError

TOLERANCES = 1e-11, 1e-8
"""Asked of Clarabel one after the other, the second where the first cannot be reached."""
ITERATIONS = 200
ROUNDS = 12
"""Of Ruiz's iteration, each of which takes the square root of how far rows and columns are from one."""
FAILED = "InsufficientProgress", "NumericalError", "Unsolved"
"""Ends of Clarabel without an answer."""


def minimise(problem: cp.Problem, max_iterations: int | None = None) -> None:
    """Solve a problem; its status and values are set as by its own `solve`, which has coarser tolerances.

    Parameters
    ----------
    problem : convex, of cones that Clarabel knows
    max_iterations : of Clarabel, 200 if None

    Raises
    ------
    SolverError
        If Clarabel cannot state or solve it.
    """
    try:
        data, chain, inverse = problem.get_problem_data(cp.CLARABEL, solver_opts={})
    except cp.SolverError as error:
        raise SolverError(f"Clarabel cannot solve this model: {error}; state it without integers") from error
    assert chain is not None
    scaled, scales = _equilibrated(data)
    found: Any = None
    for tolerance in TOLERANCES:
        options = {
            "tol_gap_abs": tolerance, "tol_gap_rel": tolerance, "tol_feas": tolerance,
            "max_iter": max_iterations or ITERATIONS,
        }  # fmt: skip
        found = chain.solve_via_data(problem, scaled, solver_opts=options)
        if str(found.status) not in FAILED:
            break
    else:
        raise SolverError(
            f"Clarabel found no solution of this model ({found.status}); look for terms of very different size, "
            "or loosen what was added"
        )
    with warnings.catch_warnings(action="ignore", category=UserWarning):  # the status tells the same
        problem.unpack_results(_brought_back(found, *scales), chain, inverse)


def _equilibrated(data: dict[str, Any]) -> tuple[dict[str, Any], tuple[Array, Array, float]]:
    """Bring min ½xᵀP x + cᵀx, b - A x in cones, to size one: x = D x', rows times E, costs times s.

    D has the size of b in it where that is below one, the least that Clarabel compares with.
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
    return scaled | ({"P": csc_array(s * P)} if "P" in data else {}), (D, E, s)


def _largest(entries: Array, index: NDArray[np.integer], size: int) -> Array:
    """Largest of the entries (none negative) of each index, (size,)."""
    found = np.zeros(size)
    np.maximum.at(found, index, entries)
    return found


def _cone_of_rows(dims: Any) -> IntArray:
    """Number of the cone of each row; each row of an equation or inequality is one by itself."""
    sizes = [1] * (dims.zero + dims.nonneg) + list(dims.soc) + [k * (k + 1) // 2 for k in dims.psd]
    sizes += [3] * (dims.exp + len(dims.p3d)) + [len(powers) + 1 for powers in getattr(dims, "pnd", ())]
    return np.repeat(np.arange(len(sizes)), sizes)


def _brought_back(found: Any, D: Array, E: Array, s: float) -> SimpleNamespace:
    """What Clarabel found for the scaled problem, in the numbers of the problem itself."""
    return SimpleNamespace(
        x=D * np.array(found.x),
        z=E * np.array(found.z) / s,
        status=found.status,
        obj_val=found.obj_val / s,
        solve_time=found.solve_time,
        iterations=found.iterations,
    )
