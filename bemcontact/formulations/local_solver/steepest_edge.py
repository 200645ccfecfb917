"""Steepest-edge pricing: which constraint is released, of those with a multiplier of the wrong sign.

The step to the minimizer after the release of constraint j reduces the objective by μ_j²/(2 q_j), unless another
constraint blocks it: μ_j is the multiplier, and q_j the curvature along the direction c_j that moves the constraint by
one and no other that is held, with c_jᵀH Z = 0. The largest μ_j²/q_j does not depend on the units of constraints, and
takes a fraction of the iterations that the largest |μ_j| takes (Goldfarb and Reid, Math. Programming 12 (1977) 361-371,
for linear programs).
"""

import numpy as np

from bemcontact.arrays import Array
from bemcontact.formulations.local_solver.statement import Statement
from bemcontact.formulations.local_solver.working_set import WorkingSet

FLOOR = 1e-10
"""Least curvature of an edge, of a program whose largest entry is one."""
KEPT = 1e-3
"""Least part of a curvature that is left where another direction becomes free: less would be rounding."""
APART = 4.0
"""Ratio of a curvature to that of the direction released, from which the curvatures are too far off."""


class SteepestEdge:
    """The curvature q_j of each constraint that is held, updated when one enters or leaves the working set: O(n²).

    The other directions of the null space are all in the conjugate basis Z (n, k); no row is temporary.
    """

    def __init__(self, statement: Statement, working: WorkingSet, Z: Array) -> None:
        self._statement, self._working = statement, working
        fixed, N = working.held[: working.free.size].nonzero()[0], working.N
        moved = np.hstack([-N.dot(working.W[:, fixed]), N])
        moved[fixed, np.arange(fixed.size)] = 1.0
        product = statement.bent(moved)
        curvatures = (moved * product).sum(axis=0) - np.square(Z.T.dot(product)).sum(axis=0)
        self._of_all = np.zeros(working.held.size)
        self._of_all[fixed], self._of_all[working.ids] = curvatures[: fixed.size], curvatures[fixed.size :]

    @property
    def curvatures(self) -> Array:
        """Of the places of the working set (n + r,)."""
        return np.maximum(self._of_all[self._working.numbers], FLOOR)

    def follow_release(self, constraint: int, column: Array) -> bool:
        """Update after a constraint has left and its direction has become a column of Z (n,); False if far off."""
        statement, of_all = self._statement, self._of_all
        normal = statement.normal(constraint)
        speed = float(normal.dot(column))
        known, of_all[constraint] = of_all[constraint] * speed * speed, 0.0
        falls = self._working.components(normal / speed - statement.bent(column))
        np.maximum(of_all - falls * falls, KEPT * of_all, out=of_all)
        return 1.0 < APART * known < APART * APART

    def follow_entry(self, column: Array) -> None:
        """Update after a constraint has entered and a column has left Z (n,), the only one along its normal."""
        self._of_all += np.square(self._working.components(self._statement.bent(column)))
