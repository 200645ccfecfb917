"""Rays of the linear part of a cone program, which prove that it is infeasible or unbounded, by linear programs.

For min ½xᵀP x + cᵀx, b - A x in cones, equations first, then inequalities, then other cones (data as cvxpy has them).
An interior-point method finds a ray with the accuracy of its steps only. A vertex of a linear program, by HiGHS, has it
to round-off. A ray that is returned has yet to be verified.
"""

from types import SimpleNamespace
from typing import Any

import numpy as np
import scipy

from bemcontact.arrays import Array

FINEST = {"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10}
"""The least tolerances that HiGHS has."""


def infeasible_ray(data: dict[str, Any]) -> SimpleNamespace | None:
    """Multipliers z of equations and inequalities with Aᵀz = 0, z >= 0 for inequalities, and the least bᵀz.

    Multipliers of other cones are zero. None if HiGHS finds nothing below zero.
    """
    zero, linear, rows = _sizes(data)
    A, b = scipy.sparse.csr_array(data["A"])[:linear], data["b"][:linear]
    bounds = np.column_stack([np.where(np.arange(linear) < zero, -1.0, 0.0), np.ones(linear)])
    z = _least(b, _of_size_one(scipy.sparse.csr_array(A.T)), scipy.sparse.csr_array((0, linear)), bounds)
    whole = None if z is None else np.append(z, np.zeros(rows - linear))
    return None if whole is None else _ray("PrimalInfeasible", np.zeros(len(data["c"])), whole, np.zeros(rows))


def unbounded_ray(data: dict[str, Any]) -> SimpleNamespace | None:
    """Direction x with P x = 0, A x = 0 in equations and other cones, A x <= 0 in inequalities, and the least cᵀx.

    None if HiGHS finds nothing below zero.
    """
    zero, linear, rows = _sizes(data)
    A = scipy.sparse.csr_array(data["A"])
    P = scipy.sparse.csr_array(data["P"]) if "P" in data else scipy.sparse.csr_array((0, len(data["c"])))
    limits = np.arange(zero, linear)
    still = scipy.sparse.vstack([_of_size_one(P), A[np.delete(np.arange(rows), limits)]], format="csr")
    x = _least(data["c"], still, A[limits], (-1.0, 1.0))
    if x is None:
        return None
    s = np.zeros(rows)
    s[limits] = np.maximum(-(A[limits] @ x), 0.0)
    return _ray("DualInfeasible", x, np.zeros(rows), s)


def _least(cost: Array, equal: Any, below: Any, bounds: Any) -> Array | None:
    """Where a linear function is least, if that is below zero; two matrices times the point are zero, and no more."""
    largest = np.abs(cost).max(initial=0.0)
    if not largest:
        return None
    limits = {"A_eq": equal, "b_eq": np.zeros(equal.shape[0]), "A_ub": below, "b_ub": np.zeros(below.shape[0])}
    end = scipy.optimize.linprog(cost / largest, bounds=bounds, options=FINEST, **limits)
    return end.x if end.status == 0 and end.fun < 0.0 else None


def _ray(status: str, x: Array, z: Array, s: Array) -> SimpleNamespace:
    """A ray in the form of Clarabel's solutions."""
    return SimpleNamespace(status=status, x=x, z=z, s=s, obj_val=np.nan, solve_time=0.0, iterations=0)


def _of_size_one(matrix: "scipy.sparse.csr_array") -> "scipy.sparse.csr_array":
    """Rows divided by their largest entries: HiGHS takes small numbers for zeros."""
    size = abs(matrix).max(axis=1).toarray().ravel()
    return scipy.sparse.csr_array(scipy.sparse.diags_array(1.0 / np.where(size > 0.0, size, 1.0)) @ matrix)


def _sizes(data: dict[str, Any]) -> tuple[int, int, int]:
    """Numbers of equations, of equations and inequalities, and of all rows."""
    zero = data["dims"].zero
    return zero, zero + data["dims"].nonneg, len(data["b"])
