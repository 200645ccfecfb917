"""A cone program of cvxpy without the variables that one equation alone fixes, and the way back to all of them."""

import copy
from types import SimpleNamespace
from typing import Any

import numpy as np
from scipy.sparse import csc_array, csr_array

from bemcontact.cached import cached_property


class FixedVariables:
    """Variables of min ½xᵀP x + cᵀx, b - A x in cones, that equations with one entry fix; `data` has all entries of P.

    Attributes
    ----------
    rows, columns : of these entries, one for each variable
    values : of the variables
    """

    def __init__(self, data: dict[str, Any]) -> None:
        self.data, self.A, self.c = data, csc_array(data["A"]), data["c"]
        self.P = csc_array(data["P"]) if "P" in data else csc_array((len(self.c), len(self.c)))
        entries = csr_array(self.A, copy=True)
        entries.eliminate_zeros()
        start = entries.indptr[: data["dims"].zero + 1]
        rows = np.flatnonzero(np.diff(start) == 1)
        columns, first = np.unique(entries.indices[start[rows]], return_index=True)
        if len(columns) == len(self.c):  # a program needs a variable
            columns, first = columns[:0], first[:0]
        self.rows, self.columns = rows[first], columns
        self.pivots = entries.data[start[self.rows]]
        self.values = data["b"][self.rows] / self.pivots
        self.other_rows = np.delete(np.arange(len(data["b"])), self.rows)
        self.other_columns = np.delete(np.arange(len(self.c)), columns)

    def rest(self) -> dict[str, Any]:
        """The program of the other variables; its objective lacks `constant`."""
        rows, columns, dims = self.other_rows, self.other_columns, copy.copy(self.data["dims"])
        dims.zero -= len(self.rows)
        b = self.data["b"] - self.A[:, self.columns] @ self.values
        c = self.c + self.P[:, self.columns] @ self.values
        small = {"A": self.A[:, columns][rows], "b": b[rows], "c": c[columns], "dims": dims}
        return self.data | small | ({"P": self.P[:, columns][columns]} if "P" in self.data else {})

    @cached_property
    def constant(self) -> float:
        """The objective of the fixed variables alone."""
        inner = self.P[:, self.columns][self.columns] @ self.values
        return float((self.c[self.columns] + inner / 2) @ self.values)

    def whole(self, solution: Any, *, proof: bool, descent: bool) -> SimpleNamespace:
        """A solution of the rest with all variables, slacks and multipliers; also a proof or a descent.

        A fixed variable does not move in a descent. Its multiplier balances the rest of its equation P x + c + Aᵀz = 0,
        and of Aᵀz = 0 in a proof that nothing is feasible.
        """
        x, s, z = np.empty(len(self.c)), np.zeros(len(self.data["b"])), np.zeros(len(self.data["b"]))
        x[self.other_columns], x[self.columns] = solution.x, 0.0 if descent else self.values
        s[self.other_rows], z[self.other_rows] = solution.s, solution.z
        slope = self.A.T @ z + (0.0 if proof else self.P @ x + self.c)
        z[self.rows] = -slope[self.columns] / self.pivots
        same = {name: getattr(solution, name) for name in ("status", "solve_time", "iterations")}
        return SimpleNamespace(x=x, s=s, z=z, obj_val=solution.obj_val + self.constant, **same)
