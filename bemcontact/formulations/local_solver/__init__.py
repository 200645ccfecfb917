"""A local solver for quadratic programs of any inertia; it knows nothing of contact."""

from bemcontact.formulations.local_solver.factorizations import inertia
from bemcontact.formulations.local_solver.minimize import minimize_qp
from bemcontact.formulations.local_solver.result import QPOptions, QPResult, QPStatus

__all__ = ["QPOptions", "QPResult", "QPStatus", "inertia", "minimize_qp"]
