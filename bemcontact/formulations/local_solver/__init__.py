"""A local minimiser of a quadratic programme whose Hessian may have any inertia: an inertia-controlling active set."""

from bemcontact.formulations.local_solver.minimize import minimize_qp
from bemcontact.formulations.local_solver.result import QPOptions, QPResult, QPStatus

__all__ = ["QPOptions", "QPResult", "QPStatus", "minimize_qp"]
