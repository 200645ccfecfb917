"""The way to PIQP, an optional solver of convex quadratic programs with dense factors, through cvxpy."""

from importlib.util import find_spec
from typing import Any

import numpy as np

from bemcontact.errors import OptionError, SolverError
from bemcontact.formulations.clarabel import Answer

TOLERANCE = 1e-9
"""Residuals that are asked of PIQP, of a program whose numbers are of size one."""
MISSING = (
    "the solver piqp is not installed; pip install 'bemcontact[piqp]', or leave the option 'solver' out, and Clarabel "
    "is taken"
)


def minimize_by_piqp(problem: Any, max_iterations: int | None = None) -> Answer:
    """Solve a dimensionless cvxpy problem, whose status and values are set; it tells nothing of its progress.

    `OptionError` if PIQP is not installed, `SolverError` if it leaves no point.
    """
    import cvxpy as cp

    if find_spec("piqp") is None:
        raise OptionError(MISSING)
    settings = {"backend": "dense", "eps_abs": TOLERANCE, "eps_rel": TOLERANCE}
    if max_iterations is not None:
        settings["max_iter"] = max_iterations
    try:
        problem.solve(solver=cp.PIQP, **settings)
    except cp.SolverError as error:
        raise SolverError("PIQP broke down, and left no point; leave the option 'solver' out") from error
    return Answer(np.zeros((0, 2)), failed=False, accurate=problem.status == cp.OPTIMAL, note="")
