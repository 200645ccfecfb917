"""Options of `minimize_qp`, its status, the lines of its log, and its result."""

from collections.abc import Callable
from dataclasses import field
from enum import StrEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bemcontact.arrays import Array
from bemcontact.cached import cached_property
from bemcontact.checks.arguments import shown
from bemcontact.checks.keywords import refusing_unknown
from bemcontact.errors import ProblemError
from bemcontact.formulations.local_solver.factorizations import Inertia, inertia
from bemcontact.frozen import frozen_value


class QPStatus(StrEnum):
    """How a run ended; the value is the text to print.

    Infeasible are the constraints with entries that differ from the stated ones by no more than one unit in the last
    place of each.

    A numerical failure is an end that failed its own check repeatedly with fresh factors: the data are too near to the
    limits of double precision for any claim.
    """

    LOCAL_MINIMIZER = "local minimizer"
    UNDECIDED = "second-order undecided"
    UNBOUNDED = "unbounded"
    INFEASIBLE = "infeasible"
    ITERATION_LIMIT = "iteration limit"
    NUMERICAL_FAILURE = "numerical failure"


class LogLine(NamedTuple):
    """One iteration: what moved and what entered or left the working set.

    Parameters
    ----------
    phase : 1 (sum of infeasibilities) or 2 (objective)
    iteration : number of the iteration, both phases counted together
    value : sum of infeasibilities in scaled units (phase 1), or the objective in the units of the data (phase 2)
    step : length of the step along the direction
    added, dropped : constraints, variables first, then rows; None if there was none, or a temporary one
    working : size of the working set, temporary constraints included
    nonpositive : non-positive eigenvalues of the reduced Hessian: 0 or 1; 0 in phase 1
    """

    phase: int
    iteration: int
    value: float
    step: float
    added: int | None
    dropped: int | None
    working: int
    nonpositive: int

    def __str__(self) -> str:
        """One line of a table."""
        added = "-" if self.added is None else str(self.added)
        dropped = "-" if self.dropped is None else str(self.dropped)
        return (
            f"{self.phase} {self.iteration:6d}  {self.value:16.9e}  step {self.step:9.2e}"
            f"  +{added:>5s} -{dropped:>5s}  |W| {self.working:5d}  non-positive {self.nonpositive}"
        )


@refusing_unknown()
@frozen_value
class QPOptions:
    """Options of `minimize_qp`.

    Parameters
    ----------
    max_iterations : limit on the iterations of both phases; None means 1000 + 20 (n + m)
    feasibility_tolerance : a constraint counts as satisfied within this, relative to max(1, its bound) in scaled units
    optimality_tolerance : a gradient or multiplier counts as zero within this, relative to the largest of the
        gradient's terms in scaled units, and in the end within a thousandth of it relative to the terms of its own
        component
    scale : equilibrate rows and variables by powers of two, which changes no digit of the data
    search : most faces of the critical cone that are examined behind zero multipliers before the status is undecided
    by_numba : whether machine code of numba, if installed, scales programs of up to 250 variables and takes their
        iterations; if None, it does if numba was imported before the first call
    log : called with each ``LogLine``; with machine code at the end of it

    Raises
    ------
    ProblemError
        A value is out of range or of another kind, or there is no option of a name.
    """

    max_iterations: int | None = None
    feasibility_tolerance: float = 1e-9
    optimality_tolerance: float = 1e-9
    scale: bool = True
    search: int = 2000
    by_numba: bool | None = None
    log: Callable[[LogLine], None] | None = None

    def __post_init__(self) -> None:
        """Refuse options that are out of range."""
        for name in ("feasibility_tolerance", "optimality_tolerance"):
            value = getattr(self, name)
            if not _is_number(value) or not 0.0 < value < 1e-2:
                raise ProblemError(f"{name} is {shown(value)}: give a number between 0 and 0.01, such as 1e-9")
        if self.max_iterations is not None and not _counts(self.max_iterations):
            raise ProblemError(f"max_iterations is {shown(self.max_iterations)}: give a whole number >= 0, or None")
        if not isinstance(self.scale, bool | np.bool_):
            raise ProblemError(f"scale is {shown(self.scale)}: give True or False")
        if not _counts(self.search):
            raise ProblemError(f"search is {shown(self.search)}: give the number of faces to examine, >= 0")
        if not isinstance(self.by_numba, bool | np.bool_ | None):
            raise ProblemError(f"by_numba is {shown(self.by_numba)}: give True, False, or None for what is imported")
        if self.log is not None and not callable(self.log):
            raise ProblemError(f"log is {shown(self.log)}: give a function of a LogLine, such as print")


