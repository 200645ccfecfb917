"""A solution of a condensed contact problem as a formulation reports it, and how its solver ended."""

from collections.abc import Sequence
from enum import StrEnum
from typing import Literal

from bemcontact.arrays import Array, freeze_arrays
from bemcontact.checks.attributes import WithHints
from bemcontact.frozen import frozen, frozen_value
from bemcontact.serialization import Leaf


class Status(StrEnum):
    """How a solver ended, which proves nothing; ``bemcontact.assessment.certificate`` says what to do."""

    SOLVED = "solved"
    LOCAL_MINIMUM = "local_minimum"
    ITERATION_LIMIT = "iteration_limit"
    INFEASIBLE = "infeasible"
    UNBOUNDED = "unbounded"
    NO_SOLUTION_FOUND = "no_solution_found"
    NUMERICAL_FAILURE = "numerical_failure"

    @property
    def words(self) -> str:
        """How the solver ended, as the end of a sentence."""
        return WORDS[self]


WORDS = {
    Status.SOLVED: "solved",
    Status.LOCAL_MINIMUM: "a local minimum that is not the contact state",
    Status.ITERATION_LIMIT: "stopped at the iteration limit",
    Status.INFEASIBLE: "no pressure satisfies the constraints, so that there is no contact state",
    Status.UNBOUNDED: "the objective has no lower bound",
    Status.NO_SOLUTION_FOUND: "no solution was found, and no proof that there is none",
    Status.NUMERICAL_FAILURE: "broke down numerically",
}

Inertia = tuple[int, int, int]
"""Numbers of positive, zero and negative eigenvalues."""


@frozen_value
class Penalty(Leaf):
    """The penalty μ of QP2, and the largest one for which QP2 is convex.

    QP2 adds (1/μ)|K u_n - B p - r|² to pᵀJδ.
    """

    value: float
    """Penalty μ, free of units."""
    raw: float
    """Penalty μ in the unit `dimension`."""
    convexity_limit: float | None
    """Largest μ for which QP2 is convex where equilibrium is kept, free of units; 0 if for none, null if for all."""
    convexity_limit_raw: float | None
    """Largest μ for which QP2 is convex where equilibrium is kept, in the unit `dimension`."""
    dimension: Literal["p/L²", "1/p"]
    """Unit of the raw numbers: p/L² with the stiffness rows, 1/p with the compliance rows."""

    @property
    def convex(self) -> bool:
        """Whether QP2 is convex with this μ where equilibrium is kept, up to round-off of the limit."""
        return self.convexity_limit is None or self.value <= self.convexity_limit * (1 + 1e-9)


@frozen_value
class LocalSearch(Leaf):
    """How a local solver ended; an inertia is the numbers of positive, zero and negative eigenvalues."""

    start: str
    """Name of the point where the search started."""
    phase_one_iterations: int
    """Number of iterations to a feasible point."""
    phase_two_iterations: int
    """Number of iterations from the feasible point to the end."""
    working_set_changes: int
    """Number of constraints that entered or left the working set."""
    inertia: Inertia
    """Inertia of the Hessian."""
    reduced_inertia_start: Inertia
    """Inertia of the Hessian on the directions that the working set leaves free, at the start of phase two."""
    reduced_inertia_end: Inertia
    """Inertia of the Hessian on the directions that the working set leaves free, at the end."""
    weakly_active: int
    """Number of active constraints with a multiplier of about zero."""
    objective: float
    """Objective at the end, scaled; 0 at the contact state, and its minimum with weights that are not negative."""
    penalty: Penalty | None = None
    """Penalty of QP2, or null."""


@frozen_value
class Trace(Leaf):
    """One quantity, iteration by iteration, free of units."""

    quantity: str
    """Name: objective of the statement, infeasibility of its constraints, or residual of the contact conditions."""
    first: int
    """Number of the iteration that ended at the first value; 0 is the start."""
    values: tuple[float, ...]
    """Value at the end of each iteration, finite."""


def traces_in_turn(*parts: tuple[str, Sequence[float]]) -> tuple[Trace, ...]:
    """Number the iterations of quantities (name, values) that followed each other, from 1; without the empty ones."""
    traces: list[Trace] = []
    done = 0
    for quantity, values in parts:
        if len(values):
            traces.append(Trace(quantity=quantity, first=done + 1, values=tuple(map(float, values))))
        done += len(values)
    return tuple(traces)


@frozen
class ContactSolution(WithHints):
    """A solution as a formulation reports it; ``bemcontact.assessment`` recomputes whether it is one.

    Parameters
    ----------
    formulation : name of the statement that was solved
    solver : name of the program that solved it
    status : how it ended
    pressure : (n,) p [p]
    displacement : (n,) u_n [L], the solver's own (it need not satisfy the equations)
    rigid_amplitudes : (k,) a
    iterations : of the solver, as it counts them
    unpolished : (n,) the solver's own p [p], where the active-set step after it was kept; else None
    smallest_eigenvalue : of the scaled Hessian on the equilibrium space, where the formulation looked at it
    search : how a local solver came to its end, if one was used
    history : how the solver got there, in the order in which it happened; the polish adds nothing
    undetermined : names of free motions that contact leaves open; their amplitudes follow a rule
    notes : what a person should know
    """

    formulation: str
    solver: str
    status: Status
    pressure: Array
    displacement: Array
    rigid_amplitudes: Array
    iterations: int
    unpolished: Array | None = None
    smallest_eigenvalue: float | None = None
    search: LocalSearch | None = None
    history: tuple[Trace, ...] = ()
    undetermined: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Make arrays read-only."""
        freeze_arrays(self)

    @property
    def polished(self) -> bool:
        """Whether the active-set step after the solver improved the result and was kept."""
        return self.unpolished is not None

    def __repr__(self) -> str:
        """One line: formulation, status, size."""
        return f"<ContactSolution by {self.formulation}: {self.status.words}, {len(self.pressure)} contact points>"
