"""Cone programs min ½xᵀP x + cᵀx, b - A x in cones, of size one: rows, columns and costs, cone by cone.

Units are taken out by the means of logarithms (Curtis and Reid, J. Inst. Maths Applics 10, 1972, 118-124), and the
largest entries become one (Ruiz, RAL-TR-2001-034). Ruiz's method alone stops at any matrix whose largest entries are
one, and leaves small what has a unit of its own, as a variable that cvxpy adds. Limits and costs become one, too: under
a light load the gaps of far points are millions of displacements, and beside them everything else is small.
"""

from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array, diags_array

from bemcontact.arrays import Array, IntArray

MEANS = 20
"""Iterations of the means of logarithms."""
ROUNDS = 12
"""Iterations of Ruiz's method; each takes the square root of how far rows and columns are from one."""


class Scaling(NamedTuple):
    """x = D x', rows times E, costs times s: arrays or numbers."""

    D: Array | float = 1.0
    E: Array | float = 1.0
    s: float = 1.0


def equilibrated(data: dict[str, Any], *, costly: bool = False) -> tuple[dict[str, Any], Scaling]:
    """Bring min ½xᵀP x + cᵀx, b - A x in cones, to size one: constraints, then limits, then costs.

    Limits that are wide become one by their rows, so that they do not hide the others. Costs have a unit of their own.
    It is that of the Hessian, and variables with larger costs have a smaller unit, unless the program is `costly`.
    """
    A, b = csc_array(data["A"]), data["b"]
    cone = _cone_of_rows(data["dims"])
    D, E = _of_constraints(A, b, cone)
    D, s = _of_costs(data, D, costly=costly)
    P, c = diags_array(D) @ symmetric(data) @ diags_array(D), D * data["c"]
    scaled = {**data, "A": csc_array(diags_array(E) @ A @ diags_array(D)), "b": E * b, "c": s * c}
    return scaled | ({"P": csc_array(s * P)} if "P" in data else {}), Scaling(D, E, s)


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
        size = min(size_of(E * b) or 1.0, 1.0)
        D, E = size * D, E / size
    return D, E


def _of_costs(data: dict[str, Any], D: Array, *, costly: bool) -> tuple[Array, float]:
    """Factors of columns, which make costs above one to one unless the program is `costly`, and of the costs."""
    P, c = diags_array(D) @ symmetric(data) @ diags_array(D), np.abs(D * data["c"])
    curved, costs = float(np.abs(P.data).max(initial=0.0)), c[c > 0]
    if costly:
        return D, 1.0 / (max(curved, size_of(c)) or 1.0)
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


def moved(solution: Any, scaling: Scaling, other: Scaling) -> SimpleNamespace:
    """A point of one scaled problem in the numbers of another."""
    x, z, s = (np.array(part) for part in (solution.x, solution.z, solution.s))
    return SimpleNamespace(
        x=scaling.D * x / other.D,
        z=scaling.E * z / scaling.s * other.s / other.E,
        s=s / scaling.E * other.E,
        status=solution.status,
    )


def unscaled_end(solution: Any, status: str, scaling: Scaling) -> SimpleNamespace:
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


def symmetric(data: dict[str, Any]) -> Any:
    """P, of which cvxpy gives all entries."""
    n = len(data["c"])
    return csc_array(data["P"]) if "P" in data else csc_array((n, n))


def size_of(values: Array) -> float:
    """Largest magnitude."""
    return float(np.abs(values).max(initial=0.0))