def _is_number(value: object) -> bool:
    """Whether this is a real number."""
    return isinstance(value, int | float | np.integer | np.floating) and not isinstance(value, bool)


def _counts(value: object) -> bool:
    """Whether this is a whole number that is not negative."""
    return isinstance(value, int | np.integer) and not isinstance(value, bool) and bool(value >= 0)


@frozen_value
class QPResult:
    """Result of `minimize_qp`, in the units of the data; of the log only the objective is.

    Parameters
    ----------
    x : (n,) last point
    status : what is claimed of it
    objective : cᵀx + xᵀHx/2
    bound_multipliers, constraint_multipliers : (n,) and (m,), H x + c = bound_multipliers + Aᵀ constraint_multipliers;
        >= 0 at a lower, <= 0 at an upper bound
    working_set : (n + m,) 0 free, -1 at lower, +1 at upper, 2 equality; variables first, then rows
    phase_one_iterations, phase_two_iterations : iterations of each phase
    working_set_changes : constraints added and dropped, temporary ones included
    hessian : (n, n) H
    reduced_inertia_start, reduced_inertia_end : positive, zero and negative eigenvalues of ZᵀHZ on the null space of
        the working set, at the start and at the end of phase 2
    weakly_active : active inequalities whose multiplier is about zero, numbered as in `working_set`
    ray : (n,) if unbounded: x + t ray is feasible for all t >= 0 and the objective falls to -inf on it
    certificate : (n + m,) if infeasible: y with [I; A]ᵀy = 0 and Σ_{y>0} y lower + Σ_{y<0} y upper > 0 (Farkas);
        variables first. The first holds up to rounding, where an entry of A counts as rounding if one in its column is
        1e15 times as large.
    violation : largest violation of a constraint at x
    by_numba : whether machine code took iterations
    log : each iteration
    """

    x: Array
    status: QPStatus
    objective: float
    bound_multipliers: Array
    constraint_multipliers: Array
    working_set: NDArray[np.int8]
    phase_one_iterations: int
    phase_two_iterations: int
    working_set_changes: int
    hessian: Array = field(repr=False)
    reduced_inertia_start: Inertia
    reduced_inertia_end: Inertia
    weakly_active: NDArray[np.intp]
    ray: Array | None
    certificate: Array | None
    violation: float
    by_numba: bool
    log: tuple[LogLine, ...] = field(repr=False)

    @cached_property
    def inertia(self) -> Inertia:
        """Numbers of positive, zero and negative eigenvalues of H."""
        return inertia(self.hessian)

    @property
    def iterations(self) -> int:
        """Iterations of both phases."""
        return self.phase_one_iterations + self.phase_two_iterations

    def __str__(self) -> str:
        """The end in one line."""
        phases = f"{self.phase_one_iterations} + {self.phase_two_iterations}"
        reached = f"objective {self.objective:.9g}"
        if self.status is QPStatus.INFEASIBLE:
            reached = f"violation of up to {self.violation:.3g} at the nearest point"
        elif self.status is QPStatus.UNBOUNDED:
            reached = f"the objective falls without end from {self.objective + 0.0:.9g}"
        return f"{self.status.value}: {reached} after {phases} iterations (phase 1 + phase 2)"
