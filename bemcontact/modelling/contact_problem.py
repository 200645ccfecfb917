"""Problems of cvxpy that are scaled and solved as all models are, and the rules that additions keep."""

from typing import Any

import cvxpy as cp

from bemcontact.errors import ProblemError
from bemcontact.formulations.clarabel import minimize_convex


class ContactProblem(cp.Problem):
    """A cvxpy problem that is scaled and solved as all models are; with arguments, by cvxpy, which calls Clarabel."""

    def solve(self, *args: Any, **options: Any) -> Any:
        """Solve and return the value; arguments, and options such as a solver, are those of `cvxpy.Problem.solve`."""
        if args or options:
            return super().solve(*args, **{"solver": cp.CLARABEL, **options})
        minimize_convex(self, as_stated=True)
        return self.value

    def __deepcopy__(self, memo: dict[int, Any]) -> "ContactProblem":
        """Refuse: cvxpy keeps what it compiled with the old variables, and aborts the process when it meets the new."""
        raise ProblemError(
            "a problem of a model cannot be copied, because cvxpy confuses its variables; copy the model, and state "
            "the problem again with its method 'problem'"
        )


def ensure_convex(problem: cp.Problem) -> None:
    """Refuse, with a `ProblemError`, a problem that is not convex, or that each change of a parameter compiles anew."""
    if problem.is_dpp():
        return
    if problem.is_dcp():
        raise ProblemError(
            "parameters enter what was added so that each change of them is a new problem (not DPP): let each term "
            "have at most one parameter as a factor, or put a new parameter for their product"
        )
    parts = [("the objective", problem.objective), *((f"constraint {c}", c) for c in problem.constraints)]
    bad = next(name for name, part in parts if not part.is_dcp())
    raise ProblemError(
        f"the model is not convex by cvxpy's rules (DCP) in {bad:.200}; write what was added with convex functions "
        "that are minimized or bounded from above"
    )
